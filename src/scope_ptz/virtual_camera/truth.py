"""The ground truth of frames that went over the network, for perception that is labelled simulation-only."""

from __future__ import annotations

from collections import deque
from time import monotonic, time

from scope_ptz.camera.base import FrameOrigin
from scope_ptz.virtual_camera.device import Exposure, VirtualDevice

KEPT_EXPOSURES = 3000
"""Number of exposures that are remembered: two minutes at 25 frames per second."""

TOLERANCE_S = 0.001
"""How far a requested time may be from that of an exposure. Times on the wire have microseconds."""


class TruthLog:
    """Remembers where and when recent exposures were taken.

    Args:
        device: The camera. Every exposure for any protocol is noted.
    """

    def __init__(self, device: VirtualDevice) -> None:
        self._device = device
        self._exposures: deque[tuple[float, float, FrameOrigin]] = deque(maxlen=KEPT_EXPOSURES)
        device.observers.append(self._note)

    def close(self) -> None:
        """Stop noting exposures."""
        self._device.observers.remove(self._note)

    def at(self, *, taken_s: float | None = None, time_s: float | None = None) -> FrameOrigin | None:
        """Return the origin of an exposure, None if none is known.

        Args:
            taken_s: When it was taken, in Unix seconds.
            time_s: The scene time of the exposure. While scene time is held, the newest exposure of that time counts.
        """
        for taken, scene_time, origin in reversed(list(self._exposures)):
            if taken_s is not None and abs(taken - taken_s) > TOLERANCE_S:
                continue
            if time_s is not None and abs(scene_time - time_s) > TOLERANCE_S:
                continue
            return origin
        return None

    def origin(self, exposure: Exposure) -> FrameOrigin:
        """Return the origin of an exposure."""
        return FrameOrigin(self._device.scene.name, self._device.viewpoint, exposure.pose, exposure.time_s)

    def _note(self, exposure: Exposure) -> None:
        self._exposures.append((unix_s(exposure), exposure.time_s, self.origin(exposure)))


def unix_s(exposure: Exposure) -> float:
    """Return when an exposure was taken, in Unix seconds to the microsecond."""
    return round(time() - monotonic() + exposure.taken_s, 6)


def origin_fields(origin: FrameOrigin) -> dict[str, object]:
    """Return an origin for JSON."""
    pose = {"pan_deg": origin.pose.pan_deg, "tilt_deg": origin.pose.tilt_deg, "zoom": origin.pose.zoom}
    return {"scene": origin.scene, "viewpoint": origin.viewpoint, "pose": pose, "time_s": origin.time_s}
