"""The open scene of a Blender window as a camera. The add-on (``scope_addon``) runs in that Blender and carries out requests."""
