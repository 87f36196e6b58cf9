"""SCOPE: talk to a pan-tilt-zoom camera in plain language, and measure how well a model pair does it."""

__version__ = "0.1.0"
