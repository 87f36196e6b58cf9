"""The evaluation engine: Inspect AI around the agent loop.

Apart from the plug-in, only modules in this package import ``inspect_ai``.
"""
