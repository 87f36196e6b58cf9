"""Tests of the add-on for Blender that need no Blender."""
