"""Conversations with a simulated camera that switches between viewpoints."""

from __future__ import annotations

import pytest

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.store import NoImages
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.geometry import Pose
from scope_ptz.planner.base import PastTurn
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from tests.agent.scripted import ScriptedPerception
from tests.support.synthetic_pack import HEIGHT, WIDTH

pytestmark = pytest.mark.anyio


async def test_undo_returns_to_the_viewpoint_that_was_left(analytic_scene: Scene) -> None:
    camera = SimulatedCamera(analytic_scene, clock=SceneClock(realtime=False), width=WIDTH, height=HEIGHT)
    agent = Agent(GrammarPlanner(), camera, ScriptedPerception(1), NoImages())
    turns: tuple[PastTurn, ...] = ()
    visited = []
    for instruction in ("pan right 12", "go to the from-the-roof preset", "tilt up 4", "undo", "undo", "undo"):
        turns = (*turns, (await agent.run(instruction, conversation=turns)).past_turn())
        visited.append((camera.viewpoint, await camera.pose()))
    moved, roof, _, *undone = visited
    assert moved == ("mast", Pose(12.0, -8.0, 1.0))
    assert undone == [roof, moved, ("mast", Pose(0.0, -8.0, 1.0))]
    assert [turn.viewpoint for turn in turns] == ["mast", "mast", "roof", "roof", "roof", "mast"]
