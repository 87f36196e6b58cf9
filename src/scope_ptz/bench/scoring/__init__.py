"""Scoring of runs: checks, verdicts, error modes, and records of trials."""
