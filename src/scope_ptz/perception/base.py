"""The perception contract: what can be asked about a frame, and the typed results.

Boxes and points are normalised to [0, 1], origin top-left, whatever the model behind it says. A failure raises
``PerceptionError``: it is never a zero, an empty list or an invented success.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt

Unit = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
Skill = Literal["caption", "query", "detect", "point"]

ALL_SKILLS: frozenset[Skill] = frozenset(("caption", "query", "detect", "point"))


class Agreement(BaseModel):
    """How far a second opinion on the same question went along: ``share`` from 0 to 1, ``agrees`` from a half on."""

    model_config = ConfigDict(frozen=True)

    other: str
    """Who was asked as well."""
    said: str
    """What it said, in short; for places how many."""
    share: Unit

    @property
    def agrees(self) -> bool:
        return self.share >= 0.5


class _Result(BaseModel):
    """``source`` names who looked ("ground-truth", "moondream3"), ``raw`` is its reply as it came, ``latency_s`` wall time.

    ``notes`` say what was corrected or left out of the reply, or who failed before ``source`` was asked; ``agreement`` is there
    when a second backend was asked too; ``attempts`` are the calls to a model server that it took.
    """

    model_config = ConfigDict(frozen=True)

    source: str
    raw: str = ""
    latency_s: float = 0.0
    notes: tuple[str, ...] = ()
    agreement: Agreement | None = None
    attempts: tuple[Attempt, ...] = ()


class Box(BaseModel):
    """A box in a frame, normalised; ``label`` and ``score`` where the model gives them."""

    model_config = ConfigDict(frozen=True)

    x_min: Unit
    y_min: Unit
    x_max: Unit
    y_max: Unit
    label: str | None = None
    score: float | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Box:
        if self.x_min > self.x_max or self.y_min > self.y_max:
            raise ValueError(f"a box needs min <= max, got {self.x_min, self.y_min, self.x_max, self.y_max}")
        return self

    @property
    def centre(self) -> tuple[float, float]:
        return (self.x_min + self.x_max) / 2, (self.y_min + self.y_max) / 2

    @property
    def width(self) -> float:
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        return self.y_max - self.y_min


class Point(BaseModel):
    model_config = ConfigDict(frozen=True)

    x: Unit
    y: Unit
    label: str | None = None


class Caption(_Result):
    text: str


class Answer(_Result):
    """``text`` is what to tell the user; ``known`` is False when the honest answer is "I cannot tell"."""

    text: str
    known: bool = True


class Detections(_Result):
    """Every match, best first. Empty means looked and found nothing; not ``complete`` that there are more than these."""

    boxes: tuple[Box, ...]
    complete: bool = True


class Points(_Result):
    """Every match, best first. Empty means looked and found nothing; not ``complete`` that there are more than these."""

    points: tuple[Point, ...]
    complete: bool = True


class Perception(ABC):
    """Eyes: a vision-language model, a detector, OCR, or the simulator's ground truth.

    What a backend cannot do at all (a detector asked a question) is missing from its ``skills`` and raises ``PerceptionError``.
    """

    name: str
    skills: frozenset[Skill] = ALL_SKILLS
    sees_wide: bool = False
    """Whether it finds small things in a panorama by itself. ``perception.wide`` shows the others one part after another."""

    @abstractmethod
    async def caption(self, frame: Frame) -> Caption:
        """A short description of the view."""

    @abstractmethod
    async def query(self, frame: Frame, question: str) -> Answer:
        """The answer to a question about the view."""

    @abstractmethod
    async def detect(self, frame: Frame, description: str) -> Detections:
        """Boxes of everything that fits a description."""

    @abstractmethod
    async def point(self, frame: Frame, description: str) -> Points:
        """One point on everything that fits a description."""

    async def close(self) -> None:
        """Release what the backend holds. The default holds nothing."""
