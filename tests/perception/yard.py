"""A road works yard made by hand: 40 things in front of one camera, with its ground truth worked out from their boxes.

The camera stands at the origin, 6 m up, and looks north; x is to the right, y away from it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from scope_ptz.camera.base import Frame, FrameOrigin
from scope_ptz.geometry import Perspective, Pose, Projection, pan_tilt_deg
from scope_ptz.simulator.models import SceneActor, SceneFile, SceneInstance, ScenePreset, SceneText, SceneViewpoint
from scope_ptz.simulator.truth import Sighting, TextSighting, ViewTruth

CAMERA_M = np.array([0.0, 0.0, 6.0])
PROJECTION = Perspective(pan_deg=0.0, tilt_deg=-5.0, hfov_deg=70.0, width=1280, height=720)

PERSON, CONE = (0.6, 0.5, 1.8), (0.4, 0.4, 0.75)

Row = tuple[str, str, str, tuple[float, float, float], tuple[float, float, float], dict[str, Any], str | None]

# id, category, name, middle of the foot (x, y, z), size (x, y, z), attributes, parent
ROWS: list[Row] = [
    ("road-01", "road", "road", (0, 60, -0.1), (60, 100, 0.1), {}, None),
    ("car-01", "car", "saloon car", (-12, 30, 0), (1.8, 4.5, 1.5), {"colour": "red", "kind": "saloon", "state": "parked"}, None),
    ("car-02", "car", "hatchback", (-6, 33, 0), (1.8, 4.0, 1.5), {"colour": "white", "kind": "hatchback", "state": "parked"}, None),
    ("car-03", "car", "estate car", (9.5, 48, 0), (1.8, 4.7, 1.5), {"colour": "dark blue", "kind": "estate"}, None),
    ("van-01", "van", "delivery van", (5, 25, 0), (2.1, 5.5, 2.4), {"colour": "white", "beacon": True}, None),
    ("plate-01", "number plate", "number plate", (5, 22.2, 0.5), (0.6, 0.05, 0.2), {"colour": "yellow"}, "van-01"),
    ("lorry-01", "lorry", "tipper lorry", (-2, 50, 0), (2.5, 8, 3.2), {"colour": "orange", "load": "gravel"}, None),
    ("excavator-01", "excavator", "excavator", (13, 35, 0), (3, 7, 3), {"colour": "yellow", "activity": "digging"}, None),
    ("roller-01", "roller", "road roller", (19, 44, 0), (2, 4, 2.6), {"colour": "yellow"}, None),
    ("worker-01", "worker", "worker", (9.8, 33, 0), PERSON, {"vest": "orange", "helmet": "white", "activity": "pointing"}, None),
    ("worker-02", "worker", "worker", (-8, 26, 0), (0.6, 0.5, 1.8), {"vest": "yellow", "helmet": "yellow"}, None),
    ("worker-03", "worker", "worker", (2, 20, 0), PERSON, {"vest": "orange", "helmet": "none", "activity": "walking"}, None),
    *[(f"cone-0{i}", "traffic cone", "traffic cone", (-6.0 + i, 22, 0), CONE, {"colour": "orange"}, None) for i in range(1, 6)],
    ("cone-06", "traffic cone", "fallen cone", (11.5, 30.5, 0), (0.4, 0.4, 0.75), {"colour": "orange", "state": "fallen"}, None),
    ("barrier-01", "barrier", "water-filled barrier", (-2, 42, 0), (6, 0.5, 1), {"colour": "red and white"}, None),
    ("sign-01", "sign", "speed limit sign", (16, 40, 1.5), (0.9, 0.1, 0.9), {"colour": "white", "shape": "round"}, None),
    ("gantry-01", "gantry", "motorway gantry", (0, 80, 0), (30, 1, 8), {"colour": "grey"}, None),
    ("sign-02", "sign", "direction sign", (-3, 79.4, 6), (8, 0.2, 3), {"colour": "blue"}, "gantry-01"),
    ("sign-03", "sign", "road works sign", (-17, 40, 1), (1, 0.1, 1), {"colour": "red", "shape": "triangular"}, None),
    ("gate-01", "gate", "site gate", (-20, 45, 0), (4, 0.2, 2), {"state": "open", "colour": "grey"}, None),
    ("arrow-board-01", "arrow board", "arrow board", (2, 38, 1), (2, 0.3, 1.5), {"lit": True, "direction": "left"}, None),
    ("lamp-post-01", "lamp post", "lamp post", (-14, 52, 0), (0.3, 0.3, 9), {"lit": False}, None),
    ("lamp-post-02", "lamp post", "lamp post", (24, 52, 0), (0.3, 0.3, 9), {"lit": False}, None),
    ("cabin-01", "cabin", "site cabin", (26, 58, 0), (6, 3, 2.8), {"colour": "green", "door": "open"}, None),
    ("tree-01", "tree", "tree", (-30, 70, 0), (5, 5, 9), {}, None),
    ("tree-02", "tree", "tree", (35, 75, 0), (5, 5, 9), {}, None),
    ("fence-panel-01", "fence panel", "fence panel", (20, 54, 0), (3, 0.1, 2), {"material": "mesh"}, None),
    ("spoil-heap-01", "spoil heap", "heap of earth", (14.5, 28, 0), (2, 2, 1.2), {}, None),
]  # fmt: skip
ACTORS: list[tuple[str, str, str, tuple[float, float, float], tuple[float, float, float], dict[str, Any]]] = [
    (
        "car-09",
        "car",
        "moving car",
        (4, 62, 0),
        (1.8, 4.5, 1.5),
        {"colour": "silver", "kind": "saloon", "lane": "left lane"},
    ),
]
# id, text, parent, legible
TEXTS: list[tuple[str, str, str, bool]] = [
    ("van-name", "Northgate Hire", "van-01", True),
    ("van-plate", "AB12 CDE", "plate-01", True),
    ("sign-50", "50", "sign-01", True),
    ("sign-north", "A1 North", "sign-02", True),
    ("cabin-name", "SITE OFFICE", "cabin-01", False),
]
ABSENT = ["dog", "bus", "bicycle", "fire hydrant"]


def _instance(number: int, row: Row) -> SceneInstance:
    id_, category, name, (x, y, z), (w, d, h), attributes, parent = row
    return SceneInstance(
        id=id_, number=number, category=category, name=name, attributes=attributes, parent=parent,
        box_min_m=(x - w / 2, y - d / 2, z), box_max_m=(x + w / 2, y + d / 2, z + h),
    )  # fmt: skip


def _actor(number: int, row: Any) -> SceneActor:
    id_, category, name, (x, y, z), size, attributes = row
    path = [(0.0, x - 20.0, y, z), (10.0, x + 20.0, y, z)]
    return SceneActor(
        id=id_,
        number=number,
        category=category,
        name=name,
        attributes=attributes,
        waypoints=path,
        period_s=10.0,
        size_m=size,
    )


INSTANCES = [_instance(i + 1, row) for i, row in enumerate(ROWS)]
SCENE = SceneFile(
    name="yard",
    title="Yard",
    version="1",
    blender_version="none",
    viewpoints=[SceneViewpoint(name="mast", position_m=(0.0, 0.0, 6.0), pan0_bearing_deg=0.0)],
    presets=[ScenePreset(name="home", viewpoint="mast", pan_deg=0.0, tilt_deg=-5.0, zoom=1.0)],
    home_preset="home",
    instances=INSTANCES,
    texts=[
        SceneText(
            id=id_, text=text, parent=parent, centre_m=(0.0, 1.0, 0.0), right=(1.0, 0.0, 0.0), up=(0.0, 0.0, 1.0),
            width_m=1.0, height_m=0.3, cap_height_m=0.2,
        )
        for id_, text, parent, _ in TEXTS
    ],
    actors=[_actor(len(ROWS) + 1 + i, row) for i, row in enumerate(ACTORS)],
    absent=ABSENT,
)  # fmt: skip


def sighting(instance: SceneInstance | SceneActor, low: Any, high: Any, projection: Projection) -> Sighting:
    """A sighting of a box that nothing hides; its pixels fill half of the box."""
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]) - CAMERA_M
    points = projection.points(corners / np.linalg.norm(corners, axis=1, keepdims=True))
    x0, y0 = np.clip(np.nanmin(points, axis=0), 0, 1)
    x1, y1 = np.clip(np.nanmax(points, axis=0), 0, 1)
    middle = (np.asarray(low) + np.asarray(high)) / 2 - CAMERA_M
    pan, tilt = pan_tilt_deg(middle)
    inside = x1 > x0 and y1 > y0
    pixels = int((x1 - x0) * (y1 - y0) * projection.width * projection.height / 2) if inside else 0
    near = np.clip(CAMERA_M, low, high) - CAMERA_M
    return Sighting(
        instance, (float(x0), float(y0), float(x1), float(y1)), (float((x0 + x1) / 2), float((y0 + y1) / 2)), pixels,
        1.0 if inside else 0.0, float(pan), float(tilt), float(np.linalg.norm(near)), False, False,
    )  # fmt: skip


def truth(projection: Projection = PROJECTION) -> ViewTruth:
    """The ground truth of the whole yard, nearest first."""
    found = [sighting(i, i.box_min_m, i.box_max_m, projection) for i in SCENE.instances]
    for actor, row in zip(SCENE.actors, ACTORS, strict=True):
        (x, y, z), (w, d, h) = row[3], row[4]
        found.append(sighting(actor, (x - w / 2, y - d / 2, z), (x + w / 2, y + d / 2, z + h), projection))
    boxes = {s.instance.id: s.box for s in found}
    legible = {id_: ok for id_, _, _, ok in TEXTS}
    texts = tuple(
        TextSighting(t, boxes[t.parent], 20.0 if legible[t.id] else 6.0, 10.0, 1.0) for t in SCENE.texts
    )  # fmt: skip
    return ViewTruth(tuple(sorted((s for s in found if s.pixels), key=lambda s: s.distance_m)), texts)


class StandInScene:
    """As much of a scene as the ground-truth perception reads."""

    file = SCENE
    name = "yard"


def frame(projection: Projection = PROJECTION, real: bool = False) -> Frame:
    pose = Pose(0.0, -5.0, 1.0)
    origin = None if real else FrameOrigin("yard", "mast", pose, 5.0)
    image = np.zeros((72, 128, 3), dtype=np.uint8)
    return Frame(image, pose, 70.0, 5.0, projection, origin)
