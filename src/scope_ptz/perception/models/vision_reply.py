"""Convert replies from vision-language models, served or local, to perception results."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any

from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Point, Points
from scope_ptz.perception.models.coordinates import Convention, ReplyLocations, locations_in_frame
from scope_ptz.perception.models.encoding import Size
from scope_ptz.perception.models.reply_parsing import excerpt, is_unknown_answer, parse_answer, parse_locations

MAX_RAW_CHARS = 20_000
"""Longer replies are truncated in the trace."""


class VisionReply:
    """A model's reply about one frame, which can be converted to each type of perception result.

    Results and errors include the ``attempts`` of the call. If the reply cannot be parsed, its last attempt is recorded as a
    failure.
    """

    def __init__(
        self, source: str, text: str, began: float, attempts: tuple[Attempt, ...] = (), *, truncated: bool = False
    ) -> None:
        """Set up the reply.

        Args:
            source: The name of the backend.
            text: The text of the reply.
            began: When the call started, as a ``perf_counter`` value.
            attempts: The call's requests.
            truncated: Whether the reply stopped at the token limit.
        """
        self.source, self.text, self.attempts, self.truncated, self._began = source, text, attempts, truncated, began

    def with_earlier_attempts(self, error: PerceptionError) -> VisionReply:
        """Return the same reply with the attempts of an earlier failure added before its own."""
        earlier = tuple(a for a in error.attempts if isinstance(a, Attempt))
        return VisionReply(self.source, self.text, self._began, (*earlier, *self.attempts), truncated=self.truncated)

    def caption(self) -> Caption:
        """Return the reply as a caption."""
        with reply_errors(self.source, self.attempts):
            return Caption(text=parse_answer(self.text), **self._common(self._truncation_note()))

    def answer(self) -> Answer:
        """Return the reply as an answer."""
        with reply_errors(self.source, self.attempts):
            text = parse_answer(self.text)
        return Answer(text=text, known=not is_unknown_answer(text), **self._common(self._truncation_note()))

    def _truncation_note(self) -> tuple[str, ...]:
        return ("The answer was cut off at the token limit.",) if self.truncated else ()

    def detections(self, convention: Convention, image_size: Size) -> Detections:
        """Return the boxes in the reply."""
        locations, complete, notes = self._locations(convention, image_size)
        if locations.points and not locations.boxes:
            raise self.parse_error("points instead of boxes")
        return Detections(boxes=locations.boxes, complete=complete, **self._common(notes))

    def points(self, convention: Convention, image_size: Size) -> Points:
        """Return the points in the reply, or the centres of its boxes."""
        locations, complete, notes = self._locations(convention, image_size)
        points = locations.points or tuple(Point(x=b.centre[0], y=b.centre[1], label=b.label) for b in locations.boxes)
        return Points(points=points, complete=complete, **self._common(notes))

    def _locations(self, convention: Convention, image_size: Size) -> tuple[ReplyLocations, bool, tuple[str, ...]]:
        with reply_errors(self.source, self.attempts):
            parsed = parse_locations(self.text)
            locations = locations_in_frame(parsed.locations, convention, image_size)
        complete = parsed.complete and not (self.truncated and locations.boxes + locations.points)
        notes = () if complete else ("The reply was cut off: there may be more.",)
        return locations, locations.complete and complete, locations.notes + notes

    def parse_error(self, content: str) -> PerceptionError:
        """Return the error for a reply that cannot be parsed. ``content`` describes what the reply contains."""
        kind = FailureKind.MALFORMED
        return PerceptionError(
            f"{self.source} returned {content}: {excerpt(self.text)}", kind=kind.value, attempts=_set_last_kind(self.attempts, kind)
        )

    def _common(self, notes: tuple[str, ...] = ()) -> dict[str, Any]:
        raw = self.text if len(self.text) <= MAX_RAW_CHARS else self.text[:MAX_RAW_CHARS] + "…"
        latency_s = perf_counter() - self._began
        return {"source": self.source, "raw": raw, "latency_s": latency_s, "notes": notes, "attempts": self.attempts}


@contextmanager
def reply_errors(source: str, attempts: tuple[Attempt, ...]) -> Iterator[None]:
    """Prefix errors about a reply with the source's name, and record them as failures of the last attempt."""
    try:
        yield
    except PerceptionError as error:
        kind = FailureKind(error.kind) if error.kind is not None else None
        failed_attempts = _set_last_kind(attempts, kind) if kind is not None else attempts
        raise PerceptionError(f"{source}: {error}", kind=error.kind, attempts=failed_attempts) from error


def _set_last_kind(attempts: tuple[Attempt, ...], kind: FailureKind) -> tuple[Attempt, ...]:
    return (*attempts[:-1], attempts[-1].model_copy(update={"kind": kind})) if attempts else ()


@contextmanager
def server_errors(source: str) -> Iterator[None]:
    """Convert a server's failure to a ``PerceptionError`` with the failure kind and all attempts."""
    try:
        yield
    except ServerFailure as failure:
        raise PerceptionError(f"{source} failed: {failure}", kind=failure.kind.value, attempts=failure.history) from failure
