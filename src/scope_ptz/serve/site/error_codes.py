"""The codes and HTTP statuses with which all of the server's interfaces report errors."""

from __future__ import annotations

from scope_ptz.camera.control import ControlHeldError
from scope_ptz.camera.guard.guarded_camera import KeepOutError
from scope_ptz.errors import (
    CameraError,
    InputError,
    OutputError,
    PackError,
    PerceptionError,
    PlannerError,
    ScopeError,
    StoreError,
    ToolCallError,
    TraceError,
    UnknownNameError,
)
from scope_ptz.serve.site.errors import (
    BusyError,
    EvaluationRunningError,
    NotInControlError,
    NotSimulatedError,
    RefusedByCameraError,
    StoppedError,
    TooManyRequestsError,
)

# Errors with their HTTP status and code. The first class that matches an error applies.
_STATUS: tuple[tuple[type[ScopeError], int, str], ...] = (
    (NotInControlError, 409, "not_in_control"),
    (BusyError, 409, "busy"),
    (StoppedError, 409, "stopped"),
    (EvaluationRunningError, 409, "evaluation_in_progress"),
    (RefusedByCameraError, 409, "refused_by_camera"),
    (NotSimulatedError, 409, "not_simulated"),
    (TooManyRequestsError, 429, "too_many_requests"),
    (ControlHeldError, 409, "held_by_another_program"),
    (KeepOutError, 409, "kept_out"),
    (UnknownNameError, 404, "unknown"),
    (OutputError, 507, "cannot_be_written"),
    (InputError, 409, "not_possible"),
    (ToolCallError, 409, "not_possible"),
    (TraceError, 404, "not_stored"),
    (PackError, 503, "scene_damaged"),
    (StoreError, 503, "store_unavailable"),
    (CameraError, 503, "camera_failed"),
    (PerceptionError, 503, "perception_failed"),
    (PlannerError, 503, "planner_failed"),
)


def status_of(error: Exception) -> tuple[int, str]:
    """Return the HTTP status and the code with which an error is reported."""
    return next(((status, code) for kind, status, code in _STATUS if isinstance(error, kind)), (500, "failed"))
