"""Detect changes to the scene, so that pictures of an unchanged scene can be reused."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bpy
from bpy.app.handlers import persistent

from . import cameras

_VERSIONS = itertools.count(1)
_state = {"version": next(_VERSIONS), "own": 0}


def version() -> int:
    """Return a number that changes whenever something in the scene other than SCOPE's camera changes."""
    return _state["version"]


def record_change() -> None:
    """Record a change."""
    _state["version"] = next(_VERSIONS)


@contextmanager
def own_change() -> Iterator[None]:
    """Do not count changes to the scene while the context is active, because SCOPE makes them."""
    _state["own"] += 1
    try:
        yield
        bpy.context.view_layer.update()
    finally:
        _state["own"] -= 1


@persistent
def on_update(_scene: Any, graph: Any = None) -> None:
    """Handle an update of the scene."""
    if _state["own"]:
        return
    if graph is None or any(not _is_ours(update.id) for update in graph.updates):
        record_change()


@persistent
def on_frame_change(_scene: Any, _graph: Any = None) -> None:
    """Handle a change of the animation's current frame. Blender also calls this when SCOPE renders a picture."""
    if not _state["own"]:
        record_change()


def add_handlers() -> None:
    """Start detecting changes."""
    bpy.app.handlers.depsgraph_update_post.append(on_update)
    bpy.app.handlers.frame_change_post.append(on_frame_change)


def remove_handlers() -> None:
    """Stop detecting changes."""
    for handlers, handler in (
        (bpy.app.handlers.depsgraph_update_post, on_update),
        (bpy.app.handlers.frame_change_post, on_frame_change),
    ):
        if handler in handlers:
            handlers.remove(handler)


def _is_ours(item: Any) -> bool:
    original = item.original
    if isinstance(original, bpy.types.Object):
        return cameras.VIEW_CAMERA in original
    return isinstance(original, bpy.types.Camera) and original.name.startswith("SCOPE camera")
