"""Statistics of evaluations: small pure functions, each with the source of its formula. Nothing here knows what a run is."""
