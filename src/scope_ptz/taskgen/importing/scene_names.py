"""Find the scenes and presets for imported tasks by their names in the file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import InputError

ANY_NAME = "*"


class SceneNameMap(BaseModel):
    """The contents of a mapping file for scenes and presets. The name "*" matches every name that is not listed.

    Attributes:
        scenes: Scenes by file location, or by the location's file name with or without its suffix.
        presets: For each scene, its presets by their names in the file.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    scenes: dict[str, str] = {}
    presets: dict[str, dict[str, str]] = {}


@dataclass(frozen=True, slots=True)
class ScenePresets:
    """A scene's presets.

    Attributes:
        presets: The viewpoint of each preset.
        home: The preset at which a run starts if the file names none.
        start_s: Scene time at the start, in seconds.
    """

    presets: Mapping[str, str]
    home: str
    start_s: float = 0.0


@dataclass(frozen=True)
class SceneNames:
    """The available scenes by name, and the mapping from the names in an imported file."""

    scenes: Mapping[str, ScenePresets]
    mapping: SceneNameMap = field(default_factory=SceneNameMap)

    def scene(self, location: str) -> str | None:
        """Return the scene for a file location; None if no scene is found.

        The mapping takes precedence. Otherwise the name of the file without its suffix, or of its folder, must match a scene. If
        neither does, the mapping's entry "*" is used.
        """
        mapped = self.mapping.scenes
        path = PurePosixPath(location.replace("\\", "/"))
        stem, folder = _possible_scene_names(location)
        for name in (location, path.name, stem):
            if name in mapped:
                return mapped[name] if mapped[name] in self.scenes else None
        by_name = {_normalise(name): name for name in self.scenes}
        for name in (stem, folder):
            if name and _normalise(name) in by_name:
                return by_name[_normalise(name)]
        return mapped[ANY_NAME] if mapped.get(ANY_NAME) in self.scenes else None

    def preset(self, scene: str, name: str) -> str | None:
        """Return a scene's preset by its name in the file; None if it is not found. An empty name means the home preset."""
        scene_presets, mapped = self.scenes[scene], self.mapping.presets.get(scene, {})
        if name in mapped:
            return mapped[name] if mapped[name] in scene_presets.presets else None
        match = self._preset_by_name(scene, name)
        return match or (mapped[ANY_NAME] if mapped.get(ANY_NAME) in scene_presets.presets else None)

    def source_view(self, location: str, preset_name: str) -> tuple[str, str]:
        """Return a key for the view that a row refers to, independent of the mapping.

        Different spellings of one scene or preset have the same key. Different presets that are mapped to one have different keys.
        """
        scene = self.scene(location)
        if scene is None:
            return location, preset_name
        names = (_normalise(name) for name in _possible_scene_names(location))
        scene_key = scene if _normalise(scene) in names else _normalise(location)
        preset = self.preset(scene, preset_name)
        is_own_name = preset is not None and preset == self._preset_by_name(scene, preset_name)
        return scene_key, preset if is_own_name and preset is not None else f"~{_normalise(preset_name)}"

    def merged_presets(self, views: Iterable[tuple[str, str]]) -> dict[tuple[str, str], list[str]]:
        """Return the scene presets to which several presets in a file are mapped, each with its names in the file.

        Args:
            views: File location and preset name of each row.
        """
        by_preset: dict[tuple[str, str], dict[tuple[str, str], str]] = {}
        for location, name in views:
            scene = self.scene(location)
            preset = self.preset(scene, name) if scene is not None else None
            if scene is not None and preset is not None:
                by_preset.setdefault((scene, preset), {}).setdefault(self.source_view(location, name), f"{location} {name}".strip())
        return {preset: list(names.values()) for preset, names in by_preset.items() if len(names) > 1}

    def _preset_by_name(self, scene: str, name: str) -> str | None:
        """Return the preset with a given name, ignoring the mapping. An empty name means the home preset."""
        scene_presets = self.scenes[scene]
        if not name.strip() or _normalise(name) == "home":
            return scene_presets.home
        by_name = {_normalise(preset): preset for preset in scene_presets.presets}
        return by_name.get(_normalise(name)) or by_name.get(
            _normalise(re.sub(r"(?i)^preset[\s_:-]*|[\s_:-]*preset$", "", name.strip()))
        )

    def viewpoint(self, scene: str, preset: str) -> str:
        """Return the viewpoint of a preset."""
        return self.scenes[scene].presets[preset]


def read_scene_names(path: Path) -> SceneNameMap:
    """Read a mapping file in YAML or JSON.

    Raises:
        InputError: The file cannot be read or is not a valid mapping.
    """
    try:
        content: Any = yaml.safe_load(path.read_text("utf-8"))
        return SceneNameMap.model_validate(content or {})
    except OSError as error:
        raise InputError(f"The mapping {path} cannot be read: {error.strerror}.") from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {where or 'as a whole'}: {first['msg']}. The valid keys are scenes and presets.") from error
    except (ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path} is not a mapping: {str(error)[:200]}.") from error


def _possible_scene_names(location: str) -> tuple[str, str]:
    """Return the parts of a file location that may be a scene's name: the file name without its suffix, and the folder."""
    path = PurePosixPath(location.replace("\\", "/"))
    return path.stem if path.suffix else path.name, path.parent.name


def _normalise(name: str) -> str:
    """Return a name in lower case without separators, so that "Parking_Lot 2", "parkingLot2" and "parking-lot-2" are equal."""
    return re.sub(r"[^a-z0-9]+", "", name.lower())
