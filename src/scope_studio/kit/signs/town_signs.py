"""Signs of a town square: finger posts, a town map, a no-entry sign, and small signs on posts."""

from __future__ import annotations

import random
from collections.abc import Sequence

from scope_studio.kit.core.finishes import paint, sheet, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.shading import plain
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import arrow, board, disc, flat, write


def finger_post(fingers: Sequence[tuple[str, float]], *, colour: str = "dark green", height: float = 3.1) -> Built:
    """Build a signpost with lettered fingers.

    ``fingers`` contains the text of each finger, from top to bottom, and the bearing in degrees in which it points.
    """
    s = Solid("finger post")
    iron = paint(colour, dirt=0.2, roughness=0.35)
    s.lathe(
        [
            (0.13, 0.0),
            (0.13, 0.10),
            (0.07, 0.16),
            (0.05, 0.9),
            (0.05, height),
            (0.08, height + 0.03),
            (0.05, height + 0.10),
            (0.01, height + 0.22),
        ],
        iron,
        steps=20,
    )
    for k, (text, bearing) in enumerate(fingers):
        cap = 0.085
        width = extent(text, cap) + 0.30
        with s.at(0, 0, height - 0.14 - 0.235 * k, turn=90.0 - bearing):
            shape = [(0.05, -0.095), (width - 0.10, -0.095), (width, 0.0), (width - 0.10, 0.095), (0.05, 0.095)]
            s.prism(shape, (-0.014, 0.014), iron, "XZ")
            for side, facing in ((1, "+Y"), (-1, "-Y")):
                s.text(text, cap, (0.05 + (width - 0.08) / 2, side * 0.0165, 0.0), sheet("white", dirt=0.05), facing=facing)
    return s.built()


def map_board(title: str = "TOWN MAP") -> Built:
    """Build a town map on two posts, 1.3 x 1.5 m, facing +y, with streets, blocks, a park, a river and a "you are here" mark."""
    s = Solid("map board")
    rng = random.Random(title)
    for x in (-0.66, 0.66):
        s.box((0.08, 0.08, 2.15), (x, -0.03, 1.07), paint("dark green", dirt=0.2), 0.012)
    with s.at(0, 0.02, 1.38):
        s.box((1.30, 0.05, 1.44), (0, 0, 0), paint("dark green", dirt=0.2), 0.012)
        s.box((1.20, 0.012, 1.34), (0, 0.022, 0), sheet("cream", dirt=0.05), 0.0)
        s.text(title, 0.10, (0, 0.031, 0.57), paint("dark green", dirt=0.0))
        tints = [
            plain(f"map {k}", c, 0.6)
            for k, c in enumerate(((0.50, 0.40, 0.29), (0.44, 0.36, 0.27), (0.18, 0.36, 0.10), (0.16, 0.34, 0.52)))
        ]
        with s.at(0, 0.027, -0.08):
            for i in range(6):
                for j in range(6):
                    if rng.random() < 0.88:
                        flat(
                            s,
                            [
                                (u * 0.18 + (i - 2.5) * 0.19, v * 0.17 + (j - 2.5) * 0.185)
                                for u, v in (
                                    (-0.42, -0.42),
                                    (0.42, -0.42 + rng.uniform(0, 0.2)),
                                    (0.42, 0.42),
                                    (-0.42 + rng.uniform(0, 0.3), 0.42),
                                )
                            ],
                            tints[2 if (i, j) in ((1, 4), (2, 4), (4, 1)) else rng.randrange(2)],
                            0.003,
                        )
            flat(
                s,
                [(-0.58, 0.30), (-0.2, 0.16), (0.2, 0.22), (0.58, 0.05), (0.58, -0.03), (0.2, 0.14), (-0.2, 0.08), (-0.58, 0.22)],
                tints[3],
                0.004,
            )
            disc(s, 0.08, -0.12, 0.035, paint("red", dirt=0.0), 0.006)
    return s.built()


def no_entry() -> Built:
    """Build a no-entry sign on a post, 2.9 m high, facing +y: a red disc with a white bar."""
    s = Solid("no entry sign")
    s.rod((0, -0.05, 0), (0, -0.05, 2.9), 0.035, steel())
    with s.at(0, 0, 2.55):
        s.lathe([(0.32, -0.012), (0.32, 0.0)], sheet("red"), (0, 0, 0), "Y", 40)
        s.lathe([(0.33, -0.016), (0.33, -0.004)], steel(), (0, 0, 0), "Y", 40)
        flat(s, [(-0.23, -0.055), (0.23, -0.055), (0.23, 0.055), (-0.23, 0.055)], sheet("white"))
    return s.built()


def post_sign(
    lines: Sequence[str], *, background: str = "blue", cap: float = 0.10, height: float = 2.2, pointer: str | None = None
) -> Built:
    """Build a small sign on a post, facing +y. Its width depends on its lines. The first line is larger."""
    s = Solid(f"{background} sign")
    caps = [cap * (1.5 if k == 0 else 0.8) for k in range(len(lines))]
    width = max(extent(line, c) for line, c in zip(lines, caps, strict=True)) + 0.22
    board_height = sum(c * 1.7 for c in caps) + 0.14 + (0.30 if pointer else 0.0)
    s.rod((0, -0.05, 0), (0, -0.05, height + board_height), 0.032, steel())
    with s.at(0, 0, height + board_height / 2):
        board(s, width, board_height, background, edge=0.018, back=False)
        v = board_height / 2 - 0.07
        for line, c in zip(lines, caps, strict=True):
            v -= c * 0.85
            write(s, line, c, 0, v, "white" if background not in ("white", "yellow") else "black")
            v -= c * 0.85
        if pointer:
            arrow(
                s,
                0.0,
                -board_height / 2 + 0.20,
                0.22,
                pointer,
                sheet("white" if background not in ("white", "yellow") else "black"),
            )
    return s.built()
