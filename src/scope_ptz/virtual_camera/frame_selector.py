"""Select frames for streams with a lower frame rate than the camera's live video."""

from __future__ import annotations


class FrameSelector:
    """Selects frames from the live video for a stream with a lower frame rate.

    Args:
        source_hz: Frame rate of the live video in frames per second.
        rate_hz: Maximum frame rate of the stream in frames per second; 0 for every frame.
    """

    def __init__(self, source_hz: float, rate_hz: float) -> None:
        self._period_s = 1 / rate_hz if rate_hz else 0.0
        self._tolerance_s = 0.5 / source_hz
        self._due_s = 0.0

    def accepts(self, taken_s: float) -> bool:
        """Return whether the stream includes the frame taken at ``taken_s``.

        Call this once for each frame, in order. A frame may be early by up to half a frame interval of the live video. Otherwise,
        a stream could not reach a rate that does not divide the camera's rate.

        Args:
            taken_s: Time of the exposure in seconds, on the same clock for all frames.
        """
        if not self._period_s:
            return True
        if taken_s < self._due_s - self._tolerance_s:
            return False
        on_time = taken_s < self._due_s + self._period_s
        self._due_s = (self._due_s if on_time else taken_s) + self._period_s
        return True
