"""Freight yard: a distribution yard at dusk with its lamps on. The viewpoints are on a mast at the gate and above the docks."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import dusk
from scope_studio.scenes.freight_yard import fixtures, ground, land, notices, parked_vehicles, people, premises, stock, traffic

NAME = "freight-yard"
TITLE = "Freight yard"
ABSENT = (
    "aircraft", "ambulance", "boat", "bulldozer", "bus", "child", "cow", "crane", "dog", "excavator", "fire engine", "fountain",
    "horse", "police car", "post box", "sheep", "statue", "swimming pool", "taxi", "tent", "train", "tram", "umbrella",
)  # fmt: skip
"""Names of objects that are deliberately absent, for questions about objects that do not exist."""


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill ``stage``."""
    stage.start_s = 12.5  # the van, the guard, the forklift and the fox are all in the home view at that time
    dusk.setup(bpy.context.scene)
    people.build(stage)  # people first, then lettering, because both get slower with the number of objects in the file
    fixtures.build(stage)
    notices.build(stage)
    stock.build(stage)
    parked_vehicles.build(stage)
    ground.build(stage)
    premises.build(stage)
    land.build(stage)
    traffic.build(stage)
    _cameras(stage)
    stage.absent = list(ABSENT)
    stage.finish = dusk.finish_materials


def _cameras(stage: Stage) -> None:
    stage.viewpoint("gate-mast", (-9.0, -37.0, 7.0), 0.0, "CCTV mast inside the gate, beside the entry lane")
    stage.viewpoint("dock-roof", (5.7, 27.2, 9.0), 180.0, "bracket above the dock canopy on the warehouse front")
    stage.preset("yard", "gate-mast", 8, -7, 1.0, "the docks and the yard from the gate", home=True)
    stage.preset("car-park", "gate-mast", -42, -14, 1.1, "the staff car park and the charging points")
    stage.preset("gatehouse", "gate-mast", 99, -17, 1.35, "the gatehouse, the barriers and the road outside")
    stage.preset("docks", "gate-mast", 0, -2, 2.6, "the loading docks and the company name")
    stage.preset("apron", "dock-roof", 0, -22, 1.0, "the concrete apron and the lorries from above the docks")
    stage.preset("containers", "dock-roof", -42, -13, 1.2, "the container stacks")
    stage.preset("cars", "dock-roof", 42, -10, 1.5, "the car park from the warehouse")
    stage.preset("trailer-bays", "dock-roof", 78, -12, 1.2, "the trailer bays and the office along the warehouse front")
