"""Highway works: a dual carriageway with a lane closed for resurfacing. The viewpoints are on a mast, a bridge and the verge."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import sky
from scope_studio.scenes.highway_works import land, plants, road, site, traffic

NAME = "highway-works"
TITLE = "Highway works"
ABSENT = (
    "ambulance", "bench", "bicycle", "bulldozer", "cow", "crane", "dog", "fire engine", "horse", "motorcycle", "police car",
    "swimming pool", "tractor", "traffic light", "train", "wind turbine",
)  # fmt: skip
"""Names of objects that are deliberately absent, for questions about objects that do not exist."""


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill ``stage``."""
    stage.start_s = 10.0  # the saloon, the van and the walking worker are all in the home view at that time
    sky.setup(bpy.context.scene)
    traffic.build(stage)
    site.build(stage)
    road.build(stage)
    land.build(stage)
    plants.build(stage)  # last, because lettering gets slower with the number of objects in the file
    _cameras(stage)
    stage.absent = list(ABSENT)
    stage.finish = sky.finish_materials


def _cameras(stage: Stage) -> None:
    stage.viewpoint("mast", (-18.5, -8.0, 8.5), 0.0, "CCTV mast on the western verge, beside the closed lane")
    stage.viewpoint("bridge", (-7.0, 79.3, 8.5), 180.0, "bracket in front of the overbridge's southern parapet")
    stage.viewpoint("verge", (-27.0, 15.0, 7.0), 180.0, "pole on the western verge, between the site compound and the closed lane")
    stage.preset("overview", "mast", 8, -10, 1.0, "the whole site from the mast", home=True)
    stage.preset("highway", "mast", -10, -14, 1.2, "the works access and the closed lane, looking along the road")
    stage.preset("works", "mast", 15, -17, 1.9, "roller, excavator and crew in the closed lane")
    stage.preset("gantry", "mast", 10, -1, 2.8, "the northbound gantry signs")
    stage.preset("bridge-south", "bridge", 4, -13, 1.1, "the works and both carriageways from the overbridge")
    stage.preset("southbound", "bridge", -12, -4, 2.5, "queueing traffic and signs on the carriageway to the south")
    stage.preset("estate", "bridge", -42, -9, 1.3, "the industrial estate and lorry park beside the road")
    stage.preset("compound", "verge", 16, -18, 1.0, "the site compound with its cabins and stores")
    stage.preset("gate", "verge", 27, -22, 2.2, "the compound's gate and the haul road")
    stage.preset("lane", "verge", -92, -16, 1.3, "machines and crew in the closed lane from the side, traffic behind")
