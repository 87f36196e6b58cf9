"""Simulated and real cameras, which all implement the same contract."""
