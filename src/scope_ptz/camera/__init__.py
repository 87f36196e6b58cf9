"""Cameras, simulated and real, which all implement one contract."""
