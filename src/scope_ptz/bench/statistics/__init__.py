"""Statistics for evaluations: pure functions with references for the formulas."""
