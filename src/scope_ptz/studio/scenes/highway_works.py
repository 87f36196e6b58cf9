"""Scene "highway-works": a lane of a dual carriageway closed for resurfacing, seen from a mast and from an overbridge."""

from __future__ import annotations

import bpy

from scope_ptz.studio.kit import sky
from scope_ptz.studio.kit.stage import Stage
from scope_ptz.studio.scenes import highway_land, highway_site, highway_traffic

NAME = "highway-works"
TITLE = "Highway works"


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill in the stage."""
    sky.setup(bpy.context.scene)
    highway_land.build(stage)
    highway_traffic.build(stage)
    highway_site.build(stage)
    stage.viewpoint("mast", (-18.5, -8.0, 8.5), 0.0, "CCTV mast on the western verge, beside the closed lane")
    stage.viewpoint("bridge", (-7.0, 79.3, 8.5), 180.0, "bracket in front of the overbridge's southern parapet")
    sky.finish_materials()
