"""Find scenes and open their packs.

Files are decoded on first use, and only after their checksum has been verified.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from functools import cached_property
from importlib.resources import files
from pathlib import Path
from threading import RLock

from scope_ptz.errors import PackError, UnknownNameError
from scope_ptz.simulator.models import SceneActor, SceneFile, SceneInstance
from scope_ptz.simulator.recent import RecentViewpoints
from scope_ptz.simulator.sheets.kept import KeptPictures
from scope_ptz.simulator.variation import HeldObject, vary
from scope_ptz.simulator.viewpoint import Viewpoint, read_json


def find_scenes(search: Iterable[Path] = ()) -> dict[str, Path]:
    """Return the folder of each scene by name: folders with a ``scene.json`` in ``search`` and in the package.

    The first folder with a name wins. Nothing is opened, so a damaged scene is listed, too.
    """
    found: dict[str, Path] = {}
    for root in (*search, Path(str(files("scope_ptz"))) / "data" / "scenes"):
        if root.is_dir():
            for folder in sorted(root.iterdir()):
                if _holds_scene(folder):
                    found.setdefault(folder.name, folder)
    return found


def _holds_scene(folder: Path) -> bool:
    try:
        return os.path.lexists(folder / "scene.json") or (folder.is_dir() and not os.access(folder, os.R_OK | os.X_OK))
    except OSError:
        return False


def list_scenes(search: Iterable[Path] = ()) -> list[str]:
    """Return the sorted names of the scenes that can be loaded."""
    return sorted(find_scenes(search))


def load_scene(
    name: str,
    search: Iterable[Path] = (),
    recent: RecentViewpoints | None = None,
    tile_bytes: int | None = None,
    kept: KeptPictures | None = None,
) -> Scene:
    """Open a scene (``highway-works``) or a variation of one (``highway-works-v7``) by name.

    Args:
        name: Name of the scene or variation.
        search: Extra folders of scenes, searched before the built-in ones.
        recent: Limits how many viewpoints stay in memory; see ``Scene``.
        tile_bytes: Limits the memory of each viewpoint's tiles; see ``Scene``.
        kept: Where decoded pictures stay on disk; see ``Scene``.

    Raises:
        UnknownNameError: The scene does not exist.
        PackError: The scene's files are damaged.
    """
    folders = find_scenes(search)
    if name in folders:
        return Scene(folders[name], recent, tile_bytes, kept)
    scene, number = variation_of(name)
    if number is None or scene not in folders:
        raise UnknownNameError("scene", name, folders)
    return Scene(folders[scene], recent, tile_bytes, kept).varied(number)


def variation_name(scene: str, number: int) -> str:
    """Return the name that opens variation ``number`` of a scene."""
    return f"{scene}-v{number}"


def variation_of(name: str) -> tuple[str, int | None]:
    """Split the name of a variation into scene and number; the number is None for other names."""
    varied = _VARIED.fullmatch(name)
    return (name, None) if varied is None else (varied["scene"], int(varied["number"]))


_VARIED = re.compile(r"(?P<scene>.+)-v(?P<number>[1-9]\d{0,8})")


class Scene:
    """A scene folder. The instance table is read at once, viewpoints on request. Safe to share between threads and cameras.

    Attributes:
        variation: Number of the variation, None for the scene itself.
        held: Objects that this variation keeps in one place and that otherwise move.

    Args:
        folder: The scene folder.
        recent: Releases viewpoints when many scenes are open. Without it, every opened viewpoint stays in memory.
        tile_bytes: Limit on the memory of each viewpoint's tiles. Beyond it, tiles that were not used for longest are released and
            read again on request. Without it, everything that was read stays in memory.
        kept: Where decoded pictures stay on disk, so that the next program need not decode them. Not used with ``tile_bytes``.

    Raises:
        PackError: A file is missing, damaged or inconsistent.
    """

    def __init__(
        self,
        folder: Path,
        recent: RecentViewpoints | None = None,
        tile_bytes: int | None = None,
        kept: KeptPictures | None = None,
    ) -> None:
        self.folder = folder
        self.file = read_json(folder / "scene.json", SceneFile)
        if self.file.name != folder.name:
            raise PackError(f"{folder} holds the scene '{self.file.name}': a scene folder must bear its scene's name. Rename it.")
        self.name = self.file.name
        self.variation: int | None = None
        self.held: tuple[HeldObject, ...] = ()
        self._viewpoints: dict[str, Viewpoint] = {}
        self._recent, self._tile_bytes, self._kept = recent, tile_bytes, kept
        self._lock = RLock()
        _check_references(self.file, folder)

    def varied(self, number: int) -> Scene:
        """Return a variation of this scene, which shares the layers of its viewpoints."""
        extents = {place.name: self.viewpoint(place.name).manifest.extents for place in self.file.viewpoints}
        variation = vary(self.file, number, extents)
        other = Scene(self.folder, self._recent, self._tile_bytes, self._kept)
        other.variation = number
        other.name, other.file, other.held = variation_name(self.name, number), variation.file, variation.held
        other._viewpoints, other._lock = self._viewpoints, self._lock
        return other

    @property
    def things(self) -> list[SceneInstance | SceneActor]:
        """All instances, followed by all actors."""
        return [*self.file.instances, *self.file.actors]

    @cached_property
    def by_number(self) -> Mapping[int, SceneInstance | SceneActor]:
        """Instances and actors by their number in the instance layers."""
        return {thing.number: thing for thing in self.things}

    @cached_property
    def by_id(self) -> Mapping[str, SceneInstance | SceneActor]:
        """Instances and actors by their string id."""
        return {thing.id: thing for thing in self.things}

    @cached_property
    def families(self) -> Mapping[str, frozenset[int]]:
        """For each id, the numbers of the whole object that it belongs to: its parent and all of the parent's parts."""
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
        """Return one viewpoint of the scene. It is opened once and shared.

        Raises:
            UnknownNameError: The scene has no such viewpoint.
            PackError: The viewpoint's files are damaged.
        """
        known = {v.name: v for v in self.file.viewpoints}
        if name not in known:
            raise UnknownNameError("viewpoint", name, known)
        with self._lock:
            if name not in self._viewpoints:
                self._viewpoints[name] = Viewpoint(self.folder / name, self.file, known[name], self._tile_bytes, self._kept)
            viewpoint = self._viewpoints[name]
            if self._recent is not None:
                self._recent.used(self._viewpoints, name)
            return viewpoint

    def release(self) -> None:
        """Release the layers of all viewpoints. They are read again on request."""
        with self._lock:
            self._viewpoints.clear()


def _check_references(file: SceneFile, folder: Path) -> None:
    """Check that references between the tables exist and that ids and numbers are unique."""
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
