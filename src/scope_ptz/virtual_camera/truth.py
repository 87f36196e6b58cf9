"""The ground truth for frames sent over the network, for the perception backend ``simulation-only-truth``."""

from __future__ import annotations

from collections import deque
from time import monotonic, time

from scope_ptz.camera.base import FrameOrigin
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice

MAX_STORED_EXPOSURES = 3000
"""Maximum number of stored exposures: two minutes at 25 frames per second."""

TOLERANCE_S = 0.001
"""Default tolerance in seconds for finding an exposure by its time. Times are sent with microsecond resolution."""


class TruthLog:
    """Stores the origins (scene, viewpoint, pose and scene time) of recent exposures, for look-up by time.

    Args:
        device: The camera, whose exposures for all protocols are stored.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self._device = device
        self._exposures: deque[tuple[float, float, FrameOrigin]] = deque(maxlen=MAX_STORED_EXPOSURES)
        device.observers.append(self._record)

    def close(self) -> None:
        """Stop storing exposures."""
        self._device.observers.remove(self._record)

    def at(
        self, *, taken_s: float | None = None, time_s: float | None = None, within_s: float = TOLERANCE_S
    ) -> tuple[float, FrameOrigin] | None:
        """Return the time in Unix seconds and the origin of an exposure; None if no stored exposure matches.

        Args:
            taken_s: The time of the exposure in Unix seconds. The nearest exposure is returned.
            time_s: The scene time of the exposure. Because scene time can be paused, several exposures may match; without
                ``taken_s``, the newest is returned.
            within_s: Maximum difference from ``taken_s`` in seconds.
        """
        matching = [
            (taken, origin)
            for taken, scene_time, origin in reversed(list(self._exposures))
            if (taken_s is None or abs(taken - taken_s) <= within_s) and (time_s is None or abs(scene_time - time_s) <= TOLERANCE_S)
        ]
        if taken_s is None:
            return matching[0] if matching else None
        return min(matching, key=lambda match: abs(match[0] - taken_s), default=None)

    def origin(self, exposure: Exposure) -> FrameOrigin:
        """Return the origin of an exposure."""
        return FrameOrigin(self._device.scene.name, self._device.viewpoint, exposure.pose, exposure.time_s)

    def _record(self, exposure: Exposure) -> None:
        self._exposures.append((unix_s(exposure), exposure.time_s, self.origin(exposure)))


def unix_s(exposure: Exposure) -> float:
    """Return the time of an exposure in Unix seconds, rounded to microseconds."""
    return round(time() - monotonic() + exposure.taken_s, 6)


def origin_fields(origin: FrameOrigin) -> dict[str, object]:
    """Convert an origin to JSON data."""
    pose = {"pan_deg": origin.pose.pan_deg, "tilt_deg": origin.pose.tilt_deg, "zoom": origin.pose.zoom}
    return {"scene": origin.scene, "viewpoint": origin.viewpoint, "pose": pose, "time_s": origin.time_s}
