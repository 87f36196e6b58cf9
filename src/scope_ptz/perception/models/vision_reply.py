"""Convert the replies of vision-language models, served or local, to perception results."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Point, Points
from scope_ptz.perception.models.coordinates import Convention, ReplyPlaces, places_in_frame
from scope_ptz.perception.models.encoding import Size
from scope_ptz.perception.models.reply_parsing import cannot_tell, excerpt, read_answer, read_places

MAX_RAW_CHARS = 20_000
"""Longer replies are truncated in the trace."""


class VisionReply:
    """A model's reply about one frame, which can be converted to each type of perception result.

    Results and errors include the ``attempts`` of the call. If the reply cannot be parsed, its last attempt is recorded as a
    failure.
    """

    def __init__(self, source: str, text: str, began: float, attempts: tuple[Attempt, ...] = (), *, cut: bool = False) -> None:
        """Set up the reply.

        Args:
            source: The name of the backend.
            text: The text of the reply.
            began: The start of the call, as a value of ``perf_counter``.
            attempts: The requests of the call.
            cut: Whether the reply stopped at the token limit.
        """
        self.source, self.text, self.attempts, self.cut, self._began = source, text, attempts, cut, began

    def with_earlier_attempts(self, error: PerceptionError) -> VisionReply:
        """Return the same reply with the attempts of an earlier failure added before its own."""
        earlier = tuple(a for a in error.attempts if isinstance(a, Attempt))
        return VisionReply(self.source, self.text, self._began, (*earlier, *self.attempts), cut=self.cut)

    def caption(self) -> Caption:
        """Return the reply as a caption."""
        with reply_errors(self.source, self.attempts):
            return Caption(text=read_answer(self.text), **self._common(self._truncation_note()))

    def answer(self) -> Answer:
        """Return the reply as an answer."""
        with reply_errors(self.source, self.attempts):
            text = read_answer(self.text)
        return Answer(text=text, known=not cannot_tell(text), **self._common(self._truncation_note()))

    def _truncation_note(self) -> tuple[str, ...]:
        return ("The answer was cut off at the token limit.",) if self.cut else ()

    def detections(self, convention: Convention, sent: Size) -> Detections:
        """Return the boxes in the reply."""
        places, complete, notes = self._places(convention, sent)
        if places.points and not places.boxes:
            raise self.unreadable("points instead of boxes")
        return Detections(boxes=places.boxes, complete=complete, **self._common(notes))

    def points(self, convention: Convention, sent: Size) -> Points:
        """Return the points in the reply, or the centres of its boxes."""
        places, complete, notes = self._places(convention, sent)
        points = places.points or tuple(Point(x=b.centre[0], y=b.centre[1], label=b.label) for b in places.boxes)
        return Points(points=points, complete=complete, **self._common(notes))

    def _places(self, convention: Convention, sent: Size) -> tuple[ReplyPlaces, bool, tuple[str, ...]]:
        with reply_errors(self.source, self.attempts):
            parsed = read_places(self.text)
            places = places_in_frame(parsed.things, convention, sent)
        complete = parsed.complete and not (self.cut and places.boxes + places.points)
        notes = () if complete else ("The reply was cut off: there may be more.",)
        return places, places.complete and complete, places.notes + notes

    def unreadable(self, content: str) -> PerceptionError:
        """Return the error for a reply that cannot be parsed. ``content`` describes what the reply contains."""
        kind = FailureKind.MALFORMED
        return PerceptionError(
            f"{self.source} returned {content}: {excerpt(self.text)}", kind=kind.value, attempts=_with_kind(self.attempts, kind)
        )

    def _common(self, notes: tuple[str, ...] = ()) -> dict[str, Any]:
        raw = self.text if len(self.text) <= MAX_RAW_CHARS else self.text[:MAX_RAW_CHARS] + "…"
        latency_s = perf_counter() - self._began
        return {"source": self.source, "raw": raw, "latency_s": latency_s, "notes": notes, "attempts": self.attempts}


@contextmanager
def reply_errors(source: str, attempts: tuple[Attempt, ...]) -> Iterator[None]:
    """Prefix errors about a reply with the name of the source, and record them as failures of the last attempt."""
    try:
        yield
    except PerceptionError as error:
        kind = FailureKind(error.kind) if error.kind is not None else None
        failed_attempts = _with_kind(attempts, kind) if kind is not None else attempts
        raise PerceptionError(f"{source}: {error}", kind=error.kind, attempts=failed_attempts) from error


def _with_kind(attempts: tuple[Attempt, ...], kind: FailureKind) -> tuple[Attempt, ...]:
    return (*attempts[:-1], attempts[-1].model_copy(update={"kind": kind})) if attempts else ()


@contextmanager
def server_errors(source: str) -> Iterator[None]:
    """Turn a server's failure into a ``PerceptionError`` with its kind and all attempts."""
    try:
        yield
    except ServerFailure as failure:
        raise PerceptionError(f"{source} failed: {failure}", kind=failure.kind.value, attempts=failure.history) from failure
