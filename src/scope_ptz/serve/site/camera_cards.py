"""The cards in the camera list. A card states a camera's kind and abilities, and whether the camera works."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, replace
from time import monotonic
from typing import Literal

import anyio
from anyio import to_thread

from scope_ptz.camera.base import Camera
from scope_ptz.errors import CameraError, ScopeError
from scope_ptz.factory.cameras import parse_camera
from scope_ptz.factory.scenes import open_scene
from scope_ptz.serve.site.camera_kinds import CameraKind, has_rules, kind_of, scene_of
from scope_ptz.serve.site.scene_time import scene_time
from scope_ptz.serve.site.station import Station
from scope_ptz.simulator.models import SceneFile

Ability = Literal["move", "drive", "presets", "focus", "iris", "scene_time", "ground_truth", "virtual_camera"]
HealthState = Literal["connected", "ready", "failed"]

CHECK_TIMEOUT_S = 20.0
"""Time limit for a check in seconds. A camera that does not answer within this time has failed."""

CHECK_REUSE_S = 2.0
"""Seconds for which a check's result is reused, so that several pages can share one check."""


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """Facts about a stored scene.

    Attributes:
        name: The scene's name.
        title: The scene's title.
        viewpoints: Names of the viewpoints.
        presets: Number of presets.
        moving: Number of moving objects.
        has_truth: Whether the scene has ground truth. Captured scenes have none.
    """

    name: str
    title: str
    viewpoints: tuple[str, ...]
    presets: int
    moving: int
    has_truth: bool


@dataclass(frozen=True, slots=True)
class CameraCard:
    """A camera's card in the camera list.

    Attributes:
        title: The device name or the scene title; empty if it is not known yet.
        kind: The kind of camera.
        scene: The stored scene that a simulated camera shows; None for other cameras.
        abilities: The known abilities. A device's abilities are not known until the device has been opened.
        health: "connected" if the camera answers, "ready" if it will be opened on first use, "failed" if it cannot be used.
        problem: Why the camera cannot be used; None if it can.
        configured: Whether the camera is defined in ``scope.yaml``.
        has_picture: Whether a thumbnail is available.
    """

    title: str
    kind: CameraKind
    scene: SceneFacts | None
    abilities: tuple[Ability, ...]
    health: HealthState
    problem: ScopeError | None
    configured: bool = False
    has_picture: bool = False


class CameraCards:
    """Creates camera cards. It connects to devices, but does not open simulated cameras or start Blender."""

    def __init__(self) -> None:
        self._scenes: dict[str, SceneFacts] = {}
        self._checks: dict[str, tuple[asyncio.Task[ScopeError | None], float]] = {}

    async def card(self, station: Station) -> CameraCard:
        """Check whether a camera works, and return its card. A failure is part of the card."""
        try:
            kind = kind_of(station.spec)
        except ScopeError as error:
            return CameraCard("", "plug_in", None, (), "failed", error, configured=True)
        card = CameraCard("", kind, None, (), "ready", None, configured=bool(parse_camera(station.spec).name))
        name = scene_of(station.spec)
        try:
            scene = None if name is None else await self._scene(name)
        except ScopeError as error:
            return replace(card, health="failed", problem=error)
        if scene is not None:
            has_camera_rules = has_rules(station.spec)
            card = replace(
                card,
                title=scene.title,
                scene=scene,
                abilities=_scene_abilities(scene, has_camera_rules=has_camera_rules),
                has_picture=not has_camera_rules,
            )
        if not station.is_open and kind in ("simulated", "blender"):
            return card if station.problem is None else replace(card, health="failed", problem=station.problem)
        problem = await self._check(station)
        opened = station.open_camera
        if opened is not None and scene is None:
            card = replace(card, title=opened.camera.info.name, abilities=_device_abilities(opened.camera))
        works = problem is None
        return replace(card, health="connected" if works else "failed", problem=problem, has_picture=works)

    async def _scene(self, name: str) -> SceneFacts:
        if name not in self._scenes:
            self._scenes[name] = await to_thread.run_sync(_scene_facts, name)
        return self._scenes[name]

    async def _check(self, station: Station) -> ScopeError | None:
        """Check a camera, and return its error; None if the camera works. Concurrent requests share one check."""
        task, started_s = self._checks.get(station.name, (None, 0.0))
        if task is None or (task.done() and monotonic() - started_s > CHECK_REUSE_S):
            task = asyncio.create_task(_find_problem(station))
            self._checks[station.name] = task, monotonic()
        return await asyncio.shield(task)


async def _find_problem(station: Station) -> ScopeError | None:
    try:
        with anyio.fail_after(CHECK_TIMEOUT_S):
            await (await station.camera()).pose()
    except TimeoutError:
        return CameraError(f"{station.name} did not answer within {CHECK_TIMEOUT_S:g} s.")
    except ScopeError as error:
        return error
    return CameraError(station.live.problem) if station.live.problem else None


def _scene_facts(name: str) -> SceneFacts:
    file: SceneFile = open_scene(name).file
    viewpoints = tuple(viewpoint.name for viewpoint in file.viewpoints)
    return SceneFacts(name, file.title, viewpoints, len(file.presets), len(file.actors), file.captured is None)


def _scene_abilities(scene: SceneFacts, *, has_camera_rules: bool) -> tuple[Ability, ...]:
    abilities: list[tuple[Ability, bool]] = [
        ("move", True), ("drive", True), ("presets", True), ("scene_time", True),
        ("ground_truth", scene.has_truth), ("virtual_camera", not has_camera_rules),
    ]  # fmt: skip
    return tuple(name for name, available in abilities if available)


def _device_abilities(camera: Camera) -> tuple[Ability, ...]:
    capabilities = camera.info.capabilities
    abilities: list[tuple[Ability, bool]] = [
        ("move", True), ("drive", capabilities.drives), ("presets", capabilities.edits_presets),
        ("focus", bool(capabilities.focus)), ("iris", bool(capabilities.iris)), ("scene_time", scene_time(camera) is not None),
    ]  # fmt: skip
    return tuple(name for name, available in abilities if available)
