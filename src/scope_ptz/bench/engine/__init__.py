"""The evaluation engine, which runs the agent loop on tasks with Inspect AI.

Only this package and the Inspect plug-in import ``inspect_ai``.
"""
