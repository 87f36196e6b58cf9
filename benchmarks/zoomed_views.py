"""Render random zoomed views of every viewpoint into contact sheets, to check for seams between tiles and the panorama.

    python benchmarks/zoomed_views.py --out FOLDER [--count 40] [--seed 1]

Half of the views are aimed at the border of a tile, where a seam would be visible. The others are aimed at random.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose, pan_tilt_deg
from scope_ptz.simulator.library import Library
from scope_ptz.simulator.pack import Scene, list_scenes
from scope_ptz.simulator.views import picture

WIDTH, HEIGHT = 1280, 720
CELL_SIZE_PX = (960, 540)
COLUMNS, ROWS = 2, 2
"""Numbers of columns and rows of a contact sheet."""


def main() -> int:
    """Render the views and write the contact sheets."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder for the sheets")
    parser.add_argument("--count", type=int, default=40, help="number of views (default: 40)")
    parser.add_argument("--seed", type=int, default=1, help="seed for the random poses (default: 1)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    library, rng = Library(open_viewpoints=1), random.Random(arguments.seed)
    places = [(scene, v.name) for scene in list_scenes() for v in library(scene).file.viewpoints]
    cells = []
    for k in range(arguments.count):
        scene, viewpoint = places[k * len(places) // arguments.count]
        pose = _random_pose(library(scene), viewpoint, rng, at_border=k % 2 == 0)
        view = Perspective(pose.pan_deg, pose.tilt_deg, AXIS_M5075_G.hfov_deg(pose.zoom), WIDTH, HEIGHT)
        label = f"{k:02d} {scene}/{viewpoint} pan {pose.pan_deg:.1f} tilt {pose.tilt_deg:.1f} zoom {pose.zoom:.1f}"
        cells.append(_label_cell(picture(library(scene), viewpoint, view, library(scene).file.start_s), label))
    per_sheet = COLUMNS * ROWS
    for first in range(0, len(cells), per_sheet):
        path = arguments.out / f"sheet-{first // per_sheet:02d}.png"
        cv2.imwrite(str(path), cv2.cvtColor(_make_sheet(cells[first : first + per_sheet]), cv2.COLOR_RGB2BGR))
        print(path)
    return 0


def _random_pose(scene: Scene, viewpoint: str, rng: random.Random, *, at_border: bool) -> Pose:
    """Return a random pose. With ``at_border``, it is aimed at the border of a tile if the viewpoint has tiles."""
    zoom = rng.uniform(2.0, 5.0)
    tiles = scene.viewpoint(viewpoint).tiles.views
    if not at_border or not tiles:
        return Pose(rng.uniform(-179.0, 179.0), rng.uniform(-25.0, 5.0), zoom)
    angle = rng.uniform(0, 2 * math.pi)
    x, y = math.cos(angle), math.sin(angle)
    reach = 0.5 / max(abs(x), abs(y))
    pan_deg, tilt_deg = pan_tilt_deg(rng.choice(tiles).directions((0.5 + reach * x, 0.5 + reach * y)))
    return Limits().clamp(Pose(float(pan_deg), float(tilt_deg), zoom))[0]


def _label_cell(image: NDArray[np.uint8], label: str) -> NDArray[np.uint8]:
    small = cv2.resize(image, CELL_SIZE_PX, interpolation=cv2.INTER_AREA)
    cv2.putText(small, label, (8, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.6, (0, 0, 0), 4, cv2.LINE_AA)
    cv2.putText(small, label, (8, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.6, (255, 255, 0), 1, cv2.LINE_AA)
    return np.asarray(small)


def _make_sheet(cells: list[NDArray[np.uint8]]) -> NDArray[np.uint8]:
    blank = np.zeros((CELL_SIZE_PX[1], CELL_SIZE_PX[0], 3), dtype=np.uint8)
    filled = cells + [blank] * (COLUMNS * ROWS - len(cells))
    return np.vstack([np.hstack(filled[row * COLUMNS : (row + 1) * COLUMNS]) for row in range(ROWS)])


if __name__ == "__main__":
    sys.exit(main())
