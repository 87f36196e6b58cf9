"""Bands, strips, tiles and keyframes: the views that the bake renders."""

import math

import numpy as np
import pytest

from scope_ptz.blender.band import Panorama, reachable_band
from scope_ptz.blender.keyframes import MAX_SIDE_PX, keyframes
from scope_ptz.blender.panorama import join_strips, smooth_rows
from scope_ptz.blender.tiles import Cell, Target, busiest_cells, cover, covers, join_in_rows, select_most_useful, targets
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, direction, pan_tilt_deg
from scope_ptz.simulator.models import Band, SceneActor, SceneFile, ScenePreset, SceneText, SceneViewpoint

HERE = SceneViewpoint(name="mast", position_m=(0.0, 0.0, 6.0), pan0_bearing_deg=30.0)
BAND = Band(top_tilt_deg=59.0, bottom_tilt_deg=-90.0)


def scene_with(*texts: SceneText) -> SceneFile:
    preset = ScenePreset(name="home", viewpoint="mast", pan_deg=0, tilt_deg=0, zoom=1)
    return SceneFile(
        name="yard", title="Yard", version="1", blender_version="5", viewpoints=[HERE], presets=[preset], home_preset="home",
        instances=[], texts=list(texts),
    )  # fmt: skip


@pytest.mark.parametrize("aspect", [16 / 9, 4 / 3])
@pytest.mark.parametrize("tilt", [-60.0, -35.0, 0.0, 30.0])
def test_no_frame_leaves_the_band(tilt: float, aspect: float) -> None:
    band = reachable_band(Limits(), AXIS_M5075_G)
    view = Perspective(0, tilt, 71.0, 400, round(400 / aspect))
    x, y = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21))
    _, tilts = pan_tilt_deg(view.directions(np.stack([x, y], axis=-1)))
    assert tilts.max() < band.top_tilt_deg
    assert tilts.min() >= band.bottom_tilt_deg


def test_a_smaller_camera_gets_a_smaller_band() -> None:
    band = reachable_band(Limits(min_tilt_deg=-20, max_tilt_deg=10), AXIS_M5075_G)
    assert 38 < band.top_tilt_deg < 41
    assert -51 < band.bottom_tilt_deg < -48


def test_strips_join_to_the_complete_image() -> None:
    panorama = Panorama.of(720, BAND)
    x, y = np.meshgrid(np.arange(720), np.arange(panorama.height))
    whole = np.stack([128 + 100 * np.sin(x / 720 * 4 * math.pi), 60 + y / 4, np.full(x.shape, 90)], axis=-1).astype(np.uint8)
    strips = panorama.strips(64, 4)
    assert strips[-1].width < 720
    pictures = []
    for strip in strips:
        columns = ((np.arange(strip.width) + 0.5) * 720 / strip.width).astype(int)
        pictures.append(whole[strip.first_row : strip.last_row, columns])
    error = join_strips(panorama, strips, pictures).astype(int) - whole
    assert np.abs(error).mean() < 1.0


def test_rows_near_the_pole_are_reduced_to_the_visible_resolution() -> None:
    panorama = Panorama.of(360, BAND)
    stripes = np.zeros((panorama.height, 360, 3), dtype=np.uint8)
    stripes[:, ::2] = 200
    result = smooth_rows(stripes, panorama)
    equator = round(panorama.height * 59 / 149)
    assert np.array_equal(result[equator], stripes[equator])
    assert np.ptp(result[-2].astype(int)) < 30


def test_a_tile_shows_its_cell_at_the_requested_density() -> None:
    cell = Cell(-170.0, -35.0, 9.0, 5.0)
    view = cell.view(96.0)
    edge = np.linspace(-0.5, 0.5, 9)
    pans, tilts = np.meshgrid(cell.pan_deg + edge * cell.span_pan_deg, cell.tilt_deg + edge * cell.span_tilt_deg)
    points = view.points(direction(pans, tilts))
    assert points.min() > 0 and points.max() < 1
    assert view.focal_px == pytest.approx(math.degrees(96.0))
    assert view.width % 2 == 0 and view.height % 2 == 0


def test_cells_cover_all_targets_with_few_tiles() -> None:
    rng = np.random.default_rng(3)
    wanted = [
        Target(f"thing-{k}", np.array([[pan, tilt]]) + rng.uniform(-0.5, 0.5, (40, 2)))
        for k, (pan, tilt) in enumerate([(-179.8, -5), (0, -8), (3, -8), (90, -44), (91, 20)])
    ]
    cells = cover(wanted)
    views = [cell.view(48.0) for cell in cells]
    assert all(covers(views, target) for target in wanted)
    assert len(views) <= 12
    best = select_most_useful(cells, wanted, 2)
    assert len(best) == 2 and all(cell in cells for cell in best)
    assert cover([]) == []


def test_neighbours_in_a_row_are_rendered_as_one() -> None:
    row = [Cell(6.0 * k, -4.0, 6.0, 4.0) for k in (0, 1, 2, 3, 6)]
    found = join_in_rows([*row, Cell(0.0, 4.0, 6.0, 4.0), Cell(0.0, -60.0, 12.0, 4.0), Cell(12.0, -60.0, 12.0, 4.0)])
    assert [(c.pan_deg, c.tilt_deg, c.span_pan_deg) for c in found] == [
        (0.0, -60.0, 12.0), (12.0, -60.0, 12.0), (6.0, -4.0, 18.0), (18.0, -4.0, 6.0), (36.0, -4.0, 6.0), (0.0, 4.0, 6.0)
    ]  # fmt: skip
    for cell in row:
        spots = Target("cell", np.array([[cell.pan_deg + x, cell.tilt_deg + y] for x in (-2.9, 2.9) for y in (-1.9, 1.9)]))
        assert covers([c.view(48.0) for c in found], spots)


def test_small_objects_are_targets_and_large_ones_are_not() -> None:
    panorama = Panorama.of(4096, BAND)
    ids = np.zeros((panorama.height, 4096), dtype=np.uint16)
    ids[700:720, 1000:1016] = 1
    ids[700:900, 2000:2300] = 2
    ids[800, 3000] = 3
    found = targets(scene_with(), HERE, ids, panorama.projection)
    assert [t.name for t in found] == ["1"]


def test_texts_are_targets_when_zooming_makes_them_legible() -> None:
    def text(name: str, distance: float, facing: tuple[float, float, float]) -> SceneText:
        return SceneText(
            id=name, text="EXIT", parent="sign-01", centre_m=(0.0, distance, 6.0), right=facing, up=(0, 0, 1),
            width_m=0.8, height_m=0.25, cap_height_m=0.2,
        )  # fmt: skip

    towards, sideways = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    scene = scene_with(
        text("near", 6, towards), text("good", 40, towards), text("far", 400, towards), text("edge-on", 40, sideways)
    )
    ids = np.zeros((Panorama.of(1024, BAND).height, 1024), dtype=np.uint16)
    found = targets(scene, HERE, ids, Panorama.of(1024, BAND).projection)
    assert [t.name for t in found] == ["good"]
    assert found[0].directions[:, 0].mean() == pytest.approx(-30.0, abs=0.01)


def actor(stride: bool = False) -> SceneActor:
    return SceneActor(
        id="car-90", number=9, category="car", name="car", waypoints=[(0, -60, 20, 0), (8, 60, 20, 0)], period_s=10,
        size_m=(0.6, 0.6, 1.8) if stride else (1.8, 4.4, 1.5),
    )  # fmt: skip


def test_a_passing_car_is_rendered_from_every_visible_side() -> None:
    frames = keyframes(actor(), None, HERE, BAND, np.array([0.5, 0.5, 0.7]), 60)
    assert 25 < len(frames) <= 60
    assert [f.time_s for f in frames] == sorted(f.time_s for f in frames)
    for frame in frames:
        assert max(frame.view.width, frame.view.height) <= MAX_SIDE_PX + 4
        offset = np.array(frame.position_m) - HERE.position_m
        pan, tilt = pan_tilt_deg(offset)
        shown = frame.view.points(direction(pan - HERE.pan0_bearing_deg, tilt))
        assert 0 < shown[0] < 1 and 0 < shown[1] < 1


def test_the_number_of_pictures_is_limited() -> None:
    assert len(keyframes(actor(), None, HERE, BAND, None, 12)) <= 12


def test_a_walker_has_all_gait_phases_at_each_position() -> None:
    frames = keyframes(actor(stride=True), 1.4, HERE, BAND, None, 40)
    assert len(frames) % 8 == 0
    assert {f.phase for f in frames} == {k / 8 for k in range(8)}


def test_every_leg_of_a_path_has_its_own_pictures_up_to_its_corners() -> None:
    corners = [(0.0, -5.0, 20.0, 0.0), (9.0, -5.0, 40.0, 0.0), (10.0, -3.0, 40.0, 0.0), (20.0, -3.0, 20.0, 0.0)]
    walker = actor(stride=True).model_copy(update={"waypoints": corners})
    frames = keyframes(walker, 1.4, HERE, BAND, None, 24)
    assert len(frames) == 24
    taken = {time: k // 8 for k, f in enumerate(frames) for time in (f.time_s, *f.extra_times_s)}
    for time, leg in ((0.5, 0), (8.9, 0), (9.2, 1), (9.9, 1), (10.1, 2), (19.9, 2)):
        assert taken[min(taken, key=lambda t: abs(t - time))] == leg


def test_positions_outside_the_band_are_omitted() -> None:
    assert keyframes(actor(), None, HERE, Band(top_tilt_deg=59, bottom_tilt_deg=30), None, 40) == []


@pytest.mark.full
def test_wider_tiles_cover_the_most_outlines() -> None:
    panorama = Panorama.of(1440, BAND)
    ids = np.zeros((panorama.height, 1440), dtype=np.uint16)
    row = round((59.0 + 12.0) / 149.0 * panorama.height)  # tilt -12
    for column in range(1300, 1440, 8):  # pan 145 to 180: posts, and
        ids[row - 20 : row + 20, column : column + 4] = 1 + column
    ids[row - 20 : row + 20, 0:300] = 9  # pan -180 to -105: one long wall
    (cell,) = busiest_cells(ids, panorama.projection, 1)
    assert abs(cell.pan_deg - 162.0) < 12.0 and abs(cell.tilt_deg + 12.0) < 6.0
    cells = busiest_cells(ids, panorama.projection, 14)
    assert len(cells) < 14, "nothing is spent on cells without outlines"
    views = [c.view(34.0) for c in cells]
    posts = Target("posts", np.stack([np.linspace(146.0, 178.0, 20), np.full(20, -12.0)], axis=-1))
    assert covers(views, posts)
