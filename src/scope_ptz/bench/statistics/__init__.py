"""Statistics for evaluations: pure functions, with references for their formulas."""
