"""Checks of a perception backend and its server, on a frame of the user's choice."""

from __future__ import annotations

from collections.abc import AsyncIterator

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.chat_server_checks import Check, Finding, checked
from scope_ptz.perception.base import Perception

_QUESTION = "What is the main thing in this picture? Answer in a few words."
_MOST_WORDS = 120
_MANY = 100


async def check_perception(eyes: Perception, frame: Frame, *, thing: str, absent: str = "purple elephant") -> AsyncIterator[Check]:
    """Check each skill of a backend.

    A reply that becomes a result was parsed, and its boxes lie in the frame.

    Args:
        perception: The backend.
        frame: The frame to look at.
        thing: Something that is in the frame.
        absent: Something that is not in the frame.
    """
    if "caption" in eyes.skills:
        yield await checked("a caption", lambda: _caption(eyes, frame))
    if "query" in eyes.skills:
        yield await checked("a question", lambda: _query(eyes, frame))
    if "detect" in eyes.skills:
        yield await checked(f"boxes of '{thing}'", lambda: _detect(eyes, frame, thing, expected=True))
        yield await checked(f"boxes of '{absent}'", lambda: _detect(eyes, frame, absent, expected=False))
    if "point" in eyes.skills:
        yield await checked(f"points on '{thing}'", lambda: _point(eyes, frame, thing))


async def _caption(eyes: Perception, frame: Frame) -> Finding:
    return _said((await eyes.caption(frame)).text)


async def _query(eyes: Perception, frame: Frame) -> Finding:
    return _said((await eyes.query(frame, _QUESTION)).text)


def _said(text: str) -> Finding:
    words = " ".join(text.split())
    return ("ok", f"'{words[:_MOST_WORDS]}'") if words else ("failed", "it said nothing")


async def _detect(eyes: Perception, frame: Frame, thing: str, *, expected: bool) -> Finding:
    return _found(len((await eyes.detect(frame, thing)).boxes), expected=expected)


async def _point(eyes: Perception, frame: Frame, thing: str) -> Finding:
    return _found(len((await eyes.point(frame, thing)).points), expected=True)


def _found(count: int, *, expected: bool) -> Finding:
    if count > _MANY:
        return "partly", f"{count}: it repeats itself"
    if expected:
        return ("ok", f"{count} found") if count else ("partly", "none found, where there are some")
    return ("ok", "none, as it should be") if not count else ("partly", f"{count} found, where there are none")
