"""The type of progress callbacks for captures."""

from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, int, int], None]
"""A progress callback, called with the name of a phase, the number of finished steps, and the total number of steps."""
