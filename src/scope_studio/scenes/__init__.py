"""The scenes, each one module with a ``build(stage)`` function."""
