"""Score runs: checks, verdicts, error modes and trial records."""
