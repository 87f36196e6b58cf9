"""The evaluation engine: Inspect AI around the agent loop. Only modules in here import ``inspect_ai``; the loop never does."""
