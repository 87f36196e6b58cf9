"""The site: the cameras, pairs, runs and conversations that a server provides."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

import anyio

from scope_ptz.agent.records import Budgets
from scope_ptz.builtin_names import BLENDER_WINDOW
from scope_ptz.camera.control import user_name
from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.factory.cameras.named_cameras import named_cameras
from scope_ptz.factory.scenes import scene_search
from scope_ptz.serve.site.benchmark.evaluations import Evaluations
from scope_ptz.serve.site.benchmark.trajectories import Trajectories
from scope_ptz.serve.site.camera_cards import CameraCards
from scope_ptz.serve.site.camera_control import LEASE_S
from scope_ptz.serve.site.pairs import Pairs
from scope_ptz.serve.site.run_library import RunLibrary
from scope_ptz.serve.site.runner import Runner
from scope_ptz.serve.site.station import IdleReturn, Station
from scope_ptz.serve.site.virtual_cameras import VirtualCameras
from scope_ptz.settings import ScopeSettings
from scope_ptz.simulator.pack import list_scenes


@dataclass(frozen=True, slots=True)
class SiteOptions:
    """The options for a site.

    Attributes:
        runs_dir: The runs folder.
        cameras: The names of the cameras in ``scope.yaml`` and of the scenes to serve; empty for all.
        pairs: The names of the pairs to offer, the default first; empty for the built-in pair.
        budgets: The limits for a run.
        idle: The preset to which unused cameras return; None to leave them where they are.
        idle_by_camera: Overrides of ``idle`` for individual cameras, by name.
        lease_s: Seconds without a command after which control of a camera expires.
    """

    runs_dir: Path
    cameras: tuple[str, ...] = ()
    pairs: tuple[str, ...] = ()
    budgets: Budgets = field(default_factory=Budgets)
    idle: IdleReturn | None = None
    idle_by_camera: Mapping[str, IdleReturn] = field(default_factory=dict)
    lease_s: float = LEASE_S


class Site:
    """A server's cameras, pairs, runs and evaluations. Use it as an async context manager for as long as the server runs.

    Args:
        cameras: Camera specs, by the name that requests use.
        options: The options.

    Raises:
        StoreError: The run store cannot be opened.
    """

    def __init__(self, cameras: dict[str, str], options: SiteOptions) -> None:
        self.pairs = Pairs(options.pairs)
        self.library = RunLibrary(options.runs_dir)
        self.runner = Runner(self.library, options.budgets)
        self.evaluations = Evaluations(options.runs_dir)
        self.trajectories = Trajectories()
        actor = f"scope serve: {user_name()}"
        self.stations = {
            name: Station(
                name, spec, self.pairs, actor=actor, idle=options.idle_by_camera.get(name, options.idle), lease_s=options.lease_s
            )
            for name, spec in cameras.items()
        }
        self.cards = CameraCards()
        self.virtual_cameras = VirtualCameras()
        self.closing = asyncio.Event()
        """Set when the server shuts down, so that streams end."""
        self._tasks: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> Self:
        stations = self.stations.values()
        coroutines = [
            self.library.run(),
            *(station.live.run() for station in stations),
            *(station.watch_idle() for station in stations),
        ]
        self._tasks = [asyncio.create_task(coroutine) for coroutine in coroutines]
        return self

    async def __aexit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        # Ctrl-C cancels the code around the context, but cameras must still be stopped and the ends of runs recorded.
        with anyio.CancelScope(shield=True):
            self.closing.set()
            await self.runner.close()
            await self.virtual_cameras.close()
            for station in self.stations.values():
                station.cancel_prefetch()
            for station in self.stations.values():
                await station.close()
            await self.library.in_thread(self.evaluations.close)
            await self.library.wait_for_indexing(10.0)
            for task in self._tasks:
                task.cancel()
            await asyncio.gather(*self._tasks, return_exceptions=True)
            self.library.close()

    def station(self, name: str) -> Station:
        """Return a camera by name.

        Raises:
            UnknownNameError: The site has no such camera.
        """
        if name not in self.stations:
            raise UnknownNameError("camera", name[:120], self.stations)
        return self.stations[name]


def site_cameras(names: Sequence[str], settings: ScopeSettings) -> dict[str, str]:
    """Return the specs of the site's cameras by name: first the cameras in ``scope.yaml``, then the scenes.

    Args:
        names: The names to serve; empty for all.
        settings: The settings.

    Raises:
        UnknownNameError: A name is neither a camera in ``scope.yaml`` nor a scene.
        ConfigError: There is nothing to serve, or ``scope.yaml`` is invalid.
    """
    named = {name: name for name in named_cameras()}
    known = named | {name: f"sim:{name}" for name in list_scenes(scene_search(settings)) if name not in named}
    if BLENDER_WINDOW in names:  # works only with an add-on, so it is served only if named
        known.setdefault(BLENDER_WINDOW, f"{BLENDER_WINDOW}:")
    for name in names:
        if name not in known:
            raise UnknownNameError("camera or scene", name, known)
    selected = {name: known[name] for name in names} if names else known
    if not selected:
        raise ConfigError("There are no cameras to serve. Add cameras to scope.yaml, or install scenes.")
    return selected


def idle_returns() -> dict[str, IdleReturn]:
    """Return the idle behaviour that ``scope.yaml`` defines, by camera name.

    Raises:
        ConfigError: ``scope.yaml`` is invalid.
    """
    return {
        name: IdleReturn(named.when_idle.after_s, named.when_idle.preset or "")
        for name, named in named_cameras().items()
        if named.when_idle is not None
    }
