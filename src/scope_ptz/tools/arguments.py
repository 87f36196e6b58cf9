"""The arguments of the nine tools. Their JSON schemas are what planners see, identical for every camera."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

View = Literal["current", "full"]
Degrees = Annotated[float, Field(allow_inf_nan=False)]
Phrase = Annotated[str, Field(min_length=1, max_length=500, pattern=r"\S")]


class Arguments(BaseModel):
    """Wrong types, unknown fields, NaN and infinities are errors; finite values beyond a limit are clamped by the camera."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class AdjustPtz(Arguments):
    """Turn and zoom the camera relative to where it looks now. Pan: positive = right. Tilt: positive = up."""

    pan_deg: Degrees = Field(0.0, description="Degrees to turn right (negative: left).")
    tilt_deg: Degrees = Field(0.0, description="Degrees to turn up (negative: down).")
    zoom_factor: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = Field(
        None, description="Times the present magnification: 2.0 = twice as close, 0.5 = half as close."
    )
    zoom_percent: Annotated[float, Field(gt=-100, allow_inf_nan=False)] | None = Field(
        None, description="Change of magnification in percent: 50 = 1.5 times as close, -50 = half as close."
    )
    zoom_limit: Literal["in", "out"] | None = Field(None, description="Zoom to the stop: 'in' = closest, 'out' = widest.")

    @model_validator(mode="after")
    def _one_zoom(self) -> AdjustPtz:
        if sum(v is not None for v in (self.zoom_factor, self.zoom_percent, self.zoom_limit)) > 1:
            raise ValueError("give at most one of zoom_factor, zoom_percent, zoom_limit")
        return self


class GoToPreset(Arguments):
    """Go to a named preset view."""

    name: Phrase = Field(description="Name of the preset, as get_presets lists it.")


class GoHome(Arguments):
    """Return to the home view."""


class GetPresets(Arguments):
    """List the named preset views."""


class TakeImage(Arguments):
    """Save a picture of the current view."""


class CountObjects(Arguments):
    """Count the objects that fit a description."""

    description: Phrase = Field(description="What to count, for example 'traffic cones' or 'red cars'.")
    view: View = Field("current", description="'current' = this view only, 'full' = sweep everything around the camera.")


class QueryAnswer(Arguments):
    """Answer a question about what the camera sees: existence, colour, text, position, state."""

    question: Phrase = Field(description="The question, in plain words.")
    view: View = Field("current", description="'current' = this view only, 'full' = sweep everything around the camera.")


class ZoomToObject(Arguments):
    """Find an object in the current view, centre it and zoom in on it."""

    description: Phrase = Field(description="What to zoom in on, for example 'the white van'.")


class TrackObject(Arguments):
    """Keep a moving object in the middle of the view for some time."""

    description: Phrase = Field(description="What to follow, for example 'the white van'.")
    duration_s: Annotated[float, Field(gt=0, le=600, allow_inf_nan=False)] = Field(10.0, description="For how many seconds.")
