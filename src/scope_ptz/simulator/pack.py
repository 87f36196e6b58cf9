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

from scope_ptz.errors import InputError, PackError, UnknownNameError
from scope_ptz.simulator.models import SceneActor, SceneFile, SceneInstance
from scope_ptz.simulator.recent import RecentViewpoints
from scope_ptz.simulator.sheets.picture_cache import PictureCache
from scope_ptz.simulator.variation import HeldObject, vary
from scope_ptz.simulator.viewpoint import Viewpoint, read_json


def find_scenes(search: Iterable[Path] = ()) -> dict[str, Path]:
    """Return the scene folders by scene name: the folders with a ``scene.json`` in ``search`` and in the package.

    If several folders have the same name, the first one is used. Files are not opened, so damaged scenes are also listed.
    """
    found: dict[str, Path] = {}
    for root in (*search, Path(str(files("scope_ptz"))) / "data" / "scenes"):
        if root.is_dir():
            for folder in sorted(root.iterdir()):
                if _is_scene_folder(folder):
                    found.setdefault(folder.name, folder)
    return found


def _is_scene_folder(folder: Path) -> bool:
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
    picture_cache: PictureCache | None = None,
) -> Scene:
    """Open a scene (``highway-works``) or a variation of one (``highway-works-v7``) by name.

    Args:
        name: Name of the scene or variation.
        search: Additional scene folders, searched before the built-in ones.
        recent: Limits how many viewpoints stay in memory; see ``Scene``.
        tile_bytes: Memory limit for each viewpoint's tiles; see ``Scene``.
        picture_cache: On-disk cache for decoded pictures; see ``Scene``.

    Raises:
        UnknownNameError: The scene does not exist.
        PackError: The scene's files are damaged.
    """
    folders = find_scenes(search)
    if name in folders:
        return Scene(folders[name], recent, tile_bytes, picture_cache)
    scene, number = variation_of(name)
    if number is None or scene not in folders:
        raise UnknownNameError("scene", name, folders)
    return Scene(folders[scene], recent, tile_bytes, picture_cache).create_variation(number)


def variation_name(scene: str, number: int) -> str:
    """Return the name that opens variation ``number`` of a scene."""
    return f"{scene}-v{number}"


def variation_of(name: str) -> tuple[str, int | None]:
    """Split a variation's name into scene name and number. For other names, the number is None."""
    varied = _VARIATION_NAME.fullmatch(name)
    return (name, None) if varied is None else (varied["scene"], int(varied["number"]))


_VARIATION_NAME = re.compile(r"(?P<scene>.+)-v(?P<number>[1-9]\d{0,8})")


class Scene:
    """A scene folder. Safe to share between threads and cameras.

    The instance table is read immediately, and viewpoints are read on first use.

    Attributes:
        variation: Number of the variation; None for the scene itself.
        held: Objects that move in the scene but stand still in this variation.

    Args:
        folder: The scene folder.
        recent: Releases viewpoints if too many are open. Without it, every opened viewpoint stays in memory.
        tile_bytes: Memory limit for each viewpoint's tiles. Beyond it, the least recently used tiles are released and read again
            when they are needed. Without a limit, all tiles stay in memory.
        picture_cache: On-disk cache for decoded pictures, which other processes can use. Ignored if ``tile_bytes`` is given.

    Raises:
        PackError: A file is missing, damaged or inconsistent.
    """

    def __init__(
        self,
        folder: Path,
        recent: RecentViewpoints | None = None,
        tile_bytes: int | None = None,
        picture_cache: PictureCache | None = None,
    ) -> None:
        self.folder = folder
        self.file = read_json(folder / "scene.json", SceneFile)
        if self.file.name != folder.name:
            raise PackError(f"{folder} contains the scene '{self.file.name}'. Rename the folder to the scene's name.")
        self.name = self.file.name
        self.variation: int | None = None
        self.held: tuple[HeldObject, ...] = ()
        self._viewpoints: dict[str, Viewpoint] = {}
        self._recent, self._tile_bytes, self._picture_cache = recent, tile_bytes, picture_cache
        self._lock = RLock()
        _check_references(self.file, folder)

    def create_variation(self, number: int) -> Scene:
        """Return a variation of this scene, which shares the layers of this scene's viewpoints.

        Raises:
            InputError: The scene was captured from a camera, so it has no objects that could vary.
        """
        if self.file.captured is not None:
            raise InputError(f"The scene '{self.name}' was captured from a camera and has no variations. Use it as '{self.name}'.")
        extents = {place.name: self.viewpoint(place.name).manifest.extents for place in self.file.viewpoints}
        variation = vary(self.file, number, extents)
        other = Scene(self.folder, self._recent, self._tile_bytes, self._picture_cache)
        other.variation = number
        other.name, other.file, other.held = variation_name(self.name, number), variation.file, variation.held
        other._viewpoints, other._lock = self._viewpoints, self._lock
        return other

    def end_threads(self) -> None:
        """End the threads that help to render open viewpoints. The scene remains usable, and starts them again when needed."""
        with self._lock:
            opened = list(self._viewpoints.values())
        for viewpoint in opened:
            viewpoint.end_thread()

    @property
    def things(self) -> list[SceneInstance | SceneActor]:
        """All instances, followed by all actors."""
        return [*self.file.instances, *self.file.actors]

    @cached_property
    def by_number(self) -> Mapping[int, SceneInstance | SceneActor]:
        """Instances and actors by instance ID, the value of their pixels."""
        return {thing.number: thing for thing in self.things}

    @cached_property
    def by_id(self) -> Mapping[str, SceneInstance | SceneActor]:
        """Instances and actors by their ``id`` in the scene file."""
        return {thing.id: thing for thing in self.things}

    @cached_property
    def families(self) -> Mapping[str, frozenset[int]]:
        """For each instance's ``id``, the instance IDs of the whole object that it belongs to: the parent and all of its parts."""
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
        """Return a viewpoint of the scene. Each viewpoint is opened once and shared.

        Raises:
            UnknownNameError: The scene has no such viewpoint.
            PackError: The viewpoint's files are damaged.
        """
        known = {v.name: v for v in self.file.viewpoints}
        if name not in known:
            raise UnknownNameError("viewpoint", name, known)
        with self._lock:
            if name not in self._viewpoints:
                self._viewpoints[name] = Viewpoint(
                    self.folder / name, self.file, known[name], self._tile_bytes, self._picture_cache
                )
            viewpoint = self._viewpoints[name]
            if self._recent is not None:
                self._recent.mark_used(self._viewpoints, name)
            return viewpoint

    def release(self) -> None:
        """Release the layers of all viewpoints. They are read again on request."""
        with self._lock:
            self._viewpoints.clear()


def _check_references(file: SceneFile, folder: Path) -> None:
    """Check that references between the tables are valid and that each ``id`` and each instance ID is unique."""
    objects: list[SceneInstance | SceneActor] = [*file.instances, *file.actors]
    ids, numbers = {t.id for t in objects}, {t.number for t in objects}
    viewpoints, presets = {v.name for v in file.viewpoints}, {p.name for p in file.presets}
    faults = [f"preset '{p.name}' names the viewpoint '{p.viewpoint}'" for p in file.presets if p.viewpoint not in viewpoints]
    faults += [f"text '{t.id}' names the instance '{t.parent}'" for t in file.texts if t.parent not in ids]
    faults += [f"instance '{i.id}' names the parent '{i.parent}'" for i in file.instances if i.parent and i.parent not in ids]
    if file.home_preset not in presets:
        faults.append(f"the home preset is '{file.home_preset}'")
    if faults:
        raise PackError(f"{folder / 'scene.json'}: {faults[0]}, which does not exist. Restore the pack or build the scene again.")
    if len(ids) != len(objects) or len(numbers) != len(objects):
        raise PackError(f"{folder / 'scene.json'} uses an id or a number more than once. Restore it or build the scene again.")
