"""``scope bench``: run the benchmark, score and compare runs, and make tasks."""
