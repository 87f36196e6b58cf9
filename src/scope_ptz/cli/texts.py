"""Format values as short strings that are safe to print."""

from __future__ import annotations

import json
from typing import Any

MAX_SHOWN_CHARS = 200  # longer instructions and arguments are truncated when printed


def sanitize(text: str) -> str:
    """Replace control characters in text, so that output from models and scenes cannot control the terminal."""
    return "".join(c if c.isprintable() or c == "\n" else " " for c in text)


def shorten(text: str, limit: int = MAX_SHOWN_CHARS) -> str:
    """Truncate text to ``limit`` characters, and append its full length if it was longer."""
    return text if len(text) <= limit else f"{text[:limit].rstrip()}… ({len(text)} characters)"


def arguments_text(arguments: dict[str, Any]) -> str:
    """Format arguments for display, such as ``pan_deg=15, view=current``."""
    parts = (f"{k}={v if isinstance(v, str) and v.isprintable() else json.dumps(v)}" for k, v in arguments.items())
    return sanitize(shorten(", ".join(parts)))


def seconds_text(value: float) -> str:
    """Format a duration in seconds or milliseconds."""
    return f"{value:.1f} s" if value >= 1 else f"{value * 1000:.0f} ms"
