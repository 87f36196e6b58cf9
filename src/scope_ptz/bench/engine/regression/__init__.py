"""Compare two evaluations to find out whether the newer one is significantly worse than the baseline."""
