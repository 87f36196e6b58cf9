"""Write a pack of the analytic world, and render the views of a perfect camera in it."""

from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from scope_ptz.geometry import Equirectangular, Perspective, Projection, direction, pan_tilt_deg
from scope_ptz.simulator import layers
from scope_ptz.simulator.models import (
    ActorSheet,
    Band,
    Depth,
    Extent,
    Layer,
    Manifest,
    SceneActor,
    SceneFile,
    SceneInstance,
    ScenePreset,
    SceneText,
    SceneViewpoint,
    Sprite,
    Tile,
)
from tests.support.analytic_world import Ball, Block, Floats, Solid, cast

WIDTH, HEIGHT = 480, 270
"""Frame size of the tests. The stored layers have the same density for it as those of a real pack for 1280x720."""

NEAR_M, FAR_M = 0.5, 1000.0
BAND = Band(top_tilt_deg=56.0, bottom_tilt_deg=-90.0)

SOLIDS: list[Solid] = [
    Ball(1, (3.0, 14.0, 1.2), 1.2, (0.9, 0.2, 0.15)),
    Ball(2, (-4.0, 10.0, 0.8), 0.8, (0.2, 0.3, 0.9)),
    Block(3, (-1.0, 17.0, 0.0), (2.0, 19.0, 2.5), (0.95, 0.8, 0.2)),
    Block(4, (8.0, 6.0, 0.0), (10.0, 9.0, 3.0), (0.2, 0.7, 0.3)),
    Ball(5, (0.6, -9.0, 1.0), 1.0, (0.8, 0.4, 0.9)),
    Ball(6, (1.0, 2.2, 0.4), 0.4, (0.3, 0.9, 0.9)),
    Block(7, (-8.0, 20.0, 2.0), (-4.0, 20.3, 4.0), (0.1, 0.35, 0.15)),
    Ball(8, (20.0, 60.0, 0.8), 0.8, (1.0, 0.5, 0.1)),
]
NAMES = {1: "ball", 2: "ball", 3: "block", 4: "block", 5: "ball", 6: "ball", 7: "board", 8: "ball"}

ACTOR_NUMBER = 50
ACTOR_RADIUS_M = 0.9
WAYPOINTS = [(1.0, -9.0, 15.0, 0.0), (7.0, 9.0, 15.0, 0.0)]
PERIOD_S = 10.0

VIEWPOINTS = {"mast": ((0.0, 0.0, 4.0), 0.0), "roof": ((-6.0, -6.0, 7.0), 40.0)}
BASE_WIDTH = {"mast": 2304, "roof": 1152}
"""Panorama widths in pixels. The mast has the density of a real pack; the roof is only a second viewpoint."""

TILE_SIZE = 600, 338
TILES = {
    "mast": [(-16.0, 1.0, 16.0), (-4.0, -2.0, 16.0), (10.0, -6.0, 16.0), (18.5, -3.0, 15.0), (14.0, -4.0, 44.0)],
    "roof": [(-36.0, -5.0, 16.0)],
}
"""Pan, tilt and field of view of tiles, in degrees. The last tile of the mast is wider and surrounds sharper ones."""

TEXT = SceneText(
    id="board-text",
    text="NO ENTRY",
    parent="board-07",
    centre_m=(-6.0, 20.0, 3.0),
    right=(1.0, 0.0, 0.0),
    up=(0.0, 0.0, 1.0),
    width_m=3.0,
    height_m=0.7,
    cap_height_m=0.6,
)


def actor_ball(time_s: float) -> Ball | None:
    """Return the moving ball at a time, or None while it is absent."""
    t = time_s % PERIOD_S
    (t0, x0, y0, z0), (t1, x1, _, _) = WAYPOINTS
    if not t0 <= t <= t1:
        return None
    return Ball(ACTOR_NUMBER, (x0 + (x1 - x0) * (t - t0) / (t1 - t0), y0, z0 + ACTOR_RADIUS_M), ACTOR_RADIUS_M, (0.9, 0.9, 0.9))


def perfect_view(
    viewpoint: str,
    projection: Projection,
    time_s: float | None = None,
    *,
    only: list[Solid] | None = None,
    smooth: int = 1,
    coloured: bool = True,
) -> tuple[NDArray[np.uint8], NDArray[np.uint16], Floats]:
    """Return ray-cast colours, instance IDs and distances. ``time_s`` adds the actor; a pixel has ``smooth`` squared rays."""
    position, bearing = VIEWPOINTS[viewpoint]
    solids = list(SOLIDS if only is None else only)
    if time_s is not None and (ball := actor_ball(time_s)) is not None:
        solids.append(ball)
    origin = np.array(position)
    windows = [(solid, _window(solid, origin, bearing, projection)) for solid in solids]

    def rays(dx: float, dy: float) -> Floats:
        x, y = (np.arange(projection.width) + dx) / projection.width, (np.arange(projection.height) + dy) / projection.height
        points = np.stack(np.meshgrid(x, y), axis=-1)
        return np.asarray(projection.directions(points) @ _camera_to_world(bearing).T)

    colour, numbers, distances = cast(origin, rays(0.5, 0.5), windows, coloured=coloured)
    if coloured and smooth > 1:
        offsets = (np.arange(smooth) + 0.5) / smooth
        parts = [cast(origin, rays(dx, dy), windows)[0].astype(np.float64) for dx in offsets for dy in offsets]
        colour = np.rint(np.mean(parts, axis=0)).astype(np.uint8)
    return colour, numbers, distances


def _window(solid: Solid, origin: Floats, bearing: float, projection: Projection) -> tuple[slice, slice]:
    points = projection.points((solid.outline(origin) - origin) @ _camera_to_world(bearing))
    if np.isnan(points).all():
        return slice(0, 0), slice(0, 0)
    if np.isnan(points).any() or (isinstance(projection, Equirectangular) and np.ptp(points[:, 0]) > 0.5):
        return slice(None), slice(None)
    size = np.array([projection.width, projection.height])
    low = np.clip(np.floor(points.min(axis=0) * size) - 12, 0, size).astype(int)
    high = np.clip(np.ceil(points.max(axis=0) * size) + 12, 0, size).astype(int)
    return slice(low[1], high[1]), slice(low[0], high[0])


def write_scene(root: Path) -> Path:
    """Bake the world into ``root``/analytic-yard and return that folder."""
    folder = root / "analytic-yard"
    scene = SceneFile(
        name="analytic-yard",
        title="Analytic yard",
        version="1",
        blender_version="none",
        viewpoints=[SceneViewpoint(name=n, position_m=p, pan0_bearing_deg=b) for n, (p, b) in VIEWPOINTS.items()],
        presets=[
            ScenePreset(name="yard", viewpoint="mast", pan_deg=0.0, tilt_deg=-8.0, zoom=1.0, description="The whole yard"),
            ScenePreset(name="board", viewpoint="mast", pan_deg=-16.0, tilt_deg=-2.0, zoom=4.0),
            ScenePreset(name="from-the-roof", viewpoint="roof", pan_deg=10.0, tilt_deg=-20.0, zoom=1.5),
        ],
        home_preset="yard",
        instances=[_instance(solid) for solid in SOLIDS],
        texts=[TEXT],
        actors=[
            SceneActor(
                id="roller-50",
                number=ACTOR_NUMBER,
                category="roller",
                name="white roller",
                waypoints=WAYPOINTS,
                period_s=PERIOD_S,
                size_m=(2 * ACTOR_RADIUS_M,) * 3,
            )
        ],
        absent=["zebra"],
    )
    for name in VIEWPOINTS:
        _write_viewpoint(folder / name, name)
    (folder / "scene.json").write_text(scene.model_dump_json(indent=1))
    return folder


def _instance(solid: Solid) -> SceneInstance:
    low, high = solid.box
    name = NAMES[solid.number]
    return SceneInstance(
        id=f"{name}-{solid.number:02d}",
        number=solid.number,
        category=name,
        name=f"{name} {solid.number}",
        box_min_m=tuple(low.tolist()),
        box_max_m=tuple(high.tolist()),
    )


def _write_viewpoint(folder: Path, name: str) -> None:
    (folder / "tiles").mkdir(parents=True)
    (folder / "actors").mkdir()
    position, bearing = VIEWPOINTS[name]
    width = BASE_WIDTH[name]
    base, _, _ = perfect_view(name, _sphere(width))
    _, ids, _ = perfect_view(name, _sphere(width * 4 // 3), coloured=False)
    _, _, depth = perfect_view(name, _sphere(width * 2 // 3), coloured=False)
    codes = layers.encode_depth(depth, NEAR_M, FAR_M)
    tiles = [_write_tile(folder, name, index, *aim) for index, aim in enumerate(TILES[name])]
    manifest = Manifest(
        scene="analytic-yard",
        scene_version="1",
        viewpoint=name,
        position_m=position,
        pan0_bearing_deg=bearing,
        blender_version="none",
        samples=1,
        band=BAND,
        base=_write(folder, "base.png", base),
        ids=_write(folder, "ids.png", ids),
        depth=Depth(near_m=NEAR_M, far_m=FAR_M, **_write(folder, "depth.png", codes).model_dump()),
        tiles=tiles,
        extents=[_extent(name, solid) for solid in SOLIDS],
        actors=[_write_actor(folder, name)],
    )
    (folder / "manifest.json").write_text(manifest.model_dump_json(indent=1))


def _sphere(width: int) -> Equirectangular:
    height = round(width * (BAND.top_tilt_deg - BAND.bottom_tilt_deg) / 360)
    return Equirectangular(-180.0, 360.0, BAND.top_tilt_deg, BAND.bottom_tilt_deg, width, height)


def _write_tile(folder: Path, name: str, index: int, pan: float, tilt: float, hfov: float) -> Tile:
    colour, ids, _ = perfect_view(name, Perspective(pan, tilt, hfov, *TILE_SIZE), smooth=2)
    return Tile(
        pan_deg=pan,
        tilt_deg=tilt,
        hfov_deg=hfov,
        colour=_write(folder, f"tiles/{index:02d}.png", colour),
        ids=_write(folder, f"tiles/{index:02d}-ids.png", ids),
    )


def _extent(name: str, solid: Solid) -> Extent:
    position, bearing = VIEWPOINTS[name]
    origin = np.array(position)
    pan, tilt = pan_tilt_deg((solid.outline(origin) - origin) @ _camera_to_world(bearing))
    closeup = _closeup(name, solid, 600)
    _, numbers, distances = perfect_view(name, closeup, only=[solid], coloured=False)
    pixel_sr = (1 / closeup.focal_px) ** 2
    y, x = np.mgrid[0:600, 0:600] + 0.5 - 300
    slant = (1 + (x**2 + y**2) / closeup.focal_px**2) ** -1.5
    return Extent(
        number=solid.number,
        solid_angle_sr=float((slant * pixel_sr)[numbers > 0].sum()),
        hull=list(zip(pan.tolist(), tilt.tolist(), strict=True)),
        distance_m=float(distances[numbers > 0].min()),
    )


def _closeup(name: str, solid: Solid, size: int) -> Perspective:
    """Return a square view that just contains a solid."""
    position, bearing = VIEWPOINTS[name]
    origin = np.array(position)
    rays = (solid.outline(origin) - origin) @ _camera_to_world(bearing)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    middle = rays.mean(axis=0)
    pan, tilt = (float(a) for a in pan_tilt_deg(middle))
    reach = math.acos(float((rays @ direction(pan, tilt)).min()))
    return Perspective(pan, tilt, math.degrees(2 * reach) * 1.1, size, size)


def _write_actor(folder: Path, name: str) -> ActorSheet:
    size, sprites, colours, depths = 96, [], [], []
    for index, path_s in enumerate(np.linspace(WAYPOINTS[0][0], WAYPOINTS[-1][0], 25)):
        ball = actor_ball(float(path_s))
        assert ball is not None
        view = _closeup(name, ball, size)
        colour, _, _ = perfect_view(name, view, only=[ball], smooth=2)
        _, numbers, distances = perfect_view(name, view, only=[ball], coloured=False)
        colours.append(np.dstack([colour, np.where(numbers > 0, 255, 0).astype(np.uint8)]))
        depths.append(np.where(numbers > 0, layers.encode_depth(distances, NEAR_M, FAR_M), 0).astype(np.uint16))
        x, y, z = ball.centre
        sprites.append(
            Sprite(
                path_s=float(path_s),
                position_m=(x, y, z - ACTOR_RADIUS_M),
                pan_deg=view.pan_deg,
                tilt_deg=view.tilt_deg,
                hfov_deg=view.hfov_deg,
                left=index * size,
                top=0,
                width=size,
                height=size,
            )
        )
    return ActorSheet(
        number=ACTOR_NUMBER,
        colour=_write(folder, "actors/roller-50.png", np.hstack(colours)),
        depth=_write(folder, "actors/roller-50-depth.png", np.hstack(depths)),
        sprites=sprites,
    )


def _write(folder: Path, name: str, picture: NDArray[np.uint8] | NDArray[np.uint16]) -> Layer:
    path = folder / name
    Image.fromarray(picture).save(path, compress_level=1)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    return Layer(file=name, sha256=digest, width=picture.shape[1], height=picture.shape[0])


def _camera_to_world(bearing_deg: float) -> Floats:
    """Return the (3, 3) matrix that rotates camera-frame vectors clockwise by the bearing into world axes."""
    b = math.radians(bearing_deg)
    return np.array([[math.cos(b), math.sin(b), 0.0], [-math.sin(b), math.cos(b), 0.0], [0.0, 0.0, 1.0]])
