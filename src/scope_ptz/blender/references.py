"""Store live renders, so that later packs can be compared with them without Blender."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import Pose
from scope_ptz.simulator.layers import read_colour, read_ids, write_colour, write_ids

INDEX_FILE = "references.json"
QUALITY = 97
"""Encoding quality of the pictures. It is high, because compression losses would count as differences from the pack."""

Reference = tuple[str, Pose, NDArray[np.uint8], NDArray[np.uint16]]
"""Viewpoint, pose, picture ``(H, W, 3)`` and instance IDs ``(H, W)``."""


def add_reference(folder: Path, viewpoint: str, pose: Pose, colour: NDArray[np.uint8], ids: NDArray[np.uint16]) -> None:
    """Add a live render to a reference folder."""
    folder.mkdir(parents=True, exist_ok=True)
    index = folder / INDEX_FILE
    entries = json.loads(index.read_text()) if index.exists() else []
    name = f"{len(entries):02d}-{viewpoint}"
    write_colour(folder / f"{name}.webp", colour, QUALITY)
    write_ids(folder / f"{name}-ids.webp", ids)
    entries.append({"name": name, "viewpoint": viewpoint, "pose": [pose.pan_deg, pose.tilt_deg, pose.zoom]})
    index.write_text(json.dumps(entries, indent=1) + "\n")


def references(folder: Path) -> Iterator[Reference]:
    """Yield the live renders in a folder, in the order in which they were added."""
    for entry in json.loads((folder / INDEX_FILE).read_text()):
        name = entry["name"]
        yield entry["viewpoint"], Pose(*entry["pose"]), read_colour(folder / f"{name}.webp"), read_ids(folder / f"{name}-ids.webp")
