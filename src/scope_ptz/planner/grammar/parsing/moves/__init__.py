"""Read clauses that move the camera: turns, zooms and presets."""
