"""Sweeps of cameras that render nothing."""

from __future__ import annotations

import numpy as np
import pytest

from scope_ptz.bench.program_runner import BlankCamera
from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.simulator.clock import SceneClock
from scope_ptz.simulator.pack import Scene
from scope_ptz.tools.sweep import sweep


@pytest.mark.anyio
async def test_a_blank_sweep_takes_no_memory_and_has_the_geometry_of_a_rendered_one(analytic_scene: Scene) -> None:
    blank = await sweep(BlankCamera(analytic_scene, clock=SceneClock(), width=640, height=360))
    rendered = await sweep(SimulatedCamera(analytic_scene, clock=SceneClock(), width=640, height=360))
    assert blank.image.strides == (0, 0, 0)
    assert not blank.image.any()
    assert rendered.image.any()
    assert blank.image.shape == rendered.image.shape
    assert (blank.projection, blank.pose, blank.origin) == (rendered.projection, rendered.pose, rendered.origin)
    assert not np.shares_memory(blank.image, rendered.image)
