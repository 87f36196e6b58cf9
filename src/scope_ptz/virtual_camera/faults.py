"""Faults that a virtual camera can simulate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.errors import InputError
from scope_ptz.geometry import Axis


class Faults(BaseModel):
    """The faults of a virtual camera. By default, there are none.

    Attributes:
        drop: Fraction of requests for which the connection is closed without a reply.
        stall_s: Delay in seconds before each reply.
        unauthorized: Whether every account is rejected.
        garbage: Whether reply bodies are replaced with invalid data.
        picture: The picture fault: ``truncated`` JPEGs, a ``frozen`` picture, a ``black`` picture, or a wrong ``size``; empty for
            none.
        stuck: Axes that do not move.
        drift_dps: Speed in degrees per second at which the picture drifts away from the reported pose.
        move_status: The move status fault: ``lying`` (always reported as idle) or ``missing`` (not reported); empty for none.
        down: Whether the camera is off the network, as during a reboot.
        clock_skew_s: Seconds by which the camera's clock is fast.
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
    """Validate a mapping of fault names to values, and return the faults.

    Raises:
        InputError: A fault is unknown or has an invalid value.
    """
    try:
        return Faults.model_validate(content)
    except ValidationError as error:
        first = error.errors()[0]
        name = ".".join(str(part) for part in first["loc"][:1])
        known = ", ".join(Faults.model_fields)
        message = (
            f"Unknown fault '{name}'. Known faults: {known}." if first["type"] == "extra_forbidden" else f"{name}: {first['msg']}."
        )
        raise InputError(message) from error
