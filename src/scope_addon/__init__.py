"""The SCOPE add-on for Blender: steer the camera of the open scene in plain language.

The agent runs in a ``scope`` server, which the add-on can start. The add-on sets poses and takes pictures in Blender. It uses only
Blender's own Python, from 3.10 (Blender 3.4) on, and the standard library.

- ``protocol/``: connections to the server and the threads that use them; does not import ``bpy``.
- ``scene/``: the camera in the open scene.
- ``ui/``: the banner, the sidebar and the operators.
"""

bl_info = {
    "name": "SCOPE",
    "author": "The SCOPE authors",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D Viewport > Sidebar > SCOPE",
    "description": "Steer the camera of the open scene, and ask about it, in plain language",
    "category": "Camera",
}


def register() -> None:
    """Add the panels, operators and handlers to Blender."""
    from .ui import registration

    registration.register()


def unregister() -> None:
    """Disconnect, and remove everything that ``register`` added."""
    from .ui import registration

    registration.unregister()
