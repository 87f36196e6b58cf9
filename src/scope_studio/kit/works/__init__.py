"""Works on roads and buildings: barriers, site equipment, building materials and tools, scaffolding."""
