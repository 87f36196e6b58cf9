"""List and inspect scenes, models and tool schemas."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

from scope_ptz.factory.scenes import draw_presets, open_scene, scene_search
from scope_ptz.registry import Model, Role, load_registry
from scope_ptz.settings import load_settings
from scope_ptz.simulator.card import object_counts
from scope_ptz.simulator.pack import Scene, list_scenes

if TYPE_CHECKING:
    from PIL import Image

MAX_CATEGORIES = 10  # object categories listed in the notebook display of a scene


class SceneInfo:
    """A simulated scene with its viewpoints, presets and objects. A notebook displays it with its contact sheet.

    Example:
        >>> import scope_ptz
        >>> scene = scope_ptz.scenes()["highway-works"]
        >>> scene.title, len(scene.viewpoints)
        ('Highway works', 3)
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    @property
    def name(self) -> str:
        """Name of the scene, which can be passed to ``scope_ptz.open``."""
        return self._scene.name

    @property
    def title(self) -> str:
        """Title of the scene, such as "Highway works"."""
        return self._scene.file.title

    @property
    def viewpoints(self) -> tuple[str, ...]:
        """Names of the viewpoints, the places where a camera can be mounted."""
        return tuple(viewpoint.name for viewpoint in self._scene.file.viewpoints)

    @property
    def presets(self) -> dict[str, str]:
        """The viewpoint of each preset, by preset name."""
        return {preset.name: preset.viewpoint for preset in self._scene.file.presets}

    @cached_property
    def objects(self) -> dict[str, int]:
        """Number of objects in the scene by category, the most frequent first. Moving objects are included."""
        return dict(object_counts(self._scene.file))

    @cached_property
    def contact_sheet(self) -> Image.Image:
        """A picture with the views at all presets, drawn on first use."""
        from scope_ptz.api.event_loop import run_in_thread

        return run_in_thread(partial(draw_presets, self._scene))

    def __repr__(self) -> str:
        return f"<SceneInfo {self.name}: {len(self.viewpoints)} viewpoints, {len(self.presets)} presets>"

    def _repr_html_(self) -> str:
        from scope_ptz.api.notebook import card_html

        objects = list(self.objects.items())
        listed = ", ".join(f"{count} {name}" for name, count in objects[:MAX_CATEGORIES])
        more = f" and {len(objects) - MAX_CATEGORIES} more categories" if len(objects) > MAX_CATEGORIES else ""
        rows = [("open with", f'scope_ptz.open("{self.name}")')]
        for viewpoint in self.viewpoints:
            presets = ", ".join(name for name, preset_viewpoint in self.presets.items() if preset_viewpoint == viewpoint)
            rows.append((f"presets at {viewpoint}", presets or "none"))
        return card_html(self.title, [*rows, ("objects", listed + more)], self.contact_sheet)


def scenes() -> dict[str, SceneInfo]:
    """Return all scenes by name: the built-in scenes and those in the folder set by ``SCOPE_SCENES_DIR``.

    Returns:
        The scenes. Their pictures are loaded on first use.

    Raises:
        PackError: The files of a scene are damaged.

    Example:
        >>> import scope_ptz
        >>> "highway-works" in scope_ptz.scenes()
        True
    """
    return {name: SceneInfo(open_scene(name)) for name in list_scenes(scene_search(load_settings()))}


def models(role: Role | None = None) -> dict[str, Model]:
    """Return the registered models by name: the built-in models and those in the user's models file.

    Args:
        role: "planner" or "perception" to select the models of one role; all models by default.

    Returns:
        The models. ``model.memory_for()`` returns the memory, in GB, needed to serve a model.

    Raises:
        ConfigError: The user's models file is invalid.

    Example:
        >>> import scope_ptz
        >>> model = scope_ptz.models(role="planner")["qwen3-4b"]
        >>> model.size_b
        4.0
    """
    registry = load_registry(load_settings().models_file())
    return {name: model for name, model in registry.models.items() if role is None or role in model.roles}


def tool_schemas() -> list[dict[str, Any]]:
    """Return the schemas of the nine tools in the OpenAI function format, as planners receive them.

    To offer the tools to your own model, use ``Scope.tool_schemas``, which supports the formats of several APIs.

    Returns:
        One schema per tool.

    Example:
        >>> import scope_ptz
        >>> scope_ptz.tool_schemas()[0]["function"]["name"]
        'adjust_ptz'
    """
    from scope_ptz.tools.registry import schemas

    return schemas()
