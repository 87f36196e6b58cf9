"""Freight yards: floor, lamps, containers, goods, safety equipment, shelters."""
