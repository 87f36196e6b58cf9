"""Faults that a virtual camera simulates on demand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.errors import InputError
from scope_ptz.geometry import Axis


class Faults(BaseModel):
    """The faults of a virtual camera. By default, there are none.

    Attributes:
        drop: Fraction of requests whose connection is closed without a reply.
        stall_s: Seconds by which every reply is delayed.
        unauthorized: Whether every account is rejected.
        garbage: Whether reply bodies are replaced by invalid data.
        picture: The image fault: ``truncated`` JPEGs, a ``frozen`` image, a ``black`` image, or a wrong ``size``; empty for none.
        stuck: Axes whose motors do not turn.
        drift_dps: Degrees per second by which the image drifts away from the pose that the encoders report.
        move_status: The fault of the move status: ``lying`` (always idle) or ``missing`` (not reported); empty for none.
        down: Whether the camera is off the network, as during a reboot.
        clock_skew_s: Seconds by which the camera's clock is ahead.
    """

    model_config = ConfigDict(extra="forbid", validate_assignment=True)

    drop: float = Field(default=0.0, ge=0.0, le=1.0)
    stall_s: float = Field(default=0.0, ge=0.0, le=600.0)
    unauthorized: bool = False
    garbage: bool = False
    picture: Literal["", "truncated", "frozen", "black", "size"] = ""
    stuck: frozenset[Axis] = frozenset()
    drift_dps: float = Field(default=0.0, ge=-10.0, le=10.0)
    move_status: Literal["", "lying", "missing"] = ""
    down: bool = False
    clock_skew_s: float = Field(default=0.0, ge=-1e6, le=1e6)


def validate_faults(content: Mapping[str, object]) -> Faults:
    """Return the faults from a mapping of their names to values, after checking both.

    Raises:
        InputError: A fault is unknown or has an invalid value.
    """
    try:
        return Faults.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"][:1])
        known = ", ".join(Faults.model_fields)
        what = f"There is no fault '{name}'. Known: {known}." if first["type"] == "extra_forbidden" else f"{name}: {first['msg']}."
        raise InputError(what) from error
