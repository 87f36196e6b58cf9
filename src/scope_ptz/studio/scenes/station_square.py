"""Scene "station-square": the forecourt of a town's railway station on a market morning."""

from __future__ import annotations

import bpy

from scope_ptz.studio.kit import sky
from scope_ptz.studio.kit.stage import Stage
from scope_ptz.studio.scenes import (
    station_square_furniture,
    station_square_ground,
    station_square_market,
    station_square_people,
    station_square_town,
    station_square_traffic,
)

NAME = "station-square"
TITLE = "Station square"


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill in the stage."""
    sky.setup(bpy.context.scene, sun_bearing_deg=128.0, sun_elevation_deg=31.0, sun_strength=5.0, sky_strength=0.8, cloud_cover=0.22)
    station_square_town.build(stage)
    station_square_traffic.build(stage)
    station_square_furniture.build(stage)
    station_square_market.build(stage)
    station_square_people.build(stage)
    station_square_ground.build(stage)
    _cameras(stage)
    sky.finish_materials()


def _cameras(stage: Stage) -> None:
    stage.viewpoint("kiosk", (4.0, -8.0, 6.4), 0.0, "camera on a lamp mast beside the news kiosk")
    stage.viewpoint("hotel", (6.0, -27.4, 8.0), 0.0, "bracket on the front of the Station Hotel")
    stage.preset("square", "kiosk", -33, -12, 1.0, "the market, the statue and the station", home=True)
