"""Quality settings and size limits for bakes."""

from __future__ import annotations

from dataclasses import dataclass

from scope_ptz.errors import UnknownNameError

PACK_BYTES = 6_600_000
"""Maximum size of one viewpoint's pack in bytes."""

NEAR_M, FAR_M = 0.3, 20000.0
"""Range of the depth encoding in metres."""

WIDER_DENSITY_PX_PER_DEG = 34.0
"""Density of the wider tiles, which is sufficient for views at 1.7x and half of what a view at 3.5x needs."""

DEPTH_STEP = 48
"""Depth codes are rounded to multiples of this, which is 0.8% of the distance and precise enough for occlusion."""


@dataclass(frozen=True, slots=True)
class Quality:
    """Settings for a bake: sizes in pixels, samples per pixel, numbers of tiles, and qualities on the encoder's own scale.

    ``wider_tiles`` is the number of tiles that cover the busiest areas at about a third of the sharp tiles' density, so that the
    surroundings of a sharp tile are not as soft as the panorama. ``check_samples`` and ``check_width`` are for the live renders
    that a finished pack is compared with. ``must_meet_tolerances`` is False for drafts, whose differences are only reported.
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
    base_encoding_quality: int
    tile_encoding_quality: int
    wider_tiles: int = 0
    check_samples: int = 16
    check_width: int = 1280
    must_meet_tolerances: bool = True


def named_quality(name: str) -> Quality:
    """Return quality settings by name.

    Raises:
        UnknownNameError: There is no such quality.
    """
    if name not in QUALITIES:
        raise UnknownNameError("quality", name, QUALITIES)
    return QUALITIES[name]


QUALITIES = {
    q.name: q
    for q in (
        Quality("draft", 2048, 4, 4096, 2048, 4, 48.0, 8, 4, 12, 75, 70, 0, 4, 480, must_meet_tolerances=False),
        Quality("standard", 6144, 8, 8192, 4096, 8, 96.0, 208, 10, 32, 82, 68, 14),
        Quality("high", 6144, 32, 8192, 4096, 24, 96.0, 208, 32, 56, 82, 68, 14),
    )
}
