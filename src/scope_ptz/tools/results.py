"""Tool results. Each result contains the pose after the call and the axes that stopped at a limit."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, SerializerFunctionWrapHandler, model_serializer

from scope_ptz.geometry import Axis, Pose
from scope_ptz.tools.arguments import View


class PoseData(BaseModel):
    """A pose as JSON data, in degrees and magnification."""

    model_config = ConfigDict(frozen=True)

    pan_deg: float
    tilt_deg: float
    zoom: float

    @classmethod
    def of(cls, pose: Pose) -> PoseData:
        """Convert a pose."""
        return cls(**pose.as_dict())


class Result(BaseModel):
    """Base class of all tool results.

    Attributes:
        message: The result in plain words, for the planner and the user.
        pose: The camera's pose after the call.
        clamped: The axes that a limit stopped.
    """

    model_config = ConfigDict(frozen=True)

    message: str
    pose: PoseData
    clamped: tuple[Axis, ...] = ()


class MoveResult(Result):
    """The result of ``adjust_ptz``, ``go_to_preset`` and ``go_home``.

    Attributes:
        preset: The preset that the camera went to; None for other moves.
        held_back_by: A phrase that names what held the move back, such as a rule of the site; None if nothing did. None is not
            serialized.
    """

    preset: str | None = None
    held_back_by: str | None = None

    @model_serializer(mode="wrap")
    def _omit_missing_rule(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        data: dict[str, Any] = handler(self)
        if data.get("held_back_by") is None:
            data.pop("held_back_by", None)
        return data


class PerceptionResult(Result):
    """Base class of the results of perception calls.

    Attributes:
        source: The perception backend that answered.
        view: The view that perception received.
        frames: File names of the saved pictures in the run folder.
    """

    source: str
    view: View = "current"
    frames: tuple[str, ...] = ()
