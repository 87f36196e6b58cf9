"""The band of the sphere that a camera can see, and the strips in which the panorama is rendered."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scope_ptz.geometry import Equirectangular, Limits, Optics, Perspective, pan_tilt_deg
from scope_ptz.simulator.models import Band

ASPECTS = (16 / 9, 4 / 3)
"""Aspect ratios of frames that a pack must cover."""

MARGIN_DEG = 0.8  # added to the band at the top and the bottom
POLE_DEG = 7.0
"""A band that ends within this angle, in degrees, of a pole is extended to the pole."""


def reachable_band(limits: Limits, optics: Optics) -> Band:
    """Return the range of tilts that a camera's frames can show."""
    tops, bottoms = [], []
    hfov_deg = optics.hfov_deg(limits.min_zoom)
    side = np.linspace(0.0, 1.0, 33)
    for aspect in ASPECTS:
        size = (1200, round(1200 / aspect))
        up = Perspective(0.0, limits.max_tilt_deg, hfov_deg, *size)
        down = Perspective(0.0, limits.min_tilt_deg, hfov_deg, *size)
        _, upper = pan_tilt_deg(up.directions(np.stack([side, np.zeros(33)], axis=-1)))
        _, lower = pan_tilt_deg(down.directions(np.stack([side, np.ones(33)], axis=-1)))
        tops.append(90.0 if limits.max_tilt_deg + up.vfov_deg / 2 >= 90.0 else float(upper.max()))
        bottoms.append(-90.0 if limits.min_tilt_deg - down.vfov_deg / 2 <= -90.0 else float(lower.min()))
    top, bottom = max(tops) + MARGIN_DEG, min(bottoms) - MARGIN_DEG
    return Band(top_tilt_deg=90.0 if top > 90 - POLE_DEG else top, bottom_tilt_deg=-90.0 if bottom < POLE_DEG - 90 else bottom)


@dataclass(frozen=True, slots=True)
class Strip:
    """Rows ``first_row`` to ``last_row`` (exclusive) of a panorama, rendered ``width`` pixels wide."""

    first_row: int
    last_row: int
    top_tilt_deg: float
    bottom_tilt_deg: float
    width: int


@dataclass(frozen=True, slots=True)
class Panorama:
    """A panorama's size and band. The band extends to whole degrees, and each pixel spans equal angles in pan and tilt."""

    width: int
    height: int
    band: Band

    @classmethod
    def of(cls, width: int, band: Band) -> Panorama:
        """Return a panorama with a given width that covers a band. The band is extended to whole degrees."""
        top = min(90.0, float(math.ceil(band.top_tilt_deg)))
        bottom = max(-90.0, float(math.floor(band.bottom_tilt_deg)))
        height = round((top - bottom) / 360.0 * width)
        return cls(width, height, Band(top_tilt_deg=top, bottom_tilt_deg=bottom))

    @property
    def projection(self) -> Equirectangular:
        """The panorama's projection."""
        return Equirectangular(-180.0, 360.0, self.band.top_tilt_deg, self.band.bottom_tilt_deg, self.width, self.height)

    def tilt_of_row(self, row: float) -> float:
        """Return the tilt of a row's upper edge."""
        return self.band.top_tilt_deg - row / self.height * (self.band.top_tilt_deg - self.band.bottom_tilt_deg)

    def strips(self, rows: int, overlap_rows: int) -> list[Strip]:
        """Return strips of about ``rows`` rows that overlap for blending. Strips near a pole need fewer columns."""
        count = max(1, round(self.height / rows))
        edges = [round(k * self.height / count) for k in range(count + 1)]
        strips = []
        for first, last in pairwise(edges):
            a, b = max(0, first - overlap_rows), min(self.height, last + overlap_rows)
            top, bottom = self.tilt_of_row(a), self.tilt_of_row(b)
            nearest = 0.0 if top > 0 > bottom else min(abs(top), abs(bottom))
            width = self.width if nearest < 55 else 2 * math.ceil(self.width * math.cos(math.radians(nearest)) / 2)
            strips.append(Strip(a, b, top, bottom, width))
        return strips
