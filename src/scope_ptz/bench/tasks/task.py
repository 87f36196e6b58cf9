"""The schema of benchmark tasks: the instruction, the expected answer and behaviour, and the evidence.

Angles are in degrees in the camera's frame (positive pan is right, positive tilt is up), and zoom is magnification. The
docstrings of these models are part of the published JSON schema of tasks and change only with its version.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue, TypeAdapter, model_validator

from scope_ptz.bench.tasks.expected import ActionOnly, Expected, Wordings
from scope_ptz.simulator.pack import variation_name
from scope_ptz.tools.registry import TOOLS

CANARY: Literal["SCOPE-BENCH-CANARY 6b0c2f0e-9d1e-4f6c-8a57-0e2f6a1d7c34"] = (
    "SCOPE-BENCH-CANARY 6b0c2f0e-9d1e-4f6c-8a57-0e2f6a1d7c34"
)
"""Marker in every task, which makes it possible to detect training corpora that contain tasks."""

Category = Literal[
    "counting", "descriptor", "location", "ocr", "single_call", "multi_step_command", "multi_step_reasoning", "comparative"
]
Scope = Literal["current", "full"]
Need = Literal["move", "sweep", "zoom", "preset"]
Stratum = Literal["core", "reaction", "paraphrase"]
RunOutcome = Literal["answered", "clarification", "refused"]
if TYPE_CHECKING:
    ToolName = str
else:
    ToolName = Literal[tuple(TOOLS)]  # Built from the registry, so that a new tool needs no change here.
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Aim(_Model):
    """A pose, from one of the scene's optical centres."""

    viewpoint: str
    pan_deg: Finite
    tilt_deg: Finite
    zoom: Positive


class FinalPose(Aim):
    """Where the camera must look in the end. ``zoom_share`` is relative: 0.03 = 3%."""

    tolerance_deg: Positive = 0.5
    zoom_share: Positive = 0.03


class Argument(_Model):
    """What an argument of a required call must be: a value (numbers within ``within``), or words that must be in it."""

    equals: Finite | str | None = None
    within: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    mentions: Wordings = ()

    @model_validator(mode="after")
    def _check_exclusive(self) -> Argument:
        if (self.equals is None) == (not self.mentions):
            raise ValueError("exactly one of equals and mentions must be set")
        return self


class RequiredCall(_Model):
    """A call that must succeed ``times`` times. Zooms by percent are compared as ``zoom_factor``; a default need not be written."""

    tool: ToolName
    arguments: dict[str, Argument] = {}
    times: int = Field(default=1, ge=1)


class Forbidden(_Model):
    """What must not happen: tools that must not succeed, and what must be at the end as it was at the start."""

    tools: tuple[ToolName, ...] = ()
    changes: tuple[Literal["pan", "tilt", "zoom", "viewpoint"], ...] = ()


class Framing(_Model):
    """A target that must be in the middle at the end and large, as its outline of (pan, tilt) directions tells."""

    instance: str
    viewpoint: str
    outline_deg: Annotated[tuple[tuple[Finite, Finite], ...], Field(min_length=3)]
    min_fill: Positive = 0.6
    max_fill: Positive = 0.9
    max_offset: Positive = 0.02


class Behaviour(_Model):
    """What the camera must have done, as far as the instruction fixes it. ``pictures``: how many ``take_image`` must leave."""

    outcomes: Annotated[tuple[RunOutcome, ...], Field(min_length=1)] = ("answered",)
    final: FinalPose | None = None
    calls: tuple[RequiredCall, ...] = ()
    order: Literal["ordered", "any"] = "ordered"
    forbidden: Forbidden = Forbidden()
    pictures: int | None = Field(default=None, ge=0)
    framing: Framing | None = None

    @property
    def checks_something(self) -> bool:
        """Whether anything other than the outcome of the run is required."""
        return bool(
            self.final or self.calls or self.forbidden.tools or self.forbidden.changes or self.pictures is not None or self.framing
        )


class Item(_Model):
    """One piece of evidence: an instance or text, its value, and where it shows: (pan_min, tilt_min, pan_max, tilt_max).

    ``pan_min`` may exceed ``pan_max`` where the box goes across 180 degrees. ``min_px``: how long its longer side must be in a
    frame to be told; ``cap_height_deg``: of a text, whose capitals must be 14 px high.
    """

    instance: str
    value: str | bool | Finite | None = None
    box_deg: tuple[Finite, Finite, Finite, Finite]
    min_px: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    cap_height_deg: Positive | None = None


class EvidenceView(_Model):
    """A view that the answer rests on. ``whole``: everything in it matters, not only its items (absences, counts).

    ``hfov_deg``/``aspect`` describe the reference frame; ``band_deg`` (bottom, top): the tilts that count when the scope is full.
    ``shows``: what a perfect look at this view says. ``about``: only calls that mention one of these words count as such a look.
    ``window_s``: scene times between which a look counts, where something moves.
    """

    aim: Aim
    scope: Scope = "current"
    hfov_deg: Annotated[float, Field(gt=0, lt=180)]
    aspect: Positive = 16 / 9
    band_deg: tuple[Finite, Finite] | None = None
    items: tuple[Item, ...] = ()
    whole: bool = False
    min_density_px_deg: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    must_look: bool = True
    shows: Expected | None = None
    about: Wordings = ()
    window_s: tuple[Finite, Finite] | None = None

    @model_validator(mode="after")
    def _check_evidence(self) -> EvidenceView:
        if self.must_look and not self.items and not self.whole:
            raise ValueError("an evidence view with must_look must have items or whole=true")
        if self.scope == "full" and self.whole and self.band_deg is None:
            raise ValueError("a whole view with the scope full must have band_deg")
        return self


class ProgramCall(_Model):
    """One call of a reference program, exactly as it is made."""

    tool: ToolName
    arguments: dict[str, JsonValue] = {}


class Task(_Model):
    """A task. ``preset``: where the camera starts; ``time_s``: scene time then; ``pair``: the task of like wording whose answer is
    a presence where this one's is an absence, or the other way round; ``variation``: which varied world of the scene, if one."""

    id: Annotated[str, Field(pattern=r"^scope\d+(-[a-z0-9]+)+-\d{3,}$")]
    dataset: Annotated[str, Field(pattern=r"^scope\d+$")]
    stratum: Stratum = "core"
    scene: str
    variation: int | None = Field(default=None, ge=1, lt=10**9)
    preset: str
    time_s: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    instruction: Annotated[str, Field(min_length=1, max_length=4000)]
    category: Category
    scope: Scope
    difficulty: Literal["easy", "medium", "hard"]
    expected: Expected
    behaviour: Behaviour = Behaviour()
    evidence: tuple[EvidenceView, ...] = ()
    reference: tuple[ProgramCall, ...] = ()
    needs: tuple[Need, ...] = ()
    tags: tuple[str, ...] = ()
    pair: str | None = None
    paraphrase_of: str | None = None
    canary: Literal["SCOPE-BENCH-CANARY 6b0c2f0e-9d1e-4f6c-8a57-0e2f6a1d7c34"] = CANARY

    @property
    def world(self) -> str:
        """Name of the scene to open, or of its variation."""
        return self.scene if self.variation is None else variation_name(self.scene, self.variation)

    @model_validator(mode="after")
    def _check_consistency(self) -> Task:
        if not self.id.startswith(f"{self.dataset}-"):
            raise ValueError(f"the id must begin with the dataset version {self.dataset}; got {self.id}")
        if (self.stratum == "paraphrase") != (self.paraphrase_of is not None):
            raise ValueError("paraphrase_of must be set for every paraphrase and for no other task")
        if isinstance(self.expected, ActionOnly):
            if not self.behaviour.checks_something and self.behaviour.outcomes == ("answered",):
                raise ValueError("a task without an expected answer must require some behaviour, otherwise nothing is checked")
        elif self.stratum != "reaction" and not any(view.must_look for view in self.evidence):
            raise ValueError("a task with an expected answer must have an evidence view with must_look")
        return self


TASK: TypeAdapter[Task] = TypeAdapter(Task)


def schema() -> dict[str, Any]:
    """Return the published JSON schema of a task."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Task.model_json_schema()}
