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
    """Never decides. ``asked`` is set when it is asked for a decision."""

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


def counting() -> ScriptedPlanner:
    """Return a planner that counts once and answers."""
    return ScriptedPlanner(calls(("count_objects", {"description": "things"})), answer("There are 3."))


def options(scene: Scene, planner: Planner | None = None, **more: Any) -> dict[str, Any]:
    """Return arguments for ``scope_ptz.open``: a camera in a small scene, a scripted planner and scripted perception."""
    given = {"camera": SimulatedCamera(scene), "planner": planner or counting(), "perception": ScriptedPerception(3)}
    return given | more


def opened(scene: Scene, planner: Planner | None = None, **more: Any) -> scope_ptz.Scope:
    """Open a session with these parts."""
    return scope_ptz.open(**options(scene, planner, **more))
