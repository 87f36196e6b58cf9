"""The evaluation engine, which runs the agent loop on tasks with Inspect AI.

Apart from the plug-in, only modules in this package import ``inspect_ai``.
"""
