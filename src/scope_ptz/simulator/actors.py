"""Moving actors: their positions at a scene time, and the sprites that are composited over the static world.

A sprite is a rendering of an actor from the viewpoint, with the actor at one point on its path. Between two such points, the
sprite for the nearest point is moved to the actor's exact direction and scaled to its exact distance. For each pixel, the depth
layer determines whether the actor is hidden.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Perspective, Projection, pan_tilt_deg
from scope_ptz.simulator.clearance import TOLERANCE_FRACTION, TOLERANCE_M
from scope_ptz.simulator.mapping.grid import Grid, step_px
from scope_ptz.simulator.mapping.tiles import Place, Tiles
from scope_ptz.simulator.models import ActorSheet, Extent, SceneActor, Sprite
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.runs import measure
from scope_ptz.simulator.viewpoint import Viewpoint

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Appearance:
    """An actor as seen from a viewpoint at one instant.

    Attributes:
        actor: The actor.
        sheet: The sheet that contains its sprites.
        sprite: The sprite to draw.
        view: The perspective view covered by the sprite.
        offset_m: The actor's ground point relative to the optical centre, in camera coordinates.
        scale: The actor's apparent size relative to its size in the sprite.
    """

    actor: SceneActor
    sheet: ActorSheet
    sprite: Sprite
    view: Perspective
    offset_m: Floats
    scale: float

    @property
    def distance_m(self) -> float:
        return float(np.linalg.norm(self.offset_m))


@dataclass(frozen=True, slots=True)
class ActorInView:
    """An actor at one instant, and its position relative to a viewpoint.

    Attributes:
        actor: The actor.
        sheet: The sheet that contains its sprites.
        offset_m: The actor's ground point (3,) relative to the optical centre, in camera coordinates.
        path_s: Path time in seconds; see ``PathPosition``.
        phase: Phase of a walker's stride, from 0 to 1.
    """

    actor: SceneActor
    sheet: ActorSheet
    offset_m: Floats
    path_s: float
    phase: float


@dataclass(frozen=True, slots=True)
class PathPosition:
    """An actor's position on its path.

    Attributes:
        path_s: Path time in seconds, which starts again at 0 after each period of the path.
        walked_m: Distance from the start of the path, along the path.
        position_m: Ground point (3,) in world coordinates.
    """

    path_s: float
    walked_m: float
    position_m: Floats


def path_position(actor: SceneActor, time_s: float) -> PathPosition | None:
    """Return an actor's position at a scene time, or None if the actor is not in the scene at that time."""
    path = np.array(actor.waypoints, dtype=np.float64)
    path_s = (time_s - actor.delay_s) % actor.period_s
    if not path[0, 0] <= path_s <= path[-1, 0]:
        return None
    walked = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(path[:, 1:], axis=0), axis=-1)))
    position_m = np.array([np.interp(path_s, path[:, 0], path[:, axis]) for axis in (1, 2, 3)])
    return PathPosition(path_s, float(np.interp(path_s, path[:, 0], walked)), position_m)


def appearances(scene: Scene, viewpoint: Viewpoint, time_s: float) -> list[Appearance]:
    """Return the actors that are in the scene at a time and have sprites for this viewpoint, farthest first."""
    return _appearances_of(viewpoint, ((actor, time_s) for actor in scene.file.actors))


def composited_appearances(scene: Scene, viewpoint: Viewpoint, time_s: float) -> list[Appearance]:
    """Return everything that is composited over the static world, farthest first.

    This includes the actors and, in a scene variation, the held objects: actors that stand still in that variation.
    """
    moving = ((actor, time_s) for actor in scene.file.actors)
    return _appearances_of(viewpoint, (*moving, *((held.actor, held.time_s) for held in scene.held)))


def composited_actors(scene: Scene, viewpoint: Viewpoint, time_s: float) -> list[ActorInView]:
    """Return the same actors as ``composited_appearances``, farthest first, without selecting sprites."""
    moving = ((actor, time_s) for actor in scene.file.actors)
    return _actors_in_view(viewpoint, (*moving, *((held.actor, held.time_s) for held in scene.held)))


def _appearances_of(viewpoint: Viewpoint, actors: Iterable[tuple[SceneActor, float]]) -> list[Appearance]:
    return [_appearance(viewpoint, actor_in_view) for actor_in_view in _actors_in_view(viewpoint, actors)]


def _actors_in_view(viewpoint: Viewpoint, actors: Iterable[tuple[SceneActor, float]]) -> list[ActorInView]:
    in_view = []
    for actor, time_s in actors:
        sheet, position = viewpoint.sheets.get(actor.number), path_position(actor, time_s)
        if sheet is not None and position is not None:
            phase = position.walked_m / sheet.stride_m % 1.0 if sheet.stride_m else 0.0
            in_view.append(ActorInView(actor, sheet, viewpoint.offset(position.position_m), position.path_s, phase))
    return sorted(in_view, key=lambda a: (-float(np.linalg.norm(a.offset_m)), a.actor.number))


def _appearance(viewpoint: Viewpoint, actor_in_view: ActorInView) -> Appearance:
    actor, sheet, offset_m = actor_in_view.actor, actor_in_view.sheet, actor_in_view.offset_m

    def mismatch(sprite: Sprite) -> tuple[float, float]:
        phase_difference = abs(sprite.phase - actor_in_view.phase)
        return abs(sprite.path_s - actor_in_view.path_s), min(phase_difference, 1.0 - phase_difference)

    # Select the sprite that is nearest on the path and, for walkers, nearest in stride phase.
    sprite = min(sheet.sprites, key=mismatch)
    sprite_offset_m = viewpoint.offset(np.array(sprite.position_m))
    scale = float(np.linalg.norm(sprite_offset_m) / np.linalg.norm(offset_m))
    rendered = Perspective(sprite.pan_deg, sprite.tilt_deg, sprite.hfov_deg, sprite.width, sprite.height)
    hfov_deg = float(np.degrees(2 * np.arctan(sprite.width / 2 * scale / rendered.focal_px)))
    # Aim the view so that the sprite's ground point lies in the actor's current direction at the new scale.
    ground_point = rendered.points(sprite_offset_m)
    pan, tilt = sprite.pan_deg, sprite.tilt_deg
    target_pan, target_tilt = (float(a) for a in pan_tilt_deg(offset_m))
    for _ in range(6):
        current_pan, current_tilt = pan_tilt_deg(
            Perspective(pan, tilt, hfov_deg, sprite.width, sprite.height).directions(ground_point)
        )
        pan += (target_pan - float(current_pan) + 180.0) % 360.0 - 180.0
        tilt += target_tilt - float(current_tilt)
    return Appearance(actor, sheet, sprite, Perspective(pan, tilt, hfov_deg, sprite.width, sprite.height), offset_m, scale)


def actor_extent(viewpoint: Viewpoint, appearance: Appearance) -> Extent:
    """Return the actor's current silhouette, including hidden parts."""
    silhouette = viewpoint.sprites.distances(appearance.sheet, appearance.sprite) > 0
    measures = measure(silhouette.astype(np.uint16), appearance.view)
    if not len(measures.ids):
        return Extent(number=appearance.actor.number, solid_angle_sr=0.0, hull=[], distance_m=appearance.distance_m)
    x0, y0, x1, y1 = measures.box[0]
    corners = appearance.view.directions(np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))
    pan, tilt = pan_tilt_deg(corners)
    return Extent(
        number=appearance.actor.number,
        solid_angle_sr=float(measures.solid_angle_sr[0]),
        hull=list(zip(pan.tolist(), tilt.tolist(), strict=True)),
        distance_m=float(_distances(viewpoint, appearance)[silhouette].min()),
    )


def may_be_visible(appearance: Appearance, projection: Projection) -> bool:
    """Return whether an actor is at least partly within the directions that a view covers. Occlusion is ignored."""
    return place_of(appearance, projection) is not None


def place_of(appearance: Appearance, projection: Projection) -> Place | None:
    """Return the rows and columns of a view in which an actor may be visible; None if the actor is outside the view."""
    tile_in_view = next(iter(Tiles([appearance.view]).in_view(projection)), None)
    return None if tile_in_view is None else tile_in_view.place


def draw_instance_ids(
    viewpoint: Viewpoint,
    projection: Projection,
    appearance: Appearance,
    depth_m: NDArray[np.float32],
    ids: NDArray[np.uint16],
) -> None:
    """Draw one actor into a view's instance IDs, in place.

    Args:
        viewpoint: The viewpoint with the actor's sprites.
        projection: Projection of the view.
        appearance: The actor at this instant.
        depth_m: Distances to the static world in the rows and columns in which the actor may be visible; see ``place_of``.
        ids: (H, W) instance IDs to draw into.
    """
    sprite = Tiles([appearance.view])
    tile_in_view = next(iter(sprite.in_view(projection)), None)
    if tile_in_view is None:
        return
    place = tile_in_view.place
    grid = Grid(projection, step_px(projection), place)
    uv = sprite.points(tile_in_view, projection, grid.x, grid.y)
    where = grid.to_pixels(uv * (appearance.sprite.width, appearance.sprite.height) - 0.5)
    distance_m = cv2.remap(_distances(viewpoint, appearance), where, None, cv2.INTER_NEAREST, borderValue=0.0)
    static_m = depth_m * (1 + TOLERANCE_FRACTION) + TOLERANCE_M
    ids[place][(distance_m > 0) & (distance_m <= static_m)] = appearance.actor.number


def _distances(viewpoint: Viewpoint, appearance: Appearance) -> NDArray[np.float32]:
    """Return the current distances, in metres, of the sprite's (h, w) pixels; 0 where the sprite does not show the actor."""
    codes = viewpoint.sprites.distances(appearance.sheet, appearance.sprite)
    return np.where(codes > 0, viewpoint.depth_metres[codes] / np.float32(appearance.scale), np.float32(0.0))
