"""Moving actors in rendered views, compared with exact ray casts."""

from __future__ import annotations

import numpy as np
import pytest

from scope_ptz.geometry import AXIS_M5075_G, Perspective
from scope_ptz.simulator.actors import actor_extent, appearances, path_position
from scope_ptz.simulator.models import ActorSheet, SceneActor
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import view_truth
from scope_ptz.simulator.views import instance_ids, picture
from tests.support.synthetic_pack import ACTOR_NUMBER, ACTOR_RADIUS_M, HEIGHT, PERIOD_S, VIEWPOINTS, WIDTH, actor_ball, perfect_view


def _view(pan: float, tilt: float, zoom: float) -> Perspective:
    return Perspective(pan, tilt, AXIS_M5075_G.hfov_deg(zoom), WIDTH, HEIGHT)


@pytest.mark.parametrize(("viewpoint", "pan", "tilt", "zoom"), [("mast", 0.0, -8.0, 1.0), ("roof", -25.0, -13.0, 1.5)])
@pytest.mark.parametrize("time_s", [1.2, 2.77, 4.2, 5.9, 16.3])
def test_actor_pixels_are_those_of_a_perfect_camera(
    analytic_scene: Scene, viewpoint: str, pan: float, tilt: float, zoom: float, time_s: float
) -> None:
    view = _view(pan, tilt, zoom)
    got = instance_ids(analytic_scene, viewpoint, view, time_s) == ACTOR_NUMBER
    perfect = perfect_view(viewpoint, view, time_s, coloured=False)[1] == ACTOR_NUMBER
    assert perfect.sum() > 300
    assert (got & perfect).sum() / (got | perfect).sum() > 0.94


@pytest.mark.parametrize("time_s", [2.77, 4.2])
def test_actor_colour_is_that_of_a_perfect_camera(analytic_scene: Scene, time_s: float) -> None:
    view = _view(0.0, -8.0, 2.0)
    got = picture(analytic_scene, "mast", view, time_s).astype(int)
    perfect, numbers, _ = perfect_view("mast", view, time_s, smooth=2)
    own = numbers == ACTOR_NUMBER
    # The stripes stay with the world while a sprite moves by up to half a step, so only their mean must agree.
    assert np.abs(got[own].mean(axis=0) - perfect[own].mean(axis=0)).max() < 12
    assert np.abs(got[~own] - perfect[~own]).mean() < 4


def test_actor_behind_something_is_hidden(analytic_scene: Scene) -> None:
    # From the roof, block 4 and ball 1 stand between the eye and the right end of the path.
    view = _view(0.0, -10.0, 1.0)
    hidden = 0
    for time_s in np.arange(1.1, 7.0, 0.4):
        got = instance_ids(analytic_scene, "roof", view, float(time_s))
        perfect = perfect_view("roof", view, float(time_s), coloured=False)[1]
        whole = perfect_view("roof", view, float(time_s), only=[], coloured=False)[1]
        share, true_share = ((n == ACTOR_NUMBER).sum() / max(1, (whole == ACTOR_NUMBER).sum()) for n in (got, perfect))
        assert share == pytest.approx(true_share, abs=0.1)  # of some 80 pixels
        hidden += true_share < 0.9
    assert hidden


def test_extent_is_the_whole_silhouette(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    for time_s in (1.3, 4.0, 6.6):
        (appearance,) = appearances(analytic_scene, viewpoint, time_s)
        ball = actor_ball(time_s)
        assert ball is not None
        distance = float(np.linalg.norm(np.array(ball.centre) - np.array(VIEWPOINTS["mast"][0])))
        whole = actor_extent(viewpoint, appearance)
        assert whole.solid_angle_sr == pytest.approx(2 * np.pi * (1 - np.sqrt(1 - (ACTOR_RADIUS_M / distance) ** 2)), rel=0.03)
        assert whole.distance_m == pytest.approx(distance - ACTOR_RADIUS_M, rel=0.02)


def test_actor_is_in_the_truth_while_it_is_in_the_scene(analytic_scene: Scene) -> None:
    view = _view(0.0, -8.0, 1.0)

    def visible(time_s: float) -> set[str]:
        return {s.instance.id for s in view_truth(analytic_scene, "mast", view, time_s).visible}

    assert "roller-50" in visible(3.0)
    assert "roller-50" in visible(3.0 + PERIOD_S)
    assert "roller-50" not in visible(0.5)
    assert "roller-50" not in visible(8.0)


def test_positions_follow_the_waypoints() -> None:
    actor = SceneActor(
        id="a",
        number=1,
        category="a",
        name="a",
        size_m=(1, 1, 1),
        period_s=20.0,
        waypoints=[(2.0, 0.0, 0.0, 0.0), (4.0, 4.0, 0.0, 0.0), (8.0, 4.0, 3.0, 0.0)],
    )
    assert path_position(actor, 1.0) is None
    assert path_position(actor, 9.0) is None
    for time_s, place, walked_m in ((3.0, (2.0, 0.0, 0.0), 2.0), (23.0, (2.0, 0.0, 0.0), 2.0), (8.0, (4.0, 3.0, 0.0), 7.0)):
        here = path_position(actor, time_s)
        assert here is not None
        np.testing.assert_allclose(here.position_m, place)
        assert here.walked_m == pytest.approx(walked_m)


def test_a_walker_shows_the_phase_of_its_stride(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    (sheet,) = viewpoint.manifest.actors
    sprites = [s.model_copy(update={"phase": phase}) for s in sheet.sprites for phase in (0.0, 0.25, 0.5, 0.75)]
    walking = ActorSheet(number=sheet.number, colour=sheet.colour, depth=sheet.depth, sprites=sprites, stride_m=1.2)
    viewpoint = Scene(analytic_scene.folder).viewpoint("mast")
    viewpoint.manifest = viewpoint.manifest.model_copy(update={"actors": [walking]})
    phases = [
        appearances(analytic_scene, viewpoint, 1.0 + walked / 3.0)[0].sprite.phase for walked in (0.0, 0.3, 0.6, 0.9, 1.15, 1.2)
    ]
    assert phases == [0.0, 0.25, 0.5, 0.75, 0.0, 0.0]


def test_a_soft_shadow_darkens_the_ground_and_is_not_part_of_the_actor(
    analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene(analytic_scene.folder)
    viewpoint = scene.viewpoint("mast")
    view = _view(0.0, -8.0, 1.0)
    (appearance,) = appearances(scene, viewpoint, 4.0)
    sprite = appearance.sprite
    shadow = np.zeros_like(viewpoint.sprites.colour(appearance.sheet, sprite))
    shadow[..., 3] = 128
    nothing = np.zeros_like(viewpoint.sprites.distances(appearance.sheet, sprite))
    monkeypatch.setattr(viewpoint.sprites, "colour", lambda *_: shadow)
    monkeypatch.setattr(viewpoint.sprites, "distances", lambda *_: nothing)
    still, shaded = picture(scene, "mast", view, 8.0), picture(scene, "mast", view, 4.0)
    changed = (still != shaded).any(axis=-1)
    assert changed.any()
    ratio = shaded[changed].astype(float).sum() / still[changed].sum()
    assert ratio == pytest.approx(0.5, abs=0.03)
    numbers = instance_ids(scene, "mast", view, 4.0)
    assert ACTOR_NUMBER not in numbers
    # The shadow lies on the ground, so neither the sky nor the block that stands behind it is darkened.
    assert not changed[: HEIGHT // 4].any()
