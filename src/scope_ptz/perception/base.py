"""The perception contract: the calls that a backend implements, and the typed results.

Boxes and points are normalised to [0, 1] with the origin at the top left, whatever convention the model uses. A failure
raises ``PerceptionError``; it never becomes a count of zero, an empty list or an invented result.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt

UnitInterval = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]
Skill = Literal["caption", "query", "detect", "point"]

ALL_SKILLS: frozenset[Skill] = frozenset(("caption", "query", "detect", "point"))


class Agreement(BaseModel):
    """A comparison between a result and a second backend's result for the same call."""

    model_config = ConfigDict(frozen=True)

    other: str
    """The name of the second backend."""
    said: str
    """The second backend's answer, shortened; for boxes and points, their number."""
    share: UnitInterval
    """The agreement between the two results, from 0 to 1."""

    @property
    def agrees(self) -> bool:
        """Whether the agreement is at least 0.5."""
        return self.share >= 0.5


class _Result(BaseModel):
    """The fields that all results share.

    Attributes:
        source: The backend that answered ("ground-truth", "moondream3").
        raw: The reply as received.
        latency_s: Wall-clock time in seconds.
        notes: Corrections to the reply, omissions from it, and failures of backends that were called before ``source``.
        agreement: A comparison with a second backend's result, if one was called.
        attempts: The requests that were sent to a model server.
    """

    model_config = ConfigDict(frozen=True)

    source: str
    raw: str = ""
    latency_s: float = 0.0
    notes: tuple[str, ...] = ()
    agreement: Agreement | None = None
    attempts: tuple[Attempt, ...] = ()


class Box(BaseModel):
    """A box in a frame, in normalised coordinates. ``label`` and ``score`` are None if the model does not return them."""

    model_config = ConfigDict(frozen=True)

    x_min: UnitInterval
    y_min: UnitInterval
    x_max: UnitInterval
    y_max: UnitInterval
    label: str | None = None
    score: float | None = None

    @model_validator(mode="after")
    def _check_order(self) -> Box:
        if self.x_min > self.x_max or self.y_min > self.y_max:
            raise ValueError(f"a box must have min <= max; got {self.x_min, self.y_min, self.x_max, self.y_max}")
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
    """A point in a frame, in normalised coordinates."""

    model_config = ConfigDict(frozen=True)

    x: UnitInterval
    y: UnitInterval
    label: str | None = None


class Caption(_Result):
    """A short description of a frame."""

    text: str


class Answer(_Result):
    """The answer to a question. ``known`` is False if the picture does not show the answer."""

    text: str
    known: bool = True


class Detections(_Result):
    """Boxes of all matches, best first, empty if nothing matches. ``complete`` is False if there may be more matches."""

    boxes: tuple[Box, ...]
    complete: bool = True


class Points(_Result):
    """Points on all matches, best first, empty if nothing matches. ``complete`` is False if there may be more matches."""

    points: tuple[Point, ...]
    complete: bool = True


class Perception(ABC):
    """Base class for perception backends: vision-language models, detectors, OCR, and the simulator's ground truth.

    ``skills`` lists the calls that a backend supports; other calls raise ``PerceptionError``. A detector, for example, does not
    support "query".
    """

    name: str
    skills: frozenset[Skill] = ALL_SKILLS
    version: int | None = None
    """Version of the replies from a deterministic backend such as ground truth; None for backends that use a model."""
    handles_panoramas: bool = False
    """Whether the backend finds small objects in a whole panorama. Other backends receive it as tiles (see
    ``models.tiled_panoramas``).
    """

    @abstractmethod
    async def caption(self, frame: Frame) -> Caption:
        """Return a short description of the view."""

    @abstractmethod
    async def query(self, frame: Frame, question: str) -> Answer:
        """Return the answer to a question about the view."""

    @abstractmethod
    async def detect(self, frame: Frame, description: str) -> Detections:
        """Return a box for each object that matches a description."""

    @abstractmethod
    async def point(self, frame: Frame, description: str) -> Points:
        """Return one point on each object that matches a description."""

    async def close(self) -> None:
        """Release the backend's resources. The default implementation does nothing."""
