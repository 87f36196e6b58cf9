"""Check a perception backend and its server with one frame."""

from __future__ import annotations

from collections.abc import AsyncIterator

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.chat_server_checks import Finding, ServerCheck, run_check
from scope_ptz.perception.base import Perception

_QUESTION = "What is the main thing in this picture? Answer in a few words."
_MAX_SHOWN_CHARS = 120
_MAX_PLAUSIBLE_COUNT = 100


async def check_perception(
    perception: Perception, frame: Frame, *, thing: str, absent: str = "purple elephant"
) -> AsyncIterator[ServerCheck]:
    """Check each skill of a backend, and yield the results.

    A check passes only if the reply can be parsed and its boxes lie within the frame.

    Args:
        perception: The backend.
        frame: The frame.
        thing: The name of something that is in the frame.
        absent: The name of something that is not in the frame.
    """
    if "caption" in perception.skills:
        yield await run_check("a caption", lambda: _caption(perception, frame))
    if "query" in perception.skills:
        yield await run_check("a question", lambda: _query(perception, frame))
    if "detect" in perception.skills:
        yield await run_check(f"boxes of '{thing}'", lambda: _detect(perception, frame, thing, expected=True))
        yield await run_check(f"boxes of '{absent}'", lambda: _detect(perception, frame, absent, expected=False))
    if "point" in perception.skills:
        yield await run_check(f"points on '{thing}'", lambda: _point(perception, frame, thing))


async def _caption(perception: Perception, frame: Frame) -> Finding:
    return _check_text((await perception.caption(frame)).text)


async def _query(perception: Perception, frame: Frame) -> Finding:
    return _check_text((await perception.query(frame, _QUESTION)).text)


def _check_text(text: str) -> Finding:
    words = " ".join(text.split())
    return ("ok", f"'{words[:_MAX_SHOWN_CHARS]}'") if words else ("failed", "the answer is empty")


async def _detect(perception: Perception, frame: Frame, thing: str, *, expected: bool) -> Finding:
    return _check_count(len((await perception.detect(frame, thing)).boxes), expected=expected)


async def _point(perception: Perception, frame: Frame, thing: str) -> Finding:
    return _check_count(len((await perception.point(frame, thing)).points), expected=True)


def _check_count(count: int, *, expected: bool) -> Finding:
    if count > _MAX_PLAUSIBLE_COUNT:
        return "partly", f"{count} found; the model repeats itself"
    if expected:
        return ("ok", f"{count} found") if count else ("partly", "none found, although there are some")
    return ("ok", "none, as expected") if not count else ("partly", f"{count} found, although there are none")
