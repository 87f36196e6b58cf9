"""The selection of frames for streams with a lower frame rate."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.virtual_camera.frame_selector import FrameSelector


def test_a_stream_without_a_rate_takes_every_frame() -> None:
    selector = FrameSelector(25, 0)
    assert all(selector.accepts(100 + n / 25) for n in range(50))


@given(st.floats(1, 60), st.floats(0, 1e6))
def test_a_stream_has_its_own_rate_or_that_of_the_camera(rate_hz: float, start_s: float) -> None:
    selector, seconds = FrameSelector(25, rate_hz), 40
    taken = sum(selector.accepts(start_s + n / 25) for n in range(25 * seconds))
    assert abs(taken / seconds - min(rate_hz, 25)) <= 0.05


def test_after_a_pause_frames_are_not_made_up_for() -> None:
    selector = FrameSelector(100, 10)
    assert selector.accepts(0.0)
    assert [selector.accepts(5.0 + n / 100) for n in range(12)] == [True, *[False] * 9, True, False]
