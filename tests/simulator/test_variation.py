"""Variations of scenes: reproducible, different from their scene, and with consistent images and ground truth."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import UnknownNameError
from scope_ptz.geometry import AXIS_M5075_G, Perspective
from scope_ptz.simulator.models import SceneActor
from scope_ptz.simulator.pack import Scene, load_scene
from scope_ptz.simulator.truth import view_truth
from scope_ptz.simulator.variation import companions
from scope_ptz.simulator.views import picture
from tests.support.synthetic_pack import ACTOR_NUMBER

NUMBERS = range(1, 13)


def state_of(scene: Scene) -> str:
    return f"{scene.file.model_dump_json()}{[(h.actor.id, h.time_s) for h in scene.held]}"


def test_a_number_defines_a_world(analytic_folder: Path, analytic_scene: Scene) -> None:
    told = [state_of(analytic_scene.create_variation(n)) for n in NUMBERS]
    assert told == [state_of(load_scene(f"analytic-yard-v{n}", [analytic_folder.parent])) for n in NUMBERS]
    assert len(set(told)) == len(told)


def test_presets_have_other_poses_at_the_same_viewpoints(analytic_scene: Scene) -> None:
    file = analytic_scene.create_variation(3).file
    assert [p.viewpoint for p in file.presets] == [p.viewpoint for p in analytic_scene.file.presets]
    assert not {p.name for p in file.presets} & {p.name for p in analytic_scene.file.presets}
    assert len({p.name for p in file.presets}) == len(file.presets)
    assert file.home_preset in {p.name for p in file.presets}


def test_actors_can_be_changed_in_every_way(analytic_scene: Scene) -> None:
    worlds = [analytic_scene.create_variation(n) for n in NUMBERS]
    assert {(len(w.file.actors), len(w.held)) for w in worlds} == {(1, 0), (0, 1), (0, 0)}
    assert all(w.file.actors[0].delay_s > 1 for w in worlds if w.file.actors)
    # What is held is a thing like any other.
    assert all(("roller-50" in {i.id for i in w.file.instances}) == bool(w.held) for w in worlds)


@pytest.mark.parametrize("number", [n for n in NUMBERS if n < 9])
def test_changes_of_the_picture_agree_with_ground_truth(analytic_scene: Scene, number: int) -> None:
    world = analytic_scene.create_variation(number)
    still = analytic_scene.create_variation(number)
    still.file, still.held = still.file.model_copy(update={"actors": []}), ()
    seen = 0
    for time_s in (world.file.start_s, world.file.start_s + 4, world.file.start_s + 9):
        view = Perspective(0.0, -8.0, AXIS_M5075_G.hfov_deg(1.0), 640, 360)
        here, without = (picture(s, "mast", view, time_s).astype(int) for s in (world, still))
        changed = np.argwhere(np.abs(here - without).max(axis=-1) > 40)
        truth = [s for s in view_truth(world, "mast", view, time_s).sightings if s.instance.number == ACTOR_NUMBER]
        assert bool(truth) == bool(len(changed)), f"at {time_s} s"
        if truth:
            seen += 1
            low, high = changed.min(axis=0)[::-1] / (640, 360), (changed.max(axis=0) + 1)[::-1] / (640, 360)
            assert np.abs(np.array([*low, *high]) - truth[0].box).max() < 0.01
            assert len(changed) == pytest.approx(truth[0].pixels, rel=0.2)
    if world.held:
        assert seen == 3, "what is held is always there"


@pytest.mark.anyio
async def test_a_camera_reports_its_variation(analytic_scene: Scene) -> None:
    world = analytic_scene.create_variation(2)
    camera = SimulatedCamera(world, width=64, height=36)
    frame = await camera.frame()
    assert frame.origin is not None and frame.origin.scene == "analytic-yard-v2"
    assert [p.name for p in await camera.presets()] == [p.name for p in world.file.presets]


def test_actors_that_belong_together_are_changed_together(analytic_scene: Scene) -> None:
    (roller,) = analytic_scene.file.actors
    dog = roller.model_copy(update={"id": "dog-1", "waypoints": [(t, x + 1, y, z) for t, x, y, z in roller.waypoints]})
    late: SceneActor = dog.model_copy(update={"id": "dog-2", "waypoints": [(t + 1, x, y, z) for t, x, y, z in roller.waypoints]})
    assert [[a.id for a in group] for group in companions([roller, late, dog])] == [[roller.id, "dog-1"], ["dog-2"]]


@pytest.mark.parametrize("name", ["analytic-yard-v0", "analytic-yard-v", "analytic-yard-v1.5", "nowhere-v3", "../analytic-yard-v1"])
def test_invalid_world_names_are_refused(analytic_folder: Path, name: str) -> None:
    with pytest.raises(UnknownNameError):
        load_scene(name, [analytic_folder.parent])
