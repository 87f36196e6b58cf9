"""The evaluation engine: Inspect AI around the agent loop. Besides the plug-in, only modules in here import ``inspect_ai``."""
