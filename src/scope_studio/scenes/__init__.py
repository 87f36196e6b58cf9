"""The built-in scenes. Each is a package with a ``build(stage)`` function, ``NAME`` and ``TITLE``."""
