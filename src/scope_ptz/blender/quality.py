"""How good a bake is made, and what it may weigh."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.errors import UnknownNameError

PACK_BYTES = 6_600_000
"""All layers of one viewpoint together."""

NEAR_M, FAR_M = 0.3, 20000.0
"""Range of the depth coding."""

WIDER_DENSITY_PX_PER_DEG = 34.0
"""Enough for views at 1.7x, half of what a view at 3.5x wants."""

DEPTH_STEP = 48
"""Distances are rounded to this many codes: 0.8%, far less than what separates an actor from what it walks behind."""


@dataclass(frozen=True, slots=True)
class Quality:
    """Sizes in pixels, samples a pixel, most cells of the sphere that get tiles, and the colour coder's own scale.

    Beside the sharp tiles there are ``wider_tiles`` at about a third of their density, where most things are, so that what lies
    beside a sharp tile is not at once as soft as the panorama. ``check_samples`` and ``check_width`` are those of the live renders
    that a finished pack is compared with, and ``judged`` says whether it must hold the tolerances.
    """

    name: str
    base_width: int
    base_samples: int
    ids_width: int
    depth_width: int
    tile_samples: int
    tile_density_px_per_deg: float
    max_cells: int
    sprite_samples: int
    max_sprites: int
    base_coding: int
    tile_coding: int
    wider_tiles: int = 0
    check_samples: int = 16
    check_width: int = 1280
    judged: bool = True


def named_quality(name: str) -> Quality:
    """One of ``QUALITIES``; ``UnknownNameError`` when there is none of that name."""
    if name not in QUALITIES:
        raise UnknownNameError("quality", name, QUALITIES)
    return QUALITIES[name]


QUALITIES = {
    q.name: q
    for q in (
        Quality("draft", 2048, 4, 4096, 2048, 4, 48.0, 8, 4, 12, 75, 70, 0, 4, 480, judged=False),
        Quality("standard", 6144, 8, 8192, 4096, 8, 96.0, 208, 10, 32, 82, 68, 14),
        Quality("high", 6144, 32, 8192, 4096, 24, 96.0, 208, 32, 56, 82, 68, 14),
    )
}
