"""Simulated evaluations of the paper's 19 pairs with known strengths. No model is run, and all names are marked as simulated."""
