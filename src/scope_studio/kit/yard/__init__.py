"""Objects of freight yards: floor, lamps, containers, goods, safety equipment, shelters."""
