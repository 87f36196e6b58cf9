"""Scoring: checks, verdicts, error modes, judged trials."""
