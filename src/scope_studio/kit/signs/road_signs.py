"""Road signs on posts and stands. Fronts face +y. Every readable line has a ``TextMark``."""

from __future__ import annotations

import math
from collections.abc import Sequence

from scope_studio.kit.core.finishes import paint, sheet, steel
from scope_studio.kit.core.lettering import extent
from scope_studio.kit.core.solid import Solid
from scope_studio.kit.core.stage import Built
from scope_studio.kit.signs.faces import INK_BY_BACKGROUND, Panel, arrow, board, disc, flat, panel_face, stroke, write
from scope_studio.kit.signs.stands import add_posts, frame_stand


def panel(
    lines: Sequence[str],
    *,
    width: float,
    height: float,
    background: str = "blue",
    cap_height: float | None = None,
    posts: bool = True,
    post_height: float = 2.0,
    align: str = "LEFT",
    arrows: Sequence[str | None] = (),
    route: str | None = None,
    route_background: str | None = None,
) -> Built:
    """Build a roadside sign whose lower edge is ``post_height`` above the ground. ``Panel`` describes the other parameters."""
    s = Solid(f"{background} sign")
    with s.at(0, 0, post_height + height / 2):
        panel_face(s, Panel(lines, width, height, background, cap_height, align, arrows, route, route_background))
    if posts:
        add_posts(s, width * 0.30 if width > 0.8 else 0.0, post_height + height - 0.04, 0.045 if width < 2.5 else 0.07)
    return s.built()


def speed_limit_sign(text: str = "50", *, diameter: float = 0.75, post_height: float = 2.1) -> Built:
    """Build a speed limit sign: black digits in a red ring."""
    s = Solid(f"{text} speed limit sign")
    r = diameter / 2
    with s.at(0, 0, post_height + r):
        s.prism(_circle(r), (-0.010, -0.006), steel(), "XZ")
        s.prism(_circle(r), (-0.006, -0.003), sheet("red"), "XZ")
        s.prism(_circle(r * 0.80), (-0.003, 0.0), sheet("white"), "XZ")
        cap = min(0.74 * r, 1.15 * r / max(0.1, extent(text, 1.0)))
        write(s, text, cap, 0, 0, "black")
        s.box((diameter * 0.5, 0.03, 0.045), (0, -0.026, 0), steel(), 0.003)
    add_posts(s, 0.0, post_height + diameter - 0.08, 0.038, -0.078)
    return s.built()


def _circle(r: float, sides: int = 48) -> list[tuple[float, float]]:
    return [(r * math.cos(2 * math.pi * k / sides), r * math.sin(2 * math.pi * k / sides)) for k in range(sides)]


def _rounded_triangle(side: float, corner: float) -> list[tuple[float, float]]:
    """Return an equilateral triangle with rounded corners. It points up, and its centroid is at the origin."""
    points = []
    inner = side - 2 * math.sqrt(3) * corner
    for k in range(3):
        a = math.radians(90 + 120 * k)
        cu, cv = inner / math.sqrt(3) * math.cos(a), inner / math.sqrt(3) * math.sin(a)
        points += [
            (cu + corner * math.cos(a + math.radians(t)), cv + corner * math.sin(a + math.radians(t))) for t in range(-60, 61, 20)
        ]
    return points


def _man_digging(s: Solid, k: float) -> None:
    """Add the "road works" pictogram, a man digging. It is about 2 ``k`` wide and high and centred on the origin."""
    ink = sheet("black", dirt=0.05)
    disc(s, -0.10 * k, 0.62 * k, 0.15 * k, ink)
    stroke(s, [(-0.20 * k, 0.36 * k), (-0.40 * k, -0.10 * k)], 0.26 * k, ink)
    stroke(s, [(-0.40 * k, -0.12 * k), (-0.10 * k, -0.40 * k), (-0.16 * k, -0.80 * k)], 0.15 * k, ink)
    stroke(s, [(-0.46 * k, -0.12 * k), (-0.56 * k, -0.46 * k), (-0.78 * k, -0.80 * k)], 0.15 * k, ink)
    stroke(s, [(-0.16 * k, 0.34 * k), (0.10 * k, 0.08 * k), (0.26 * k, -0.10 * k)], 0.11 * k, ink)
    stroke(s, [(-0.02 * k, 0.26 * k), (0.52 * k, -0.52 * k)], 0.055 * k, ink)
    flat(s, [(0.42 * k, -0.46 * k), (0.60 * k, -0.34 * k), (0.68 * k, -0.74 * k), (0.46 * k, -0.66 * k)], ink)
    flat(
        s,
        [
            (0.28 * k, -0.86 * k),
            (1.0 * k, -0.86 * k),
            (0.86 * k, -0.62 * k),
            (0.66 * k, -0.48 * k),
            (0.46 * k, -0.62 * k),
        ],
        ink,
    )


def triangle(
    plate: str | None = None,
    *,
    symbol: str = "works",
    side: float = 0.90,
    stand: str = "frame",
    post_height: float = 1.9,
) -> Built:
    """Build a warning triangle with a "works" or "exclamation" symbol. ``plate`` is the text of a plate below it.

    ``stand`` is "frame" (temporary, on the ground) or "post".
    """
    s = Solid("road works sign" if symbol == "works" else "warning sign")
    plate_h = 0.0 if plate is None else 0.26
    low = 0.30 if stand == "frame" else post_height
    height = side * math.sqrt(3) / 2
    with s.at(0, 0, low + plate_h + height / 3 + 0.02):
        outline = _rounded_triangle(side, 0.05 * side)
        s.prism(outline, (-0.010, -0.006), steel(), "XZ")
        s.prism(outline, (-0.006, -0.003), sheet("red"), "XZ")
        s.prism([(u * 0.70, v * 0.70) for u, v in outline], (-0.003, 0.0), sheet("white"), "XZ")
        with s.at(0, 0, -0.02 * side):
            if symbol == "works":
                _man_digging(s, side * 0.19)
            else:
                ink = sheet("black", dirt=0.05)
                flat(
                    s,
                    [
                        (-0.045 * side, 0.20 * side),
                        (-0.025 * side, -0.06 * side),
                        (0.025 * side, -0.06 * side),
                        (0.045 * side, 0.20 * side),
                    ],
                    ink,
                )
                disc(s, 0, -0.12 * side, 0.042 * side, ink)
    if plate is not None:
        width = max(side * 0.9, extent(plate, 0.10) + 0.16)
        with s.at(0, 0, low + plate_h / 2):
            board(s, width, plate_h - 0.03, "white")
            write(s, plate, 0.10, 0, 0, "black")
    if stand == "frame":
        frame_stand(s, side, low)
    else:
        add_posts(s, 0.0, low + plate_h + height - 0.10, 0.038, -0.078)
    return s.built()


def lane_closed(lanes: int = 3, closed: Sequence[int] = (0,), distance: str | None = "400 m", *, stand: str = "frame") -> Built:
    """Build a lane diagram on a white board, with an arrow for each open lane and a red T for each closed lane.

    ``closed`` lists the indices of the closed lanes, counted from the left as seen by a driver.
    """
    s = Solid("lane closed sign")
    width, height = 0.32 * lanes + 0.30, 1.05
    low, plate_h = (0.35 if stand == "frame" else 1.8), (0.30 if distance else 0.0)
    with s.at(0, 0, low + plate_h + height / 2):
        board(s, width, height, "white")
        for lane in range(lanes):
            u = (lane - (lanes - 1) / 2) * 0.34
            if lane in closed:
                stroke(s, [(u, -0.36), (u, 0.02)], 0.075, sheet("black", dirt=0.05))
                flat(s, [(u - 0.13, 0.02), (u + 0.13, 0.02), (u + 0.13, 0.13), (u - 0.13, 0.13)], sheet("red"), 0.0055)
            else:
                stroke(s, [(u, -0.36), (u, 0.10)], 0.075, sheet("black", dirt=0.05))
                arrow(s, u, 0.18, 0.42, "up", sheet("black", dirt=0.05))
    if distance:
        with s.at(0, 0, low + plate_h / 2):
            board(s, width, plate_h - 0.03, "white")
            write(s, distance, 0.13, 0, 0, "black")
    if stand == "frame":
        frame_stand(s, width, low)
    else:
        add_posts(s, width * 0.3, low + plate_h + height - 0.04, 0.045)
    return s.built()


def works_access(lines: Sequence[str] = ("WORKS", "ACCESS"), *, direction: str | None = "left", stand: str = "frame") -> Built:
    """Build the sign at the exit for site traffic, with white lettering on red."""
    s = Solid("works access sign")
    low, height = (0.35 if stand == "frame" else 1.7), 0.22 + 0.24 * len(lines)
    width = max(extent(line, 0.15) for line in lines) + (0.62 if direction else 0.25)
    with s.at(0, 0, low + height / 2):
        panel_face(
            s,
            Panel(lines, width, height, "red", 0.15, "LEFT" if direction else "CENTER", (direction,) if direction else ()),
        )
    if stand == "frame":
        frame_stand(s, width, low)
    else:
        add_posts(s, width * 0.3, low + height - 0.04, 0.045)
    return s.built()


def project_board(
    lines: Sequence[str], *, width: float = 3.0, height: float = 2.2, background: str = "blue", post_height: float = 0.8
) -> Built:
    """Build a large information board.

    The first line is the title on a coloured band, the second is in large letters, the last two are in small print, and the
    others are body text.
    """
    s = Solid("project board")
    with s.at(0, 0, post_height + height / 2):
        board(s, width, height, "white", border=background, edge=0.03)
        band = height * 0.24
        flat(
            s,
            [
                (-width / 2 + 0.035, height / 2 - band),
                (width / 2 - 0.035, height / 2 - band),
                (width / 2 - 0.035, height / 2 - 0.035),
                (-width / 2 + 0.035, height / 2 - 0.035),
            ],
            sheet(background),
            0.003,
        )
        room, left = width - 0.36, -width / 2 + 0.18
        caps = [0.44 * band, 0.062 * height] + [0.044 * height] * max(0, len(lines) - 4) + [0.019 * height] * 2
        v = height / 2 - band / 2 - 0.01
        for i, (line, cap) in enumerate(zip(lines, caps, strict=False)):
            fitted = min(cap, cap * room / max(extent(line, cap), 1e-6))
            small = i >= len(lines) - 2 and len(lines) > 4
            if i == 1:
                v = height / 2 - band - 1.9 * cap
            elif i > 1:
                v -= (caps[i - 1] + cap) / 2 + 0.95 * max(cap, caps[i - 1] * 0.8)
            write(
                s,
                line,
                fitted,
                left,
                v,
                INK_BY_BACKGROUND.get(background, "black") if i == 0 else "black",
                align="LEFT",
                bold=not small,
                lift=0.0065 if i == 0 else 0.0035,
            )
        foot = -height / 2 + 0.05
        for k, colour in enumerate(("green", "yellow", "light blue")):
            u = width / 2 - 0.20 - 0.17 * k
            disc(s, u, foot + 0.16, 0.075, sheet(colour))
        flat(
            s,
            [
                (-width / 2 + 0.035, foot - 0.005),
                (width / 2 - 0.035, foot - 0.005),
                (width / 2 - 0.035, foot + 0.03),
                (-width / 2 + 0.035, foot + 0.03),
            ],
            sheet("green"),
            0.003,
        )
    for x in (-width * 0.36, width * 0.36):
        s.box(
            (0.10, 0.10, post_height + height),
            (x, -0.10, (post_height + height) / 2),
            paint("brown", dirt=0.4, roughness=0.8),
            0.006,
        )
        s.rod((x, -0.15, post_height + height * 0.5), (x, -1.0, 0.0), 0.03, steel())
    return s.built()


def marker_post(number: str, *, kind: str = "kilometre") -> Built:
    """Build a white edge post, 1.05 m high, with a reflector and a small number plate facing +y."""
    s = Solid("marker post")
    s.prism([(-0.06, -0.05), (0.06, -0.05), (0.05, 0.05), (-0.05, 0.05)], (0.0, 1.05), paint("white", dirt=0.5), "XY")
    s.prism(
        [(-0.063, -0.053), (0.063, -0.053), (0.053, 0.053), (-0.053, 0.053)],
        (0.80, 0.98),
        paint("black", dirt=0.2),
        "XY",
    )
    s.box((0.05, 0.006, 0.10), (0, 0.055, 0.89), sheet("amber"), 0.002)
    with s.at(0, 0.062, 0.60):
        board(s, max(0.22, extent(number, 0.07) + 0.07), 0.16, "blue" if kind == "kilometre" else "white", back=False)
        write(s, number, 0.07, 0, 0, "white" if kind == "kilometre" else "black")
    return s.built()


def warning_plate(
    text: str, *, background: str = "yellow", cap_height: float = 0.06, posts: bool = True, post_height: float = 1.1
) -> Built:
    """Build a small plate with one or more lines of text, separated by newlines. Its lower edge is at ``post_height``.

    It stands on a short post. If ``posts`` is false, it has no post and can be fixed to another object.
    """
    s = Solid("warning plate")
    lines = text.split("\n")
    width = max(extent(t, cap_height) for t in lines) + 1.8 * cap_height
    height = cap_height * (1.2 + 1.6 * len(lines))
    with s.at(0, 0, post_height + height / 2):
        board(s, width, height, background, back=False)
        for i, line in enumerate(lines):
            write(s, line, cap_height, 0, (len(lines) / 2 - i - 0.5) * 1.6 * cap_height, INK_BY_BACKGROUND.get(background, "black"))
    if posts:
        add_posts(s, 0.0, post_height + height * 0.9, 0.025, -0.037)
    return s.built()
