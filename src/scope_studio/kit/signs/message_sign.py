"""Variable message signs, whose letters consist of lit dots on a black matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mathutils import Vector

from scope_studio.kit.core.finishes import glow, lens, paint
from scope_studio.kit.core.lettering import extent, letters
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built, TextMark
from scope_studio.kit.signs.stands import add_posts


def _dots(body: str, cap: float, rows: int) -> list[tuple[float, float]]:
    """Return the centres of the lit dots of a line of matrix letters, centred horizontally, with the baseline at 0."""
    points, faces = letters(body, cap, bold=True, spacing=1.18)
    p = np.array(points)[:, :2]
    pitch = cap / rows
    low, high = p.min(axis=0), p.max(axis=0)
    grid = np.array([(x, y) for y in np.arange(pitch / 2, cap, pitch) for x in np.arange(low[0] + pitch / 2, high[0], pitch)])
    inside = np.zeros(len(grid), bool)
    for face in faces:
        ring = p[list(face)]
        within = np.zeros(len(grid), bool)
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            crossing = (a[1] > grid[:, 1]) != (b[1] > grid[:, 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                at = (b[0] - a[0]) * (grid[:, 1] - a[1]) / (b[1] - a[1]) + a[0]
            within ^= crossing & (grid[:, 0] < at)
        inside |= within
    middle = (low[0] + high[0]) / 2
    return [(float(x - middle), float(y)) for x, y in grid[inside]]


def variable_message(
    lines: Sequence[str], *, width: float = 3.4, height: float = 1.7, post_height: float = 2.6, colour: str = "amber"
) -> Built:
    """Build a black matrix sign on posts, with letters made of lit dots and with lanterns at its corners."""
    s = Solid("variable message sign")
    cap = min(
        0.34,
        (height - 0.3) / (1.55 * len(lines)),
        min((width - 0.4) / max(extent(t, 1.0, spacing=1.18), 0.1) for t in lines),
    )
    with s.at(0, 0, post_height + height / 2):
        s.box((width, 0.30, height), (0, -0.16, 0), paint("dark grey", dirt=0.3), 0.02)
        s.box((width - 0.08, 0.02, height - 0.08), (0, -0.008, 0), lens("black"), 0.004)
        s.box((width + 0.06, 0.16, 0.03), (0, 0.04, height / 2 + 0.01), paint("dark grey"), 0.005)
        lit, pitch = glow(colour, 4.0), cap / 14
        for i, line in enumerate(lines):
            v = (len(lines) / 2 - i - 0.5) * cap * 1.55 - cap / 2
            dots = _dots(line, cap, 14)
            for u, w in dots:
                r = pitch * 0.40
                s.add(
                    [
                        (-u - r, 0.006, v + w - r),
                        (-u + r, 0.006, v + w - r),
                        (-u + r, 0.006, v + w + r),
                        (-u - r, 0.006, v + w + r),
                    ],
                    [(3, 2, 1, 0)],
                    lit,
                )
            spread = max(u for u, _ in dots) - min(u for u, _ in dots) + pitch
            centre = s.frame @ Vector((0, 0.006, v + cap / 2))
            s.texts.append(TextMark(line, tuple(centre), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), spread, cap, cap))
        for x in (-width / 2 + 0.14, width / 2 - 0.14):
            for z in (-height / 2 + 0.14, height / 2 - 0.14):
                s.lathe([(0.07, 0.0), (0.06, 0.012), (0.02, 0.018)], lens("amber"), (x, 0.002, z), "Y", 16)
    add_posts(s, width * 0.3, post_height + height * 0.6, 0.09, -0.18)
    return s.built()
