"""The base class and shared types for tool arguments. Planners receive JSON schemas that pydantic generates from them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

View = Literal["current", "full"]
Degrees = Annotated[float, Field(allow_inf_nan=False)]
Phrase = Annotated[str, Field(min_length=1, max_length=500, pattern=r"\S")]


class Arguments(BaseModel):
    """Base class for tool arguments.

    Wrong types, unknown fields, NaN and infinities are errors. Finite values beyond a limit are clamped by the camera.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
