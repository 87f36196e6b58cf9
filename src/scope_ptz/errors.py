"""Every error that SCOPE raises on purpose.

ScopeError
├── InputError              what the user typed or configured is wrong (command line: exit code 2)
│   ├── ConfigError         a setting, an option or a URL
│   ├── UnknownNameError    a scene, viewpoint, preset, planner or tool that does not exist
│   └── OutputError         a folder or file that cannot be written
├── PackError               a viewpoint pack is missing, damaged or of another version (exit code 2)
├── CameraError             the camera did not do, or does not answer
├── PerceptionError         a frame could not be read (never to be confused with "nothing there")
├── PlannerError            the planner failed or answered with something that is no decision
├── ServerFailure           a model server gave no usable reply (endpoints.failures); planners and eyes turn it into the two above
├── ToolCallError           a tool call with a wrong name or wrong arguments
├── TraceError              a trace that cannot be read or replayed
└── BlenderError            the Blender worker is missing or failed
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import Protocol

__all__ = [
    "BlenderError",
    "CameraError",
    "ConfigError",
    "InputError",
    "OutputError",
    "PackError",
    "PerceptionError",
    "PlannerError",
    "ScopeError",
    "ToolCallError",
    "TraceError",
    "Tried",
    "UnknownNameError",
]


class Tried(Protocol):
    """One request to a model server: ``kind`` is how it failed, None when it worked."""

    @property
    def kind(self) -> str | None: ...


class ScopeError(Exception):
    """Root of all errors that SCOPE raises on purpose. The message says what was wrong and what to do."""


class InputError(ScopeError):
    """What the user typed or configured is wrong."""


class ConfigError(InputError):
    """A setting, an option or a URL is wrong."""


class UnknownNameError(InputError):
    """A name that is not known, with the names that are."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind, self.name, self.known = kind, name, sorted(known)
        close = get_close_matches(name.lower(), self.known, n=1, cutoff=0.6)
        hint = f" Did you mean '{close[0]}'?" if close else ""
        listing = ", ".join(self.known) if self.known else "none"
        super().__init__(f"There is no {kind} '{name}'.{hint} Known: {listing}.")


class OutputError(InputError):
    """A folder or file cannot be written."""


class PackError(ScopeError):
    """A scene or viewpoint pack is missing, damaged or of another version."""


class CameraError(ScopeError):
    """The camera did not do what it was told, or does not answer."""


class _ModelError(ScopeError):
    """An error of something that may be a model on a server.

    ``kind``: the way in which the server failed (``endpoints.FailureKind``), None when no server did. ``attempts``: what was
    tried (``endpoints.Attempt``).
    """

    def __init__(self, *message: object, kind: str | None = None, attempts: Sequence[Tried] = ()) -> None:
        super().__init__(*message)
        self.kind, self.attempts = kind, tuple(attempts)


class PerceptionError(_ModelError):
    """A frame could not be read. This is never the same as "nothing there"."""


class PlannerError(_ModelError):
    """The planner failed, or answered with something that is no decision."""


class ToolCallError(ScopeError):
    """A tool call with a wrong name or wrong arguments."""


class TraceError(ScopeError):
    """A trace that cannot be read or replayed."""


class BlenderError(ScopeError):
    """The Blender worker is missing or failed."""
