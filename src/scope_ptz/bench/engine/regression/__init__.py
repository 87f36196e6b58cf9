"""Comparison of two evaluations: whether the candidate is significantly worse than the baseline."""
