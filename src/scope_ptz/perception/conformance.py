"""Conformance checks that every perception backend must pass.

With pytest, subclass ``PerceptionConformance`` and provide the backend and a frame; each ``test_`` method is a test::

    @pytest.mark.anyio
    class TestMyPerception(PerceptionConformance):
        @asynccontextmanager
        async def perception(self):
            yield MyPerception(...)

        def frame(self):
            return Frame(...)

Without pytest, ``await TestMyPerception().findings()`` runs all checks and returns the failures.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable
from contextlib import AbstractAsyncContextManager

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points, Skill


class PerceptionConformance(ABC):
    """Checks for the ``Perception`` contract. They do not measure accuracy."""

    present: str = "thing"
    """A description of something in the frame."""
    absent: str = "purple unicorn"
    """A description of something that is not in the frame."""
    question: str | None = None
    """A question that the backend can answer from the frame; if None, the checks ask whether ``present`` is in it."""

    @abstractmethod
    def perception(self) -> AbstractAsyncContextManager[Perception]:
        """Return a context manager that provides a ready-to-use backend."""

    @abstractmethod
    def frame(self) -> Frame:
        """Return a frame that the backend can read."""

    def unreadable_frame(self) -> Frame | None:
        """Return a frame for which every call must fail; None if there is no such frame."""
        return None

    async def findings(self) -> dict[str, str]:
        """Run all checks. Return the failed ones by name, each with its reason."""
        failed = {}
        for name in sorted(n for n in dir(self) if n.startswith("test_")):
            try:
                await getattr(self, name)()
            except Exception as error:  # any exception is a failed check
                failed[name] = f"{type(error).__name__}: {error}"
        return failed

    async def test_missing_skills_raise_errors(self) -> None:
        async with self.perception() as perception:
            for skill, ask in self._calls(perception, self.frame()).items():
                if skill in perception.skills:
                    continue
                try:
                    result = await ask()
                except PerceptionError as error:
                    _expect(bool(str(error)), "the error has no message")
                else:
                    raise AssertionError(f"{skill} is not in skills, but returned {result!r} instead of raising PerceptionError")

    async def test_caption_is_text(self) -> None:
        async with self.perception() as perception:
            if "caption" not in perception.skills:
                return
            caption = await perception.caption(self.frame())
            _expect(isinstance(caption, Caption), f"caption returned a {type(caption).__name__}")
            _expect(bool(caption.text.strip()), "the caption is empty")
            self._expect_result(caption)

    async def test_query_answers(self) -> None:
        async with self.perception() as perception:
            if "query" not in perception.skills:
                return
            answer = await perception.query(self.frame(), self.question or f"Is there a {self.present}?")
            _expect(isinstance(answer, Answer), f"query returned a {type(answer).__name__}")
            _expect(bool(answer.text.strip()), "the answer is empty")
            self._expect_result(answer)

    async def test_detect_returns_boxes_inside_the_frame(self) -> None:
        async with self.perception() as perception:
            if "detect" not in perception.skills:
                return
            result = await perception.detect(self.frame(), self.present)
            _expect(isinstance(result, Detections), f"detect returned a {type(result).__name__}")
            _expect(len(result.boxes) > 0, f"nothing was found for '{self.present}', which is in the frame")
            for box in result.boxes:
                _expect(0 <= box.x_min < box.x_max <= 1 and 0 <= box.y_min < box.y_max <= 1, f"{box} is not a box inside the frame")
                _expect(box.score is None or 0 <= box.score <= 1, f"score {box.score} is not between 0 and 1")
            self._expect_result(result)

    async def test_point_returns_points_inside_the_frame(self) -> None:
        async with self.perception() as perception:
            if "point" not in perception.skills:
                return
            result = await perception.point(self.frame(), self.present)
            _expect(isinstance(result, Points), f"point returned a {type(result).__name__}")
            _expect(len(result.points) > 0, f"nothing was found for '{self.present}', which is in the frame")
            _expect(all(0 <= p.x <= 1 and 0 <= p.y <= 1 for p in result.points), "a point is outside the frame")
            self._expect_result(result)

    async def test_absent_objects_give_empty_results(self) -> None:
        async with self.perception() as perception:
            if "detect" in perception.skills:
                boxes = (await perception.detect(self.frame(), self.absent)).boxes
                _expect(boxes == (), f"'{self.absent}' was found, but is not in the frame")
            if "point" in perception.skills:
                points = (await perception.point(self.frame(), self.absent)).points
                _expect(points == (), f"'{self.absent}' was found, but is not in the frame")

    async def test_repeated_calls_return_the_same_result(self) -> None:
        async with self.perception() as perception:
            if "detect" not in perception.skills:
                return
            first, second = [(await perception.detect(self.frame(), self.present)).boxes for _ in range(2)]
            _expect(first == second, "the same frame and description gave two different results")

    async def test_failures_raise_errors(self) -> None:
        frame = self.unreadable_frame()
        if frame is None:
            return
        async with self.perception() as perception:
            for ask in self._calls(perception, frame).values():
                try:
                    result = await ask()
                except PerceptionError as error:
                    _expect(bool(str(error)), "the error has no message")
                else:
                    raise AssertionError(f"an unreadable frame returned {result!r} instead of raising PerceptionError")

    async def test_frame_is_not_changed(self) -> None:
        async with self.perception() as perception:
            frame = self.frame()
            before = frame.image.copy()
            skill = next(s for s in self._calls(perception, frame) if s in perception.skills)
            await self._calls(perception, frame)[skill]()
            _expect(bool((frame.image == before).all()), "the call changed the frame's pixels")

    def _calls(self, perception: Perception, frame: Frame) -> dict[Skill, Callable[[], Awaitable[object]]]:
        """Return one call for each skill."""
        question = self.question or "How many things are there?"
        return {
            "detect": lambda: perception.detect(frame, self.present),
            "point": lambda: perception.point(frame, self.present),
            "query": lambda: perception.query(frame, question),
            "caption": lambda: perception.caption(frame),
        }

    def _expect_result(self, result: Caption | Answer | Detections | Points) -> None:
        _expect(bool(result.source), "the result has no source")
        _expect(
            math.isfinite(result.latency_s) and result.latency_s > 0,
            f"the latency must be finite and positive; got {result.latency_s} s",
        )


def _expect(condition: bool, message: str) -> None:
    if not condition:
        raise AssertionError(message)
