"""High street: shops, traffic and people on a wet afternoon in a small town."""

from __future__ import annotations

from functools import partial

import bpy

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import overcast, sky
from scope_studio.scenes.high_street import goods, land, people, shops, street_furniture, traffic

NAME = "high-street"
TITLE = "High street"
ABSENT = (
    "ambulance", "aeroplane", "boat", "cat", "crane", "cow", "excavator", "fire engine", "fountain", "helicopter",
    "horse", "lorry", "motorcycle", "parking barrier", "petrol pump", "police car", "skip", "statue", "suitcase", "swimming pool",
    "tractor", "train", "tram", "wheelchair", "wind turbine",
)  # fmt: skip
"""Names of objects that are deliberately absent, for questions about objects that do not exist."""


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill ``stage``."""
    stage.start_s = 17.0  # the car, the cyclist, the walkers and the dog are all in the street at that time
    overcast.setup(bpy.context.scene)
    people.build(stage)  # first, because building people gets slower with the number of objects in the file
    traffic.build(stage)
    shop_ids = shops.build(stage)
    goods.build(stage, shop_ids)
    street_furniture.build(stage)
    land.build(stage)
    _cameras(stage)
    stage.absent = list(ABSENT)
    stage.finish = partial(sky.finish_materials, visibility_m=700.0)


def _cameras(stage: Stage) -> None:
    stage.viewpoint("corner", (-4.9, -45.2, 6.0), 0.0, "bracket on the corner of the bank, looking up the street")
    stage.viewpoint("crossing", (3.3, 21.4, 5.2), 180.0, "outreach arm of a lamp column above the zebra crossing")
    stage.viewpoint("rooftop", (2.6, 60.3, 9.0), 180.0, "bracket on the front of the town hall")
    stage.preset("high-street", "corner", 9, -7, 1.0, "the whole street from the corner of the bank", home=True)
    stage.preset("bus-stop", "corner", 2, -7, 2.1, "the bus at its stop and the western footway")
    stage.preset("mill-lane", "corner", 150, -10, 1.0, "the traffic lights at Mill Lane")
    stage.preset("corner-shops", "corner", 72, -14, 1.0, "the florist's and the stores across the street")
    stage.preset("zebra", "crossing", 0, -18, 1.0, "the zebra crossing and the street to the south")
    stage.preset("west-side", "crossing", 62, -6, 1.0, "the chemist's, the charity shop and the red door")
    stage.preset("east-side", "crossing", -24, -6, 1.5, "the lighting shop and its neighbours")
    stage.preset("town-hall", "crossing", 176, -3, 1.2, "the town hall, and the works at the manhole")
    stage.preset("rooftop", "rooftop", 0, -13, 1.0, "the whole street from the town hall")
    stage.preset("church-road", "rooftop", 92, -7, 1.0, "Church Road to the west")
    stage.preset("clock-corner", "rooftop", -28, -14, 1.9, "the post office and the jeweller's clock")
