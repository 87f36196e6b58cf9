"""Create the paths of moving actors."""

from __future__ import annotations


def closed_loop(corners: list[tuple[float, float]], speed_mps: float) -> list[tuple[float, float, float, float]]:
    """Return the waypoints (t_s, x, y, z) of a closed path on z = 0 through ``corners``, at constant speed."""
    waypoints, t = [(0.0, *corners[0], 0.0)], 0.0
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        t += ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5 / speed_mps
        waypoints.append((t, x1, y1, 0.0))
    return waypoints
