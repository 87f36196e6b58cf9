"""Scene "highway-works": a lane of a dual carriageway closed for resurfacing, seen from a mast and from an overbridge."""

from __future__ import annotations

import bpy

from scope_ptz.studio.kit import sky
from scope_ptz.studio.kit.stage import Stage
from scope_ptz.studio.scenes import highway_land, highway_road, highway_site, highway_traffic

NAME = "highway-works"
TITLE = "Highway works"


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill in the stage."""
    sky.setup(bpy.context.scene)
    highway_traffic.build(stage)
    highway_site.build(stage)
    highway_road.build(stage)
    highway_land.build(stage)  # last: lettering slows down with every object that the file already holds
    stage.viewpoint("mast", (-18.5, -8.0, 8.5), 0.0, "CCTV mast on the western verge, beside the closed lane")
    stage.viewpoint("bridge", (-7.0, 79.3, 8.5), 180.0, "bracket in front of the overbridge's southern parapet")
    stage.preset("highway", "mast", -10, -14, 1.2, "the works and the northbound lanes, looking along the road")
    stage.preset("compound", "mast", -110, -18, 1.0, "the site compound with its cabins and stores")
    stage.preset("gate", "mast", -52, -17, 1.8, "the compound's gate and the haul road")
    sky.finish_materials()
