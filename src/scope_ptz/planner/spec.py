"""The specification that the factory of a planner plug-in receives."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from scope_ptz.endpoints.endpoint import Endpoint


class PlannerSpec(BaseModel):
    """A request for a planner from an installed plug-in.

    Attributes:
        name: The planner's name, as traces and reports show it.
        model: The value of ``--planner-model``; empty if the option is not given.
        endpoint: The server named by ``--planner-url`` or ``SCOPE_PLANNER_URL``; None if there is none.
        options: The values of ``--planner-option NAME=VALUE``, parsed as JSON where possible.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    model: str = ""
    endpoint: Endpoint | None = None
    options: dict[str, Any] = Field(default_factory=dict)
