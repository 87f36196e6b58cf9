"""A camera in the scene that is open in a Blender window. Blender's add-on (``scope_addon``) carries out its requests."""
