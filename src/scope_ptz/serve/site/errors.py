"""Errors for commands that cannot be executed at the moment."""

from __future__ import annotations

from scope_ptz.errors import ScopeError
from scope_ptz.serve.site.clients import display_name


class NotInControlError(ScopeError):
    """Another client controls the camera.

    Attributes:
        holder: The name of the controlling client.
    """

    def __init__(self, camera: str, holder: str) -> None:
        self.holder = holder
        name = display_name(holder)
        super().__init__(f"{camera} is controlled by {name}. Ask for control, and wait until it is handed over.")


class BusyError(ScopeError):
    """A run is in progress on the camera. ``run`` is its id."""

    def __init__(self, camera: str, run: str) -> None:
        self.run = run
        super().__init__(f"An instruction is in progress on {camera} ({run}). Wait until it ends, or stop it.")


class NotSimulatedError(ScopeError):
    """The command is for simulated cameras only."""


class StoppedError(ScopeError):
    """A run was stopped before its first step."""

    def __init__(self, camera: str) -> None:
        super().__init__(f"Somebody stopped {camera} before the instruction began.")


class RefusedByCameraError(ScopeError):
    """The camera works, but does not support the command."""


class TooManyRequestsError(ScopeError):
    """A client has sent more requests than allowed. ``retry_s`` is the number of seconds until it may retry."""

    def __init__(self, retry_s: float) -> None:
        self.retry_s = retry_s
        super().__init__(f"Too many requests. Try again in {retry_s:.0f} s.")


class EvaluationRunningError(ScopeError):
    """The command is not possible, because an evaluation is in progress. ``evaluation`` is its id."""

    def __init__(self, evaluation: str) -> None:
        self.evaluation = evaluation
        super().__init__(f"An evaluation is in progress ({evaluation}). Wait until it ends, or cancel it.")
