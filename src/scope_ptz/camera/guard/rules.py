"""The rules that a site sets for one camera."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scope_ptz.geometry import Limits, Pose, wrap_pan_deg

Degrees = Annotated[float, Field(ge=-360.0, le=360.0, allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]


class _Rules(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Region(_Rules):
    """A rectangle in pan and tilt, such as a neighbour's windows. The pan range may cross 180, for example from 170 to -170.

    Attributes:
        name: Name of the region, used in messages.
        pan_deg: The left and right edges; the region extends clockwise from left to right.
        tilt_deg: The bottom and top edges.
    """

    name: str = Field(min_length=1, max_length=60)
    pan_deg: tuple[Degrees, Degrees]
    tilt_deg: tuple[Degrees, Degrees] = (-90.0, 90.0)

    @model_validator(mode="after")
    def _check_order(self) -> Region:
        if self.tilt_deg[0] >= self.tilt_deg[1]:
            raise ValueError("tilt_deg must be [bottom, top], with bottom below top")
        if self.pan_deg[0] == self.pan_deg[1]:
            raise ValueError("pan_deg must be [left, right], with two different angles")
        return self

    @property
    def width_deg(self) -> float:
        """Width in degrees, above 0 and at most 360."""
        return (self.pan_deg[1] - self.pan_deg[0]) % 360.0 or 360.0

    def contains(self, pan_deg: float, tilt_deg: float) -> bool:
        """Return whether a direction is inside the region, excluding its edges."""
        turn = (pan_deg - self.pan_deg[0]) % 360.0
        return self.tilt_deg[0] < tilt_deg < self.tilt_deg[1] and (self.width_deg == 360.0 or 0.0 < turn < self.width_deg)


class PixelMask(_Rules):
    """A rectangle in every frame, as fractions of the frame's width and height from the top left."""

    left: Fraction
    top: Fraction
    right: Fraction
    bottom: Fraction

    @model_validator(mode="after")
    def _check_order(self) -> PixelMask:
        if self.left >= self.right or self.top >= self.bottom:
            raise ValueError("left must be less than right, and top less than bottom")
        return self


class SoftLimits(_Rules):
    """Limits that narrow the device's own limits. None keeps the device's limit."""

    min_pan_deg: Degrees | None = None
    max_pan_deg: Degrees | None = None
    min_tilt_deg: Degrees | None = None
    max_tilt_deg: Degrees | None = None
    max_zoom: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None

    def within(self, device: Limits) -> Limits:
        """Return the device's limits narrowed by these. Pan is not endless if it has a soft limit.

        Raises:
            ValueError: A minimum would be above its maximum.
        """
        low_pan, high_pan = device.min_pan_deg, device.max_pan_deg
        limits = Limits(
            low_pan if self.min_pan_deg is None else max(low_pan, self.min_pan_deg),
            high_pan if self.max_pan_deg is None else min(high_pan, self.max_pan_deg),
            device.min_tilt_deg if self.min_tilt_deg is None else max(device.min_tilt_deg, self.min_tilt_deg),
            device.max_tilt_deg if self.max_tilt_deg is None else min(device.max_tilt_deg, self.max_tilt_deg),
            device.min_zoom,
            device.max_zoom if self.max_zoom is None else min(device.max_zoom, self.max_zoom),
            pan_endless=device.pan_endless and self.min_pan_deg is None and self.max_pan_deg is None,
        )
        for name, low, high in (
            ("pan", limits.min_pan_deg, limits.max_pan_deg),
            ("tilt", limits.min_tilt_deg, limits.max_tilt_deg),
            ("zoom", limits.min_zoom, limits.max_zoom),
        ):
            if low > high:
                raise ValueError(f"the soft limits leave no {name} range: the minimum would be {low:g} and the maximum {high:g}")
        return limits


class CameraRules(_Rules):
    """The rules that a site sets for a camera.

    Attributes:
        soft_limits: Limits that narrow the device's own limits.
        keep_out: Regions that the camera does not aim at and that are black in every frame.
        masks: Rectangles that are black in every frame, for example to hide a text overlay.
        dead_zone_deg: Turns smaller than this are skipped, which reduces wear on the motors. Zooming is never skipped.
        min_interval_s: Minimum time in seconds between two moves. A move requested earlier has to wait.
    """

    soft_limits: SoftLimits = SoftLimits()
    keep_out: tuple[Region, ...] = ()
    masks: tuple[PixelMask, ...] = ()
    dead_zone_deg: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    min_interval_s: Annotated[float, Field(ge=0.0, le=60.0)] = 0.0

    def region_at(self, pose: Pose) -> Region | None:
        """Return the keep-out region at which a pose aims; None if there is none."""
        return next((region for region in self.keep_out if region.contains(pose.pan_deg, pose.tilt_deg)), None)


class Mounting(_Rules):
    """How a device is mounted.

    Attributes:
        position: ``upright``, or ``ceiling`` for a device that hangs upside down and does not rotate its picture itself.
        tilt_deg: Lean of the base in degrees, from -30 to 30; positive if the device points upwards at its own pan 0 and tilt 0.
    """

    position: Literal["upright", "ceiling"] = "upright"
    tilt_deg: Annotated[float, Field(ge=-30.0, le=30.0)] = 0.0


def nearest_outside(pose: Pose, regions: tuple[Region, ...], limits: Limits) -> Pose | None:
    """Return the permitted pose nearest to a pose inside a region.

    The result is on an edge of the region, within the limits, and in no other region; None if there is no such pose. A pose outside
    all regions is returned unchanged.
    """
    region = next((r for r in regions if r.contains(pose.pan_deg, pose.tilt_deg)), None)
    if region is None:
        return pose
    left, right = region.pan_deg
    edges = [Pose(pose.pan_deg, tilt, pose.zoom) for tilt in region.tilt_deg]
    if region.width_deg < 360.0:
        turns = (pose.pan_deg - left) % 360.0, (right - pose.pan_deg) % 360.0
        edges += [Pose(pose.pan_deg - turns[0], pose.tilt_deg, pose.zoom), Pose(pose.pan_deg + turns[1], pose.tilt_deg, pose.zoom)]
    edges = [Pose(wrap_pan_deg(edge.pan_deg), edge.tilt_deg, edge.zoom) for edge in edges]
    permitted = [
        edge for edge in edges if not limits.clamp(edge)[1] and not any(r.contains(edge.pan_deg, edge.tilt_deg) for r in regions)
    ]
    return min(permitted, key=lambda edge: _turn_deg(pose, edge), default=None)


def _turn_deg(start: Pose, end: Pose) -> float:
    return abs(wrap_pan_deg(end.pan_deg - start.pan_deg)) + abs(end.tilt_deg - start.tilt_deg)
