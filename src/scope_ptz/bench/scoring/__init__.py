"""Scoring of runs: checks, verdicts, error modes, and the records of trials."""
