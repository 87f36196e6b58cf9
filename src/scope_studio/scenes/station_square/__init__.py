"""Station square: the forecourt of a town's railway station on a market morning."""

from __future__ import annotations

import bpy

from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import sky
from scope_studio.scenes.station_square import fixtures, ground, market, people, set_dressing, surroundings, town, traffic

NAME = "station-square"
TITLE = "Station square"
ABSENT = (
    "ambulance",
    "ball",
    "boat",
    "bus",
    "cat",
    "child",
    "crane",
    "excavator",
    "fire engine",
    "horse",
    "ladder",
    "lorry",
    "motorcycle",
    "phone box",
    "police car",
    "scaffolding",
    "skateboard",
    "skip",
    "traffic cone",
    "traffic light",
    "train",
    "tent",
)
"""Names of objects that are deliberately absent, for questions about objects that do not exist."""


def build(stage: Stage) -> None:
    """Build the whole scene in an empty Blender file and fill ``stage``."""
    stage.start_s = 27.0  # the cyclist, the traveller and the dog are all in the home view at that time
    sky.setup(
        bpy.context.scene, sun_bearing_deg=128.0, sun_elevation_deg=31.0, sun_strength=5.6, sky_strength=0.72, cloud_cover=0.25
    )
    town.build(stage)
    surroundings.church(stage)
    traffic.build(stage)
    fixtures.build(stage)
    set_dressing.build(stage)
    market.build(stage)
    people.build(stage)
    ground.build(stage)
    surroundings.build(stage)  # last, because building gets slower with the number of objects in the file
    _cameras(stage)
    stage.absent = list(ABSENT)
    stage.finish = sky.finish_materials


def _cameras(stage: Stage) -> None:
    stage.viewpoint("kiosk", (4.0, -8.0, 6.4), 0.0, "camera on a lamp mast beside the news kiosk")
    stage.viewpoint("hotel", (6.0, -27.4, 8.0), 0.0, "bracket on the front of the Station Hotel")
    stage.preset("square", "kiosk", -24, -8, 1.0, "the market, the fountain and the station", home=True)
    stage.preset("market", "kiosk", -52, -13, 2.0, "the market stalls and their customers")
    stage.preset("terrace", "kiosk", -82, -9, 2.6, "the café terrace")
    stage.preset("taxi-rank", "kiosk", 66, -13, 1.2, "the taxi rank and the shops on the eastern side")
    stage.preset("forecourt", "hotel", -3, -13, 1.0, "the whole square with the station behind it")
    stage.preset("tram-stop", "hotel", -60, -15, 1.7, "the tram at its stop")
    stage.preset("news-stand", "hotel", 13, -14, 2.4, "the news kiosk with its headline boards")
    stage.preset("approach", "hotel", 38, -9, 1.5, "the station approach with taxis and delivery van")
