"""Vehicles: cars, lorries, buses, a tram, cycles, construction machines, and the parts that they share."""
