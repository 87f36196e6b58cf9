"""Varied worlds: exact, different from their scene, and with pixels and truth that agree."""

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


def test_the_same_number_is_the_same_world_and_another_is_another(analytic_folder: Path, analytic_scene: Scene) -> None:
    told = [state_of(analytic_scene.varied(n)) for n in NUMBERS]
    assert told == [state_of(load_scene(f"analytic-yard-v{n}", [analytic_folder.parent])) for n in NUMBERS]
    assert len(set(told)) == len(told)


def test_presets_are_elsewhere_at_the_same_viewpoints(analytic_scene: Scene) -> None:
    file = analytic_scene.varied(3).file
    assert [p.viewpoint for p in file.presets] == [p.viewpoint for p in analytic_scene.file.presets]
    assert not {p.name for p in file.presets} & {p.name for p in analytic_scene.file.presets}
    assert len({p.name for p in file.presets}) == len(file.presets)
    assert file.home_preset in {p.name for p in file.presets}


def test_every_fate_of_a_moving_thing_comes_up(analytic_scene: Scene) -> None:
    worlds = [analytic_scene.varied(n) for n in NUMBERS]
    assert {(len(w.file.actors), len(w.held)) for w in worlds} == {(1, 0), (0, 1), (0, 0)}
    assert all(w.file.actors[0].delay_s > 1 for w in worlds if w.file.actors)
    # What is held is a thing like any other.
    assert all(("roller-50" in {i.id for i in w.file.instances}) == bool(w.held) for w in worlds)


@pytest.mark.parametrize("number", [n for n in NUMBERS if n < 9])
def test_what_changes_in_the_picture_is_what_the_truth_says(analytic_scene: Scene, number: int) -> None:
    world = analytic_scene.varied(number)
    still = analytic_scene.varied(number)
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
async def test_a_camera_in_a_varied_world_says_so(analytic_scene: Scene) -> None:
    world = analytic_scene.varied(2)
    camera = SimulatedCamera(world, width=64, height=36)
    frame = await camera.frame()
    assert frame.origin is not None and frame.origin.scene == "analytic-yard-v2"
    assert [p.name for p in await camera.presets()] == [p.name for p in world.file.presets]


def test_those_who_go_together_share_their_fate(analytic_scene: Scene) -> None:
    (roller,) = analytic_scene.file.actors
    dog = roller.model_copy(update={"id": "dog-1", "waypoints": [(t, x + 1, y, z) for t, x, y, z in roller.waypoints]})
    late: SceneActor = dog.model_copy(update={"id": "dog-2", "waypoints": [(t + 1, x, y, z) for t, x, y, z in roller.waypoints]})
    assert [[a.id for a in group] for group in companions([roller, late, dog])] == [[roller.id, "dog-1"], ["dog-2"]]


@pytest.mark.parametrize("name", ["analytic-yard-v0", "analytic-yard-v", "analytic-yard-v1.5", "nowhere-v3", "../analytic-yard-v1"])
def test_other_names_are_no_worlds(analytic_folder: Path, name: str) -> None:
    with pytest.raises(UnknownNameError):
        load_scene(name, [analytic_folder.parent])
