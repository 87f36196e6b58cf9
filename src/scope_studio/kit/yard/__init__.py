"""Freight yards: ground, lamps, safety equipment, stock."""
