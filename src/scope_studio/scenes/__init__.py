"""The built-in scenes. Each scene is a package that defines ``build(stage)``, ``NAME`` and ``TITLE``."""
