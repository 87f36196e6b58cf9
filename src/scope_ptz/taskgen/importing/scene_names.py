"""Where imported tasks take place: scenes and presets by the names that a foreign file gives them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import InputError

ANY = "*"


class PlaceMap(BaseModel):
    """A mapping file. ``scenes``: file location or its stem -> scene; ``presets``: scene -> (name in the file -> preset).

    "*" stands for every name that is not given.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    scenes: dict[str, str] = {}
    presets: dict[str, dict[str, str]] = {}


@dataclass(frozen=True, slots=True)
class ScenePresets:
    """``presets``: preset -> viewpoint; ``home``: where a run starts when no preset is given; ``start_s``: scene time then."""

    presets: Mapping[str, str]
    home: str
    start_s: float = 0.0


@dataclass(frozen=True)
class Places:
    """The scenes that there are, by name, and how a file calls them."""

    scenes: Mapping[str, ScenePresets]
    mapping: PlaceMap = field(default_factory=PlaceMap)

    def scene(self, location: str) -> str | None:
        """The scene of a file location: by the mapping, else by the file's stem or its folder's name."""
        given = self.mapping.scenes
        path = PurePosixPath(location.replace("\\", "/"))
        stem = path.stem if path.suffix else path.name
        for name in (location, path.name, stem):
            if name in given:
                return given[name] if given[name] in self.scenes else None
        by_name = {_kebab(name): name for name in self.scenes}
        for name in (stem, path.parent.name):
            if name and _kebab(name) in by_name:
                return by_name[_kebab(name)]
        return given[ANY] if given.get(ANY) in self.scenes else None

    def preset(self, scene: str, name: str) -> str | None:
        """A scene's preset by the name that the file gives it; its home where the file gives none."""
        known, given = self.scenes[scene], self.mapping.presets.get(scene, {})
        if name in given:
            return given[name] if given[name] in known.presets else None
        if not name.strip() or _kebab(name) == "home":
            return known.home
        by_name = {_kebab(preset): preset for preset in known.presets}
        found = by_name.get(_kebab(name)) or by_name.get(_kebab(re.sub(r"(?i)^preset[\s_:-]*|[\s_:-]*preset$", "", name.strip())))
        return found or (given[ANY] if given.get(ANY) in known.presets else None)

    def viewpoint(self, scene: str, preset: str) -> str:
        return self.scenes[scene].presets[preset]


def read_place_map(path: Path) -> PlaceMap:
    """A mapping file, YAML or JSON. Raises ``InputError``."""
    try:
        content: Any = yaml.safe_load(path.read_text("utf-8"))
        return PlaceMap.model_validate(content or {})
    except OSError as error:
        raise InputError(f"The mapping {path} cannot be read: {error.strerror}.") from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"{path}: {where or 'as a whole'}: {first['msg']}. Known: scenes, presets.") from error
    except (ValueError, yaml.YAMLError) as error:
        raise InputError(f"{path} is no mapping: {str(error)[:200]}.") from error


def _kebab(name: str) -> str:
    """A name whatever its case and separators: "Parking_Lot 2", "parkingLot2" and "parking-lot-2" are one."""
    return re.sub(r"[^a-z0-9]+", "", name.lower())
