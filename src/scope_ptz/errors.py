"""The exceptions that SCOPE raises.

ScopeError
├── InputError           the user's input is wrong (exit code 2)
│   ├── ConfigError         a setting, an option or a URL is wrong
│   ├── UnknownNameError    a scene, viewpoint, preset, planner or tool does not exist
│   └── OutputError         a folder or file cannot be written
├── PackError               a pack is missing, damaged or has an unsupported version (exit code 2)
├── CameraError             the camera fails or does not answer (camera.network.errors lists those of network cameras)
├── PerceptionError         perception cannot interpret a frame (an empty result is not an error)
├── PlannerError            the planner fails, or its reply is not a decision
├── ServerFailure           a model server gives no usable reply (endpoints.failures); converted to one of the two errors above
├── ToolCallError           a tool call has an unknown name or invalid arguments
├── TraceError              a trace cannot be read or replayed
├── StoreError              the run store is locked, damaged, or was created by a newer version
└── BlenderError            the Blender worker is missing or fails
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
    "RequestRecord",
    "ScopeError",
    "StoreError",
    "ToolCallError",
    "TraceError",
    "UnknownNameError",
]


class RequestRecord(Protocol):
    """A recorded request to a model server. ``kind`` says how the request failed; None if it succeeded."""

    @property
    def kind(self) -> str | None: ...


class ScopeError(Exception):
    """Base class of all SCOPE errors. The message states what is wrong and what to do."""


class InputError(ScopeError):
    """The user's input is wrong, for example an instruction, a name or a setting."""


class ConfigError(InputError):
    """A setting, an option or a URL is wrong."""


class UnknownNameError(InputError):
    """A name is unknown. The message lists the known names and suggests the closest one."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.kind, self.name, self.known = kind, name, sorted(known)
        close = get_close_matches(name.lower(), self.known, n=1, cutoff=0.6)
        hint = f" Did you mean '{close[0]}'?" if close else ""
        listing = ", ".join(self.known) if self.known else "none"
        super().__init__(f"There is no {kind} '{name}'.{hint} Known: {listing}.")


class OutputError(InputError):
    """A folder or file cannot be written."""


class PackError(ScopeError):
    """A scene or viewpoint pack is missing, damaged or has an unsupported version."""


class CameraError(ScopeError):
    """The camera fails or does not answer."""


class _ModelError(ScopeError):
    """An error from a planner or a perception backend, which may use a model server.

    Attributes:
        kind: How the server failed (a value of ``endpoints.failures.FailureKind``); None if no server failed.
        attempts: The requests that were sent to the server (``endpoints.failures.Attempt``).
    """

    def __init__(self, *message: object, kind: str | None = None, attempts: Sequence[RequestRecord] = ()) -> None:
        super().__init__(*message)
        self.kind, self.attempts = kind, tuple(attempts)


class PerceptionError(_ModelError):
    """Perception cannot interpret a frame. An empty result ("nothing there") is not an error."""


class NotUnderstoodError(PerceptionError):
    """Perception does not understand a question or a description. The caller can rephrase it."""


class PlannerError(_ModelError):
    """The planner fails, or its reply is not a decision."""


class ToolCallError(ScopeError):
    """A tool call has an unknown name or invalid arguments."""


class TraceError(ScopeError):
    """A trace cannot be read or replayed."""


class StoreError(ScopeError):
    """The run store is locked by another program, damaged, or was created by a newer version."""


class BlenderError(ScopeError):
    """The Blender worker is missing or fails."""
