"""The evaluation engine: it uses Inspect AI to run the agent loop on tasks.

Only the modules of this package and the Inspect plug-in import ``inspect_ai``.
"""
