"""Create cameras, planners, perception backends and evaluation contexts from specs and options.

No other package creates these objects.
"""
