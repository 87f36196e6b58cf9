"""Finding scenes and opening their packs. Nothing is decoded before it is needed, nor used before its checksum matched."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from threading import RLock

from scope_ptz.errors import PackError, UnknownNameError
from scope_ptz.simulator.models import SceneActor, SceneFile, SceneInstance
from scope_ptz.simulator.recent import Recent
from scope_ptz.simulator.variation import Held, vary
from scope_ptz.simulator.viewpoint import Viewpoint, read_json


def find_scenes(search: Iterable[Path] = ()) -> dict[str, Path]:
    """Scene name to folder: folders with a ``scene.json`` in ``search`` and in the package; the first of a name wins."""
    found: dict[str, Path] = {}
    for root in (*search, Path(str(files("scope_ptz"))) / "data" / "scenes"):
        if root.is_dir():
            for folder in sorted(root.iterdir()):
                if (folder / "scene.json").is_file():
                    found.setdefault(folder.name, folder)
    return found


def list_scenes(search: Iterable[Path] = ()) -> list[str]:
    """Names of the scenes that can be loaded, sorted."""
    return sorted(find_scenes(search))


def load_scene(name: str, search: Iterable[Path] = (), recent: Recent | None = None) -> Scene:
    """Open a scene by name, ``highway-works``, or a variation of one, ``highway-works-v7``. ``recent``: see ``Scene``.

    Raises:
        UnknownNameError: there is no such scene.
        PackError: its files are damaged.
    """
    folders = find_scenes(search)
    if name in folders:
        return Scene(folders[name], recent)
    scene, number = variation_of(name)
    if number is None or scene not in folders:
        raise UnknownNameError("scene", name, folders)
    return Scene(folders[scene], recent).varied(number)


def variation_name(scene: str, number: int) -> str:
    """The name under which variation ``number`` of a scene is opened."""
    return f"{scene}-v{number}"


def variation_of(name: str) -> tuple[str, int | None]:
    """The scene and the number that the name of a variation holds; the name and None when it is none."""
    varied = _VARIED.fullmatch(name)
    return (name, None) if varied is None else (varied["scene"], int(varied["number"]))


_VARIED = re.compile(r"(?P<scene>.+)-v(?P<number>[1-9]\d{0,8})")


class Scene:
    """A scene folder: its instance table at once, its viewpoints when asked for. Safe to share between threads and cameras.

    ``variation``: which one this is of the scene, if any; ``held``: what it keeps in one place that else moves. ``recent``: who
    lets go of viewpoints when many scenes are open; without it all that were asked for stay.
    """

    def __init__(self, folder: Path, recent: Recent | None = None) -> None:
        self.folder = folder
        self.file = read_json(folder / "scene.json", SceneFile)
        if self.file.name != folder.name:
            raise PackError(f"{folder} holds the scene '{self.file.name}': a scene folder must bear its scene's name. Rename it.")
        self.name = self.file.name
        self.variation: int | None = None
        self.held: tuple[Held, ...] = ()
        self._viewpoints: dict[str, Viewpoint] = {}
        self._recent = recent
        self._lock = RLock()
        _check_references(self.file, folder)

    def varied(self, number: int) -> Scene:
        """A variation of this scene; it shares the layers of its viewpoints."""
        extents = {place.name: self.viewpoint(place.name).manifest.extents for place in self.file.viewpoints}
        variation = vary(self.file, number, extents)
        other = Scene(self.folder, self._recent)
        other.variation = number
        other.name, other.file, other.held = variation_name(self.name, number), variation.file, variation.held
        other._viewpoints, other._lock = self._viewpoints, self._lock
        return other

    @property
    def things(self) -> list[SceneInstance | SceneActor]:
        """Instances, then actors."""
        return [*self.file.instances, *self.file.actors]

    @cached_property
    def by_number(self) -> Mapping[int, SceneInstance | SceneActor]:
        """Instances and actors by their number in the id layers."""
        return {thing.number: thing for thing in self.things}

    @cached_property
    def by_id(self) -> Mapping[str, SceneInstance | SceneActor]:
        """Instances and actors by their string id."""
        return {thing.id: thing for thing in self.things}

    @cached_property
    def families(self) -> Mapping[str, frozenset[int]]:
        """For each id the numbers of everything that hangs together with it: what it is a part of, and the parts of that."""
        parents = {i.id: i.parent for i in self.file.instances}

        def root(name: str) -> str:
            seen = {name}
            while (parent := parents.get(name)) is not None and parent not in seen:
                seen.add(parent)
                name = parent
            return name

        roots = {name: root(name) for name in self.by_id}
        members: dict[str, set[int]] = {}
        for name, top in roots.items():
            members.setdefault(top, set()).add(self.by_id[name].number)
        return {name: frozenset(members[top]) for name, top in roots.items()}

    def viewpoint(self, name: str) -> Viewpoint:
        """One optical centre of the scene, opened once and shared."""
        known = {v.name: v for v in self.file.viewpoints}
        if name not in known:
            raise UnknownNameError("viewpoint", name, known)
        with self._lock:
            if name not in self._viewpoints:
                self._viewpoints[name] = Viewpoint(self.folder / name, self.file, known[name])
            viewpoint = self._viewpoints[name]
            if self._recent is not None:
                self._recent.used(self._viewpoints, name)
            return viewpoint

    def release(self) -> None:
        """Let go of the layers of all viewpoints; they are read again when they are asked for."""
        with self._lock:
            self._viewpoints.clear()


def _check_references(file: SceneFile, folder: Path) -> None:
    """Every name that one table uses from another must exist, and no number may be given twice."""
    things: list[SceneInstance | SceneActor] = [*file.instances, *file.actors]
    ids, numbers = {t.id for t in things}, {t.number for t in things}
    viewpoints, presets = {v.name for v in file.viewpoints}, {p.name for p in file.presets}
    faults = [f"preset '{p.name}' names the viewpoint '{p.viewpoint}'" for p in file.presets if p.viewpoint not in viewpoints]
    faults += [f"text '{t.id}' names the instance '{t.parent}'" for t in file.texts if t.parent not in ids]
    faults += [f"instance '{i.id}' names the parent '{i.parent}'" for i in file.instances if i.parent and i.parent not in ids]
    if file.home_preset not in presets:
        faults.append(f"the home preset is '{file.home_preset}'")
    if faults:
        raise PackError(f"{folder / 'scene.json'}: {faults[0]}, which does not exist. Restore the pack or build the scene again.")
    if len(ids) != len(things) or len(numbers) != len(things):
        raise PackError(f"{folder / 'scene.json'} gives an id or a number to two things. Restore it or build the scene again.")
