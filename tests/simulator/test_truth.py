"""Ground truth of visibility and legibility, compared with the analytic world."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest

from scope_ptz.geometry import AXIS_M5075_G, Equirectangular, Perspective
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.runs import measure
from scope_ptz.simulator.text_geometry import text_geometry
from scope_ptz.simulator.truth import MIN_VISIBLE_PX, Sighting, view_truth
from tests.support.synthetic_pack import HEIGHT, TEXT, VIEWPOINTS, WIDTH, perfect_view

OUT_OF_SCENE_S = 8.0


def _view(pan: float, tilt: float, zoom: float) -> Perspective:
    return Perspective(pan, tilt, AXIS_M5075_G.hfov_deg(zoom), WIDTH, HEIGHT)


def _seen(
    scene: Scene, view: Perspective | Equirectangular, viewpoint: str = "mast", time_s: float = OUT_OF_SCENE_S
) -> dict[int, Sighting]:
    return {s.instance.number: s for s in view_truth(scene, viewpoint, view, time_s).sightings}


def test_boxes_and_pixels_are_those_of_a_perfect_camera(analytic_scene: Scene) -> None:
    view = _view(0.0, -8.0, 1.0)
    _, perfect, _ = perfect_view("mast", view, coloured=False)
    seen = _seen(analytic_scene, view)
    assert set(seen) == set(np.unique(perfect).tolist()) - {0}
    for number, sighting in seen.items():
        ys, xs = np.nonzero(perfect == number)
        true_box = np.array([xs.min() / WIDTH, ys.min() / HEIGHT, (xs.max() + 1) / WIDTH, (ys.max() + 1) / HEIGHT])
        assert np.abs(np.array(sighting.box) - true_box).max() <= 1.01 / HEIGHT
        assert sighting.pixels == pytest.approx(len(xs), rel=0.15 if len(xs) < 400 else 0.03)
        x, y = int(sighting.point[0] * WIDTH), int(sighting.point[1] * HEIGHT)
        assert perfect[y, x] == number


def test_distances_and_directions(analytic_scene: Scene) -> None:
    ball = _seen(analytic_scene, _view(0.0, -8.0, 1.0))[1]
    eye, centre = np.array(VIEWPOINTS["mast"][0]), np.array([3.0, 14.0, 1.2])
    assert ball.distance_m == pytest.approx(np.linalg.norm(centre - eye) - 1.2, rel=0.01)
    assert ball.pan_deg == pytest.approx(np.degrees(np.arctan2(3, 14)), abs=0.2)
    assert ball.tilt_deg == pytest.approx(np.degrees(np.arctan2(-2.8, np.hypot(3, 14))), abs=0.2)


def test_unobstructed_objects_are_fully_visible(analytic_scene: Scene) -> None:
    seen = _seen(analytic_scene, _view(0.0, -8.0, 1.0))
    for number in (1, 2, 3, 7):
        assert seen[number].visible_fraction == pytest.approx(1.0, abs=0.02)
        assert seen[number].visible
        assert not seen[number].cut
        assert not seen[number].occluded


def test_objects_cut_off_by_the_frame_are_not_occluded(analytic_scene: Scene) -> None:
    # The left edge of the frame goes through the middle of ball 1.
    middle = np.degrees(np.arctan2(3, 14))
    view = _view(float(middle) + 35.5, -10.0, 1.0)
    ball = _seen(analytic_scene, view)[1]
    perfect = measure(perfect_view("mast", view, coloured=False)[1], view)
    whole = analytic_scene.viewpoint("mast").extents[1].solid_angle_sr
    assert ball.visible_fraction == pytest.approx(perfect.solid_angle_sr[perfect.ids == 1][0] / whole, abs=0.02)
    assert 0.4 < ball.visible_fraction < 0.7
    assert ball.cut
    assert not ball.occluded


def test_the_actor_hides_what_is_behind_it(analytic_scene: Scene) -> None:
    view = _view(0.0, -8.0, 1.0)
    time_s = 4.2  # the roller is in front of block 3
    _, perfect, _ = perfect_view("mast", view, time_s, coloured=False)
    _, without, _ = perfect_view("mast", view, coloured=False)
    block = _seen(analytic_scene, view, time_s=time_s)[3]
    assert block.visible_fraction == pytest.approx((perfect == 3).sum() / (without == 3).sum(), abs=0.03)
    assert block.occluded
    assert not block.cut


def test_small_objects_are_sightings_but_not_visible(analytic_scene: Scene) -> None:
    far = _seen(analytic_scene, _view(18.5, -3.0, 1.0))[8]
    assert 0 < far.pixels < MIN_VISIBLE_PX
    assert far.visible_fraction > 0.9
    assert not far.visible
    assert _seen(analytic_scene, _view(18.5, -3.0, 5.0))[8].visible


def test_a_full_turn_sees_everything_once(analytic_scene: Scene) -> None:
    panorama = Equirectangular(-180.0, 360.0, 35.0, -75.0, 2400, 733)
    seen = _seen(analytic_scene, panorama)
    assert set(seen) == {1, 2, 3, 4, 5, 6, 7, 8}
    for sighting in seen.values():
        # Block 4 and the balls stand free of each other from the mast.
        assert sighting.visible_fraction > 0.9
        assert not sighting.cut


def test_at_the_seam_of_a_panorama_the_larger_part_defines_the_box(analytic_scene: Scene) -> None:
    # Ball 5 is behind, where a panorama from -180 to 180 closes.
    closed = _seen(analytic_scene, Equirectangular(-180.0, 360.0, 35.0, -75.0, 2400, 733))[5]
    open_ = _seen(analytic_scene, Equirectangular(0.0, 360.0, 35.0, -75.0, 2400, 733))[5]
    assert closed.pixels == pytest.approx(open_.pixels, rel=0.01)
    assert closed.box[2] - closed.box[0] <= open_.box[2] - open_.box[0]
    assert closed.visible_fraction == pytest.approx(open_.visible_fraction, abs=0.01)


def test_solid_angles_add_up_to_the_frame(analytic_scene: Scene) -> None:
    view = Perspective(20.0, -30.0, 71.0, 64, 36)
    whole = measure(np.ones((36, 64), dtype=np.uint16), view)
    a, b = np.tan(np.radians(view.hfov_deg / 2)), np.tan(np.radians(view.vfov_deg / 2))
    assert whole.solid_angle_sr[0] == pytest.approx(4 * np.arctan(a * b / np.sqrt(1 + a * a + b * b)), rel=1e-3)
    sphere = measure(np.ones((18, 36), dtype=np.uint16), Equirectangular(0.0, 360.0, 90.0, -90.0, 36, 18))
    assert sphere.solid_angle_sr[0] == pytest.approx(4 * np.pi)


def test_nothing_in_view_is_an_empty_truth(analytic_scene: Scene) -> None:
    truth = view_truth(analytic_scene, "mast", _view(-90.0, 25.0, 5.0), OUT_OF_SCENE_S)
    assert truth.sightings == ()
    assert truth.texts == ()
    assert truth.visible == ()
    assert truth.legible == ()


def test_text_is_legible_when_large_enough(analytic_scene: Scene) -> None:
    def text(zoom: float) -> tuple[float, bool]:
        (sighting,) = view_truth(analytic_scene, "mast", _view(-16.5, -3.0, zoom), OUT_OF_SCENE_S).texts
        return sighting.cap_height_px, sighting.legible

    small, wide = text(1.0)
    large, close = text(3.0)
    assert not wide
    assert close
    # Three times the magnification, a little less than three times the focal length.
    assert large / small == pytest.approx(AXIS_M5075_G.focal(3.0) / AXIS_M5075_G.focal(1.0), rel=0.03)
    distance = np.linalg.norm(np.array(TEXT.centre_m) - np.array(VIEWPOINTS["mast"][0]))
    assert small == pytest.approx(TEXT.cap_height_m / distance * _view(0, 0, 1.0).focal_px, rel=0.1)


def test_text_cut_by_the_frame_is_not_legible(analytic_scene: Scene) -> None:
    (sighting,) = view_truth(analytic_scene, "mast", _view(-9.5, -3.0, 4.5), OUT_OF_SCENE_S).texts
    assert sighting.cap_height_px > 14
    assert sighting.unhidden_fraction < 0.9
    assert not sighting.legible


def test_text_on_the_far_side_is_not_legible(analytic_scene: Scene) -> None:
    # Turn the board: its back faces the mast.
    text = TEXT.model_copy(update={"right": (-1.0, 0.0, 0.0)})
    scene = Scene(analytic_scene.folder)
    scene.file = scene.file.model_copy(update={"texts": [text]})
    assert view_truth(scene, "mast", _view(-16.5, -3.0, 3.0), OUT_OF_SCENE_S).texts == ()


def test_a_text_hidden_by_its_own_object_is_not_legible(analytic_scene: Scene) -> None:
    # Like the name on a door behind the awning of the same shop: what hides it hangs together with it.
    eye, centre = np.array(VIEWPOINTS["mast"][0]), np.array(TEXT.centre_m)
    behind = TEXT.model_copy(update={"centre_m": tuple(eye + 1.15 * (centre - eye))})
    scene = Scene(analytic_scene.folder)
    scene.file = scene.file.model_copy(update={"texts": [behind]})
    (sighting,) = view_truth(scene, "mast", _view(-16.5, -3.0, 3.0), OUT_OF_SCENE_S).texts
    assert sighting.unhidden_fraction < 0.1
    assert not sighting.legible


def test_texts_are_measured_once_for_each_viewpoint_and_released_with_it(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    geometry = text_geometry(analytic_scene, viewpoint)
    assert text_geometry(analytic_scene, viewpoint) is geometry
    assert all(angle_deg < 90.0 for angle_deg in geometry.angle_deg)
    released = weakref.ref(viewpoint)
    analytic_scene.release()
    del viewpoint
    gc.collect()
    assert released() is None
    assert text_geometry(analytic_scene, analytic_scene.viewpoint("mast")) is not geometry
