"""Sessions for tests: a small simulated camera, and planners that wait."""

from __future__ import annotations

import threading
from typing import Any

import anyio

import scope_ptz
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.planner.base import Decision, Planner, State
from scope_ptz.simulator.pack import Scene
from tests.agent.scripted import ScriptedPerception, ScriptedPlanner, answer, calls


class WaitingPlanner(Planner):
    """A planner that never decides. ``asked`` is set when a decision is requested."""

    name = "waiting"

    def __init__(self) -> None:
        self.asked = threading.Event()
        self.closed = False

    async def step(self, state: State) -> Decision:
        self.asked.set()
        await anyio.sleep_forever()
        raise AssertionError("unreachable")

    async def close(self) -> None:
        self.closed = True


def counting_planner() -> ScriptedPlanner:
    """Return a planner that counts once and answers."""
    return ScriptedPlanner(calls(("count_objects", {"description": "things"})), answer("There are 3."))


def session_arguments(scene: Scene, planner: Planner | None = None, **extra: Any) -> dict[str, Any]:
    """Return the arguments for ``scope_ptz.open``: a camera in a small scene, a scripted planner and scripted perception."""
    defaults = {"camera": SimulatedCamera(scene), "planner": planner or counting_planner(), "perception": ScriptedPerception(3)}
    return defaults | extra


def open_session(scene: Scene, planner: Planner | None = None, **extra: Any) -> scope_ptz.Scope:
    """Open a session with the arguments of ``session_arguments``."""
    return scope_ptz.open(**session_arguments(scene, planner, **extra))
