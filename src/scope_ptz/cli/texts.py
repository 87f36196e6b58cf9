"""Format values as short texts that are safe to print."""

from __future__ import annotations

import json
from typing import Any

MAX_SHOWN_CHARS = 200  # longer instructions and arguments are truncated when printed


def plain(text: str) -> str:
    """Return text without control characters, so that text from models and scenes cannot control the terminal."""
    return "".join(c if c.isprintable() or c == "\n" else " " for c in text)


def shortened(text: str, limit: int = MAX_SHOWN_CHARS) -> str:
    """Truncate a text that is longer than a number of characters, and append its full length."""
    return text if len(text) <= limit else f"{text[:limit].rstrip()}… ({len(text)} characters)"


def arguments_text(arguments: dict[str, Any]) -> str:
    """Format arguments for display: ``pan_deg=15, view=current``."""
    parts = (f"{k}={v if isinstance(v, str) and v.isprintable() else json.dumps(v)}" for k, v in arguments.items())
    return plain(shortened(", ".join(parts)))


def seconds(value: float) -> str:
    """Format a duration in seconds or milliseconds."""
    return f"{value:.1f} s" if value >= 1 else f"{value * 1000:.0f} ms"
