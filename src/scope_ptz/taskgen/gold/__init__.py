"""Gold runs: reference runs with one known fault each."""
