"""A router that combines perception backends: a reader for text, a detector for boxes and points, and an answerer for questions.

For each call, the backends are ordered, and the first usable result is returned. With ``compare``, the first two backends are
called concurrently, and the agreement between them is recorded. Without it, a backend is called only if no earlier backend returned
a usable result.
"""

from __future__ import annotations

import re
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Generic, TypeVar

import anyio

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Agreement, Answer, Box, Caption, Detections, Perception, Points, Skill
from scope_ptz.perception.models.text_requests import is_reading_request, reading_target, requested_texts
from scope_ptz.perception.models.tile_geometry import iou

ANY_TEXT = "text"
"""The description for which a reader returns a box, labelled with the text, for every text in view."""

SAME_BOX_IOU = 0.4
"""Boxes from two backends count as the same if their intersection over union is at least this."""

SAME_POINT = 0.05
"""Points from two backends count as the same if they differ by at most this fraction of the frame's width and height."""

R = TypeVar("R", Caption, Answer, Detections, Points)
PerceptionCall = Callable[[Perception], Awaitable[R]]
AgreementMeasure = Callable[[R, R], float]


@dataclass
class _CallOutcome(Generic[R]):
    """The outcome of a call to one backend. Result and error are None if the backend was not called."""

    backend: Perception
    result: R | None = None
    error: PerceptionError | None = None

    @property
    def usable(self) -> bool:
        """Whether the backend returned a result other than "I cannot tell"."""
        return self.result is not None and (not isinstance(self.result, Answer) or self.result.known)


class RouterPerception(Perception):
    """A backend that combines one to three other backends."""

    handles_panoramas = True

    def __init__(
        self,
        *,
        reader: Perception | None = None,
        detector: Perception | None = None,
        answerer: Perception | None = None,
        compare: bool = True,
        name: str = "router",
    ) -> None:
        self.name, self._compare = name, compare
        self._reader, self._detector, self._answerer = reader, detector, answerer
        parts = self._backends_with_skill(reader, detector, answerer)
        self.skills = frozenset[Skill](skill for part in parts for skill in part.skills)

    async def caption(self, frame: Frame) -> Caption:
        order = self._backends_with_skill(self._answerer, self._reader, skill="caption")
        return await self._first_usable(order, lambda backend: backend.caption(frame), _word_agreement, compare=False)

    async def query(self, frame: Frame, question: str) -> Answer:
        if not is_reading_request(question) or self._reader is None:
            order = self._backends_with_skill(self._answerer, skill="query")
            return await self._first_usable(order, lambda backend: backend.query(frame, question), _word_agreement)

        async def call(backend: Perception) -> Answer:
            return await (self._read(frame, question) if backend is self._reader else backend.query(frame, question))

        order = self._backends_with_skill(self._reader, self._answerer, skill="query")
        return await self._first_usable(order, call, _word_agreement)

    async def detect(self, frame: Frame, description: str) -> Detections:
        order = self._finders(description, "detect")
        return await self._first_usable(order, lambda backend: backend.detect(frame, description), _box_agreement)

    async def point(self, frame: Frame, description: str) -> Points:
        order = self._finders(description, "point")
        return await self._first_usable(order, lambda backend: backend.point(frame, description), _point_agreement)

    async def close(self) -> None:
        for part in self._backends_with_skill(self._reader, self._detector, self._answerer):
            await part.close()

    def _backends_with_skill(self, *parts: Perception | None, skill: Skill | None = None) -> list[Perception]:
        """Return the given backends that have a skill, without None and duplicates."""
        capable = [p for p in parts if p is not None and (skill is None or skill in p.skills)]
        return list(dict.fromkeys(capable))

    def _finders(self, description: str, skill: Skill) -> list[Perception]:
        is_text = requested_texts(description) is not None
        return self._backends_with_skill(self._reader if is_text else None, self._detector, self._answerer, skill=skill)

    async def _read(self, frame: Frame, question: str) -> Answer:
        """Return the text on the object that the question names if another backend finds it, otherwise all text in view."""
        assert self._reader is not None  # noqa: S101
        target = reading_target(question)
        finders = self._backends_with_skill(self._detector, self._answerer, skill="detect")
        if target is None or not finders:
            return await self._reader.query(frame, question)
        began = perf_counter()
        all_texts, targets = await _await_both(self._reader.query(frame, question), finders[0].detect(frame, target))
        if isinstance(all_texts, PerceptionError):
            raise all_texts
        if isinstance(targets, PerceptionError) or not targets.boxes:
            note = f"{finders[0].name} did not find '{target}'; all text in view is given."
            return all_texts.model_copy(update={"notes": (*all_texts.notes, note)})
        lines = (await self._reader.detect(frame, ANY_TEXT)).boxes
        texts = [line.label or "" for line in lines if any(_contains_centre(box, line) for box in targets.boxes)]
        if not texts:
            note = f"No readable text is on '{target}'; all text in view is given."
            return all_texts.model_copy(update={"notes": (*all_texts.notes, note)})
        text = "It reads: " + ", ".join(f'"{t}"' for t in texts) + "."
        attempts = all_texts.attempts + targets.attempts
        return all_texts.model_copy(update={"text": text, "attempts": attempts, "latency_s": perf_counter() - began})

    async def _first_usable(
        self, order: Sequence[Perception], call: PerceptionCall[R], agreement: AgreementMeasure[R], *, compare: bool = True
    ) -> R:
        if not order:
            raise PerceptionError(f"None of the backends of {self.name} supports this call.")
        began = perf_counter()
        outcomes = [_CallOutcome[R](backend) for backend in order]
        first = outcomes[: 2 if self._compare and compare else 1]
        async with anyio.create_task_group() as group:
            for outcome in first:
                group.start_soon(_ask, outcome, call)
        for outcome in outcomes[len(first) :]:
            if any(o.usable for o in outcomes):
                break
            await _ask(outcome, call)
        return self._best_result(outcomes, agreement, perf_counter() - began)

    def _best_result(self, outcomes: Sequence[_CallOutcome[R]], agreement: AgreementMeasure[R], latency_s: float) -> R:
        """Return the first usable result, compared with the second. If all backends failed, raise an error with all reasons."""
        attempts = tuple(a for o in outcomes for a in _attempts(o))
        failed = [(o.backend.name, o.error) for o in outcomes if o.error is not None]
        results = [o.result for o in outcomes if o.result is not None]
        ranked = [o.result for o in outcomes if o.usable and o.result is not None] or results
        if not ranked:
            message = " ".join(dict.fromkeys(str(error) for _, error in failed))
            raise PerceptionError(message, kind=failed[0][1].kind, attempts=attempts)
        best = ranked[0]
        failures = tuple(f"{name} failed: {error}" for name, error in failed)
        update: dict[str, Any] = {"notes": best.notes + failures, "attempts": attempts, "latency_s": latency_s}
        if other := next((r for r in results if r is not best), None):
            update["agreement"] = Agreement(other=other.source, said=_summary(other), share=agreement(best, other))
        return best.model_copy(update=update)


async def _ask(outcome: _CallOutcome[R], call: PerceptionCall[R]) -> None:
    try:
        outcome.result = await call(outcome.backend)
    except PerceptionError as error:
        outcome.error = error


async def _await_both(
    one: Awaitable[Answer], other: Awaitable[Detections]
) -> tuple[Answer | PerceptionError, Detections | PerceptionError]:
    """Run two perception calls concurrently. Errors are returned, not raised."""
    results: dict[int, Any] = {}

    async def run(index: int, call: Awaitable[Any]) -> None:
        try:
            results[index] = await call
        except PerceptionError as error:
            results[index] = error

    async with anyio.create_task_group() as group:
        group.start_soon(run, 0, one)
        group.start_soon(run, 1, other)
    return results[0], results[1]


def _attempts(outcome: _CallOutcome[Any]) -> tuple[Any, ...]:
    if outcome.error is not None:
        return tuple(outcome.error.attempts)
    return outcome.result.attempts if outcome.result is not None else ()


def _summary(result: Caption | Answer | Detections | Points) -> str:
    if isinstance(result, Detections):
        return f"{len(result.boxes)} found"
    return f"{len(result.points)} found" if isinstance(result, Points) else result.text[:300]


def _contains_centre(box: Box, line: Box) -> bool:
    x, y = line.centre
    return box.x_min <= x <= box.x_max and box.y_min <= y <= box.y_max


def _word_agreement(a: Caption | Answer, b: Caption | Answer) -> float:
    """Return the fraction of words in the shorter text that also occur in the other text. Stop words are ignored."""
    one, other = (set(re.findall(r"\w+", x.text.casefold())) - _STOP_WORDS for x in (a, b))
    if not one or not other:
        return float(one == other)
    return len(one & other) / min(len(one), len(other))


_STOP_WORDS = {"a", "an", "the", "it", "is", "are", "says", "reads", "sign", "text", "of", "on", "in", "and", "to", "there"}


def _box_agreement(a: Detections, b: Detections) -> float:
    return _paired_fraction(a.boxes, b.boxes, lambda x, y: iou(x, y) >= SAME_BOX_IOU)


def _point_agreement(a: Points, b: Points) -> float:
    return _paired_fraction(a.points, b.points, lambda p, q: abs(p.x - q.x) <= SAME_POINT and abs(p.y - q.y) <= SAME_POINT)


_Location = TypeVar("_Location")


def _paired_fraction(
    first: Sequence[_Location], second: Sequence[_Location], is_same: Callable[[_Location, _Location], bool]
) -> float:
    """Return the fraction of all boxes or points that can be paired one to one. Two empty results agree fully."""
    unpaired, pairs = list(second), 0
    for one in first:
        partner = next((i for i, other in enumerate(unpaired) if is_same(one, other)), None)
        if partner is not None:
            unpaired.pop(partner)
            pairs += 1
    return 2 * pairs / (len(first) + len(second)) if first or second else 1.0
