"""The observation spaces, and the conversion of poses and text to them."""

from __future__ import annotations

import string
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from scope_ptz.geometry import Limits, Pose

FRAME_SIZE = (320, 180)
"""Default width and height, in pixels, of the frames that an agent receives."""

MAX_TEXT_CHARS = 4000  # the longest task instruction
CHARSET = frozenset(string.printable) | frozenset(map(chr, (*range(0xA0, 0x100), *range(0x2010, 0x2028), 0x20AC, 0x2212, 0x2026)))
"""The characters allowed in observations and actions: ASCII, Latin-1, and common punctuation. They are the same in every
environment, so that environments with different tasks can be vectorised together."""

Observation = dict[str, Any]


def text_space(max_chars: int = MAX_TEXT_CHARS) -> spaces.Text:
    """Return the space of text with up to ``max_chars`` characters."""
    return spaces.Text(max_chars, min_length=0, charset=CHARSET)


def frame_space(size: tuple[int, int]) -> spaces.Box:
    """Return the space of RGB frames. ``size`` is the width and height in pixels."""
    width, height = size
    return spaces.Box(0, 255, (height, width, 3), np.uint8)


def pose_space(limits: Limits | None = None) -> spaces.Box:
    """Return the space of poses: pan and tilt in degrees, and magnification."""
    limits = limits or Limits()
    low, high = (
        np.array([getattr(limits, f"{end}_{axis}") for axis in ("pan_deg", "tilt_deg", "zoom")], np.float32)
        for end in ("min", "max")
    )
    return spaces.Box(low, high, dtype=np.float32)


def pose_array(pose: Pose) -> NDArray[np.float32]:
    """Return a pose as an element of ``pose_space``."""
    return np.array([pose.pan_deg, pose.tilt_deg, pose.zoom], np.float32)


def clean_text(text: str) -> str:
    """Return text as an element of ``text_space``: unknown characters become "?", and long text is truncated."""
    return "".join(char if char in CHARSET else "?" for char in text[:MAX_TEXT_CHARS])
