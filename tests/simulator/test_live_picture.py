"""Requirements of live video: prefetching, bounded memory, blended tiles, and actors that keep their heading."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scope_ptz.camera.simulated import SimulatedCamera
from scope_ptz.errors import PackError
from scope_ptz.geometry import AXIS_M5075_G, Perspective
from scope_ptz.simulator.actors import composited_actors
from scope_ptz.simulator.clearance import FLAT_M, TOLERANCE_FRACTION, TOLERANCE_M
from scope_ptz.simulator.drawing import actor_patch
from scope_ptz.simulator.mapping.atlas_map import TILE_GAIN, panorama_density, suitable_scale
from scope_ptz.simulator.mapping.cells import visible_tiles
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.panorama import panorama_map
from scope_ptz.simulator.mapping.tiles import Tiles
from scope_ptz.simulator.occlusion import outlined_depth_part, outlined_depth_view, sharpening_reach_px
from scope_ptz.simulator.pack import Scene, load_scene
from scope_ptz.simulator.pictures import Pictures
from scope_ptz.simulator.prefetch import Prefetch, Prefetches
from scope_ptz.simulator.reproject import colour_view, id_view, view_map
from scope_ptz.simulator.sheets.memory import CAN_RELEASE, ReleasableArray
from scope_ptz.simulator.sprites.choice import Aspect, warp_matrix
from scope_ptz.simulator.views import RENDERING_VERSION, picture
from tests.support.synthetic_pack import HEIGHT, WIDTH


def _view(pan: float, tilt: float, zoom: float, width: int = WIDTH, height: int = HEIGHT) -> Perspective:
    return Perspective(pan, tilt, AXIS_M5075_G.hfov_deg(zoom), width, height)


def test_after_prefetching_no_view_reads_a_file(analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = Scene(analytic_scene.folder)
    assert Prefetch(scene.viewpoint("mast"), width=WIDTH).wait(60)
    monkeypatch.setattr(Pictures, "verify", lambda *_: pytest.fail("a file was read"))
    for pan, tilt, zoom in ((0.0, -8.0, 1.0), (0.0, -8.0, 2.0), (10.0, -6.0, 3.3), (18.5, -3.0, 5.0), (-170.0, -40.0, 5.0)):
        picture(scene, "mast", _view(pan, tilt, zoom), 4.0)


def test_helper_threads_can_be_ended_and_start_again(analytic_scene: Scene) -> None:
    scene = Scene(analytic_scene.folder)
    colour_view(scene.viewpoint("mast"), _view(0.0, -8.0, 2.0))
    id_view(scene.viewpoint("mast"), _view(0.0, -8.0, 2.0))  # with all layers in use, two threads render
    for pan in (1.0, 2.0):
        before = set(threading.enumerate())
        picture(scene, "mast", _view(pan, -8.0, 2.0), 4.0)
        (helper,) = set(threading.enumerate()) - before
        scene.end_threads()
        helper.join(60)
        assert not helper.is_alive()


def test_prefetching_reports_a_damaged_viewpoint(analytic_scene: Scene, tmp_path: Path) -> None:
    scene = Scene(analytic_scene.folder)
    viewpoint = scene.viewpoint("mast")
    viewpoint.pictures.folder = tmp_path
    with pytest.raises(PackError, match="missing"):
        Prefetch(viewpoint, width=WIDTH).wait(60)


def test_a_prefetch_that_starts_after_the_end_of_its_owner_is_cancelled(analytic_scene: Scene) -> None:
    prefetches, early = Prefetches(), []

    def start() -> Prefetch:
        early.append(Prefetch(Scene(analytic_scene.folder).viewpoint("mast"), width=WIDTH))
        return early[-1]

    prefetches.start(start)
    prefetches.cancel()
    prefetches.start(start)
    assert all(prefetch.cancelled for prefetch in early)
    prefetches.wait(60)
    assert all(prefetch.done for prefetch in early)


@pytest.mark.full
def test_a_bounded_cache_shows_the_same_pictures(analytic_scene: Scene) -> None:
    bounded, free = Scene(analytic_scene.folder, tile_bytes=1), Scene(analytic_scene.folder)
    views = [_view(pan, -3.0, zoom) for zoom in (2.0, 5.0, 3.0) for pan in (18.5, -4.0, 10.0, -16.0)]
    for view in (*views, *reversed(views)):
        got, expected = (colour_view(scene.viewpoint("mast"), view) for scene in (bounded, free))
        np.testing.assert_array_equal(got, expected)


@pytest.mark.skipif(not CAN_RELEASE, reason="this system cannot take memory back")
def test_released_rows_are_empty_and_others_are_kept() -> None:
    memory = ReleasableArray((64, 4096), np.uint16)
    memory.array[...] = 7
    memory.release_rows(16, 48)
    assert (memory.array[:16] == 7).all() and (memory.array[48:] == 7).all()
    assert (memory.array[16:48] == 0).all()


@given(st.integers(0, 200), st.integers(0, 300), st.integers(8, 160), st.integers(8, 300), st.floats(1, 5), st.floats(-30, 30))
@settings(max_examples=30, deadline=None)
def test_a_part_is_exactly_that_part_of_the_whole(
    analytic_scene: Scene, top: int, left: int, height: int, width: int, zoom: float, pan: float
) -> None:
    view, viewpoint = _view(pan, -5.0, zoom, 640, 360), analytic_scene.viewpoint("mast")
    part = slice(top, min(360, top + height)), slice(left, min(640, left + width))
    for atlas in (viewpoint.colour_atlas, viewpoint.id_atlas, viewpoint.depth_atlas):
        np.testing.assert_array_equal(view_map(viewpoint, atlas, view, part), view_map(viewpoint, atlas, view)[part])
    whole = outlined_depth_view(viewpoint, view, id_view(viewpoint, view))
    needed = np.full((part[0].stop - part[0].start, part[1].stop - part[1].start), 255, np.uint8)
    np.testing.assert_array_equal(outlined_depth_part(viewpoint, view, part, needed), whole[part])
    np.testing.assert_array_equal(outlined_depth_view(viewpoint, view, id_view(viewpoint, view), part), whole[part])


@given(st.floats(-20, 20), st.floats(-12, 12), st.floats(5, 40))
@settings(max_examples=40, deadline=None)
def test_cells_that_count_as_covered_are_covered(pan: float, tilt: float, hfov_deg: float) -> None:
    view = _view(0.0, 0.0, 1.0, 640, 360)
    for tile_in_view in Tiles([Perspective(pan, tilt, hfov_deg, 300, 200)]).in_view(view):
        mask = tile_in_view.mask()
        assert mask is not None
        whole = np.zeros((view.height, view.width), np.uint8)
        whole[tile_in_view.place] = mask
        for y in range(0, view.height, 40):
            for x in range(0, view.width, 40):
                cell = slice(y, y + 40), slice(x, x + 40)
                visible, rest = visible_tiles([tile_in_view], cell)
                if rest is None or any(tile.whole for tile in visible):
                    assert (whole[cell] == 255).all()
                shown = np.zeros_like(whole)
                for tile in visible:
                    shown[tile.place] = 255
                assert not (whole[cell] & ~shown[cell]).any()
                uncovered = np.argwhere(whole[cell] == 0) + np.array([y, x])
                if len(uncovered):
                    assert rest is not None
                    for axis in (0, 1):
                        assert uncovered[:, axis].min() >= rest[axis].start and uncovered[:, axis].max() < rest[axis].stop


@given(st.floats(-170, 170), st.floats(-40, 10), st.floats(12, 70))
@settings(max_examples=25, deadline=None)
def test_tiles_hidden_by_sharper_ones_change_nothing(analytic_scene: Scene, pan: float, tilt: float, hfov_deg: float) -> None:
    """Maps of all tiles, drawn over each other completely, are the same."""
    viewpoint, view = analytic_scene.viewpoint("mast"), Perspective(pan, tilt, hfov_deg, 640, 360)
    atlas, tiles = viewpoint.colour_atlas, viewpoint.tiles
    found = view_map(viewpoint, atlas, view)
    if view.pixels_per_radian <= TILE_GAIN * panorama_density(atlas):
        return
    whole = slice(0, view.height), slice(0, view.width)
    grid = Grid(view, step_px(view))
    slot = atlas.ensure(0, suitable_scale(atlas, panorama_density(atlas), view.pixels_per_radian))
    expected = panorama_map(viewpoint.manifest.band, slot, grid, whole).copy()
    for tile_in_view in reversed(tiles.in_view(view)):
        slot = atlas.ensure(
            1 + tile_in_view.tile, suitable_scale(atlas, tiles.views[tile_in_view.tile].focal_px, view.pixels_per_radian)
        )
        part = Grid(view, step_px(view), tile_in_view.place)
        nodes = tiles.points(tile_in_view, view, part.x, part.y) * (slot.width, slot.height) + (slot.x - 0.5, slot.y - 0.5)
        mask = tile_in_view.mask()
        assert mask is not None
        inside = mask > 0
        expected[tile_in_view.place][inside] = part.to_pixels(nodes)[inside]
    np.testing.assert_array_equal(found, expected)


@pytest.mark.full
def test_a_camera_that_stands_still_shows_the_same_pictures(analytic_scene: Scene) -> None:
    views = [_view(18.5, -3.0, 2.0), _view(18.5, -3.0, 2.0, 96, 54)]
    still, fresh = Scene(analytic_scene.folder), Scene(analytic_scene.folder)
    for frame in range(6):
        for view in views:
            fresh.release()
            got = picture(still, "mast", view, 4.0 + 0.2 * frame)
            np.testing.assert_array_equal(got, picture(fresh, "mast", view, 4.0 + 0.2 * frame))
            got[...] = 0  # the caller may draw on its picture


def test_a_tile_ends_without_an_edge(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    for index, view in enumerate(viewpoint.tiles.views):
        slot = viewpoint.colour_atlas.ensure(1 + index)
        border = viewpoint.colour_atlas.sheet[slot.y, slot.x : slot.x + slot.width].astype(int)
        panorama = Perspective(view.pan_deg, view.tilt_deg, view.hfov_deg, view.width, view.height)
        around = [s for s in viewpoint.tiles.in_view(panorama) if s.tile != index]
        if around:
            continue  # it may end on another tile
        still = Scene(analytic_scene.folder).viewpoint("mast")
        still.tiles.__init__([])  # type: ignore[misc]
        soft = colour_view(still, panorama)[0].astype(int)
        assert np.abs(border - soft).mean() < 3


def test_a_sprite_from_above_is_rotated_to_the_heading_of_its_actor(analytic_scene: Scene) -> None:
    (actor,) = analytic_scene.file.actors
    bicycle = actor.model_copy(update={"size_m": (0.6, 1.8, 1.9)})
    south = np.array([0.0, -1.0, 0.0])
    above, ahead = Aspect(np.array([-1.0, 0.2, -5.2]), south), Aspect(np.array([-0.5, 4.0, -5.2]), south)
    drawn = warp_matrix(bicycle, above, ahead)
    # From above, south is to the left; from further away it is down, and the upright rider takes part in the fit.
    turned = drawn @ np.array([-1.0, 0.0])
    assert turned[1] < -0.3
    np.testing.assert_allclose(warp_matrix(bicycle, ahead, ahead), np.eye(2), atol=1e-9)


def test_weights_of_sprites_add_up(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    shares = set()
    for time_s in np.arange(1.1, 7.0, 0.05):
        for actor in composited_actors(analytic_scene, viewpoint, float(time_s)):
            choice = viewpoint.sprite_selector(actor.actor, actor.sheet)
            found = choice.choose(Aspect(actor.offset_m, choice.heading(actor.path_s)), actor.phase)
            assert sum(weighted.weight for weighted in found) == pytest.approx(1.0)
            shares.add(len(found))
    assert shares == {1, 2}


@given(st.integers(0, 150), st.integers(0, 240), st.floats(1, 4), st.floats(-30, 30), st.floats(3, 40))
@settings(max_examples=30, deadline=None)
def test_the_coarse_test_never_misses_an_occluder(
    analytic_scene: Scene, top: int, left: int, zoom: float, pan: float, far_m: float
) -> None:
    view, viewpoint = _view(pan, -8.0, zoom, 640, 360), analytic_scene.viewpoint("mast")
    part = slice(top, top + 200), slice(left, left + 300)
    needed = np.full((200, 300), 255, np.uint8)
    ground_m = -float(viewpoint.position_m[2])
    rise = Grid(view, 8, part).to_pixels(Grid(view, 8, part).directions()[..., 2])

    doubtful = np.zeros(needed.shape, bool)
    found = viewpoint.clearance.find_uncertain_part(
        view,
        part,
        needed,
        steepest_rise=float(np.abs(rise).max()),
        reach_px=sharpening_reach_px(viewpoint, view),
        far_m=far_m,
        ground_m=ground_m,
    )
    if found is not None:
        doubtful[found] = True
    static_m = outlined_depth_part(viewpoint, view, part, needed) * (1 + TOLERANCE_FRACTION) + TOLERANCE_M
    # Distances come from up to 2.5 texels away, which matters for the heights of distant points.
    texels = 2.5 * 2 * np.pi / viewpoint.manifest.depth.width
    on_ground = static_m * rise <= ground_m + FLAT_M + static_m * texels  # what stands on the ground is in front of it
    assert not ((static_m < far_m) & ~on_ground & ~doubtful).any()


def test_occlusion_at_half_resolution_is_that_of_every_second_pixel(analytic_scene: Scene) -> None:
    view, viewpoint = _view(0.0, -8.0, 2.0, 640, 360), analytic_scene.viewpoint("mast")
    part = slice(41, 240), slice(0, 331)
    needed = np.full((199, 331), 255, np.uint8)
    whole = outlined_depth_part(viewpoint, view, part, needed)[::2, ::2]
    half = outlined_depth_part(viewpoint, view, part, needed, 2)
    assert half.shape == whole.shape
    # Only pixels at outlines may take their distance from another neighbour.
    assert np.isclose(half, whole, rtol=0.02).mean() > 0.99


def test_an_actor_behind_the_camera_adds_nothing(analytic_scene: Scene) -> None:
    viewpoint = analytic_scene.viewpoint("mast")
    (actor,) = composited_actors(analytic_scene, viewpoint, 4.0)
    assert actor_patch(viewpoint, _view(0.0, -8.0, 1.0), actor) is not None
    assert actor_patch(viewpoint, _view(180.0, -8.0, 1.0), actor) is None


@pytest.mark.full
def test_the_cyclist_on_the_crossing_stays_upright() -> None:
    """At 8.7 s it comes towards the camera, so it is higher than wide; from above it lies along the road."""
    scene = load_scene("high-street")
    viewpoint = scene.viewpoint("crossing")
    for time_s in (8.5, 8.7, 8.76, 10.9):
        actor = next(a for a in composited_actors(scene, viewpoint, time_s) if a.actor.category == "cyclist")
        choice = viewpoint.sprite_selector(actor.actor, actor.sheet)
        best = choice.choose(Aspect(actor.offset_m, choice.heading(actor.path_s)), actor.phase)[0]
        assert abs((best.sprite.pan_deg - np.degrees(np.arctan2(*actor.offset_m[:2])) + 180) % 360 - 180) < 15


def test_the_camera_names_the_version_of_the_rendering(analytic_scene: Scene) -> None:
    assert SimulatedCamera(analytic_scene).info.rendering == RENDERING_VERSION == 3
