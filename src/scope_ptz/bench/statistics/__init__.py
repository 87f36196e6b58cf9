"""Statistics for evaluations: small pure functions with the sources of their formulas. They know nothing about runs."""
