"""Asking a vision-language model in its own convention, and turning its words into results. Shared by served and local models."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Point, Points
from scope_ptz.perception.models.coordinates import Convention, Located, located
from scope_ptz.perception.models.encoding import Size
from scope_ptz.perception.models.reply_parsing import cannot_tell, excerpt, read_answer, read_places

MAX_RAW_CHARS = 20_000
"""Of a longer reply the trace keeps this much."""


class VisionReply:
    """A model's words about one frame, ready to become a result.

    ``attempts`` of the call are put into results and errors; a reply that the server delivered and nobody can read counts
    against its last attempt. ``cut``: the server says that the reply stopped at the token limit.
    """

    def __init__(self, source: str, text: str, began: float, attempts: tuple[Attempt, ...] = (), *, cut: bool = False) -> None:
        self.source, self.text, self.attempts, self.cut, self._began = source, text, attempts, cut, began

    def preceded(self, error: PerceptionError) -> VisionReply:
        """The same reply, with what was tried before it in vain."""
        earlier = tuple(a for a in error.attempts if isinstance(a, Attempt))
        return VisionReply(self.source, self.text, self._began, (*earlier, *self.attempts), cut=self.cut)

    def caption(self) -> Caption:
        with blamed(self.source, self.attempts):
            return Caption(text=read_answer(self.text), **self._common(self._cut_answer()))

    def answer(self) -> Answer:
        with blamed(self.source, self.attempts):
            text = read_answer(self.text)
        return Answer(text=text, known=not cannot_tell(text), **self._common(self._cut_answer()))

    def _cut_answer(self) -> tuple[str, ...]:
        return ("The answer was cut off at the token limit.",) if self.cut else ()

    def detections(self, convention: Convention, sent: Size) -> Detections:
        found, complete, notes = self._located(convention, sent)
        if found.points and not found.boxes:
            raise self.unreadable("points instead of boxes")
        return Detections(boxes=found.boxes, complete=complete, **self._common(notes))

    def points(self, convention: Convention, sent: Size) -> Points:
        """Points, or the middles of boxes from a model that knows only these."""
        found, complete, notes = self._located(convention, sent)
        points = found.points or tuple(Point(x=b.centre[0], y=b.centre[1], label=b.label) for b in found.boxes)
        return Points(points=points, complete=complete, **self._common(notes))

    def _located(self, convention: Convention, sent: Size) -> tuple[Located, bool, tuple[str, ...]]:
        with blamed(self.source, self.attempts):
            read = read_places(self.text)
            found = located(read.things, convention, sent)
        whole = read.complete and not (self.cut and found.boxes + found.points)
        notes = () if whole else ("The reply was cut off: there may be more.",)
        return found, found.complete and whole, found.notes + notes

    def unreadable(self, what: str) -> PerceptionError:
        kind = FailureKind.MALFORMED
        return PerceptionError(
            f"{self.source} gave {what}: {excerpt(self.text)}", kind=kind.value, attempts=_with_kind(self.attempts, kind)
        )

    def _common(self, notes: tuple[str, ...] = ()) -> dict[str, Any]:
        raw = self.text if len(self.text) <= MAX_RAW_CHARS else self.text[:MAX_RAW_CHARS] + "…"
        latency_s = perf_counter() - self._began
        return {"source": self.source, "raw": raw, "latency_s": latency_s, "notes": notes, "attempts": self.attempts}


@contextmanager
def blamed(source: str, attempts: tuple[Attempt, ...]) -> Iterator[None]:
    """Errors in reading a reply say whose it was, and count against the attempt that brought it."""
    try:
        yield
    except PerceptionError as error:
        kind = FailureKind(error.kind) if error.kind is not None else None
        tried = _with_kind(attempts, kind) if kind is not None else attempts
        raise PerceptionError(f"{source}: {error}", kind=error.kind, attempts=tried) from error


def _with_kind(attempts: tuple[Attempt, ...], kind: FailureKind) -> tuple[Attempt, ...]:
    return (*attempts[:-1], attempts[-1].model_copy(update={"kind": kind})) if attempts else ()


@contextmanager
def served(source: str) -> Iterator[None]:
    """What a server failed to do becomes a ``PerceptionError`` with its kind and everything that was tried."""
    try:
        yield
    except ServerFailure as failure:
        raise PerceptionError(f"{source} could not look: {failure}", kind=failure.kind.value, attempts=failure.history) from failure
