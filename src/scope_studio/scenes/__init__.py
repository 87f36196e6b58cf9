"""The built-in scenes. Each is a package that defines ``build(stage)``, ``NAME`` and ``TITLE``."""
