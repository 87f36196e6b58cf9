"""Routing between backends, replacement of failed backends, and agreement of two backends."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import anyio
import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import ConfigError, PerceptionError
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import ALL_SKILLS, Answer, Box, Caption, Detections, Perception, Point, Points, Skill
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.models.routing import RouterPerception
from tests.perception import pictures


class FixedPerception(Perception):
    """Perception with fixed results that records its requests."""

    def __init__(
        self,
        name: str,
        skills: frozenset[Skill] = ALL_SKILLS,
        *,
        boxes: tuple[Box, ...] = (),
        text: str = "yes",
        known: bool = True,
        broken: bool = False,
        wait_s: float = 0.0,
    ) -> None:
        self.name, self.skills = name, skills
        self.boxes, self.text, self.known, self.broken, self.wait_s = boxes, text, known, broken, wait_s
        self.requests: list[str] = []
        self.closed = False

    async def _record(self, request: str) -> tuple[Attempt, ...]:
        self.requests.append(request)
        await anyio.sleep(self.wait_s)
        if self.broken:
            failed = Attempt(kind=FailureKind.SERVER_ERROR)
            raise PerceptionError(f"{self.name} is broken", kind="server-error", attempts=(failed,))
        return (Attempt(),)

    async def caption(self, frame: Frame) -> Caption:
        return Caption(text=self.text, source=self.name, attempts=await self._record("caption"), latency_s=0.1)

    async def query(self, frame: Frame, question: str) -> Answer:
        attempts = await self._record(f"query {question}")
        return Answer(text=self.text, known=self.known, source=self.name, attempts=attempts, latency_s=0.1)

    async def detect(self, frame: Frame, description: str) -> Detections:
        attempts = await self._record(f"detect {description}")
        boxes = () if "unicorn" in description else self.boxes
        return Detections(boxes=boxes, source=self.name, attempts=attempts, latency_s=0.1)

    async def point(self, frame: Frame, description: str) -> Points:
        attempts = await self._record(f"point {description}")
        boxes = () if "unicorn" in description else self.boxes
        points = tuple(Point(x=b.centre[0], y=b.centre[1]) for b in boxes)
        return Points(points=points, source=self.name, attempts=attempts, latency_s=0.1)

    async def close(self) -> None:
        self.closed = True


def box(x: float, y: float = 0.1, label: str | None = None) -> Box:
    return Box(x_min=x, y_min=y, x_max=x + 0.2, y_max=y + 0.2, label=label)


FIND_SKILLS = frozenset[Skill](("detect", "point"))
FRAME = pictures.frame()


@pytest.mark.anyio
class TestRouter(PerceptionConformance):
    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield RouterPerception(
            reader=FixedPerception("ocr"),
            detector=FixedPerception("owl", FIND_SKILLS, boxes=(box(0.1),)),
            answerer=FixedPerception("vlm", boxes=(box(0.1),)),
        )

    def frame(self) -> Frame:
        return pictures.frame()


@pytest.mark.anyio
async def test_each_question_type_goes_to_its_backend() -> None:
    ocr, owl, vlm = FixedPerception("ocr"), FixedPerception("owl", FIND_SKILLS, boxes=(box(0.1),)), FixedPerception("vlm")
    router = RouterPerception(reader=ocr, detector=owl, answerer=vlm, compare=False)
    assert (await router.query(FRAME, "what colour is the door?")).source == "vlm"
    assert (await router.query(FRAME, "read the text")).source == "ocr"
    assert (await router.detect(FRAME, "cone")).source == "owl"
    assert (await router.point(FRAME, "cone")).source == "owl"
    assert (await router.detect(FRAME, 'the text "EXIT"')).source == "ocr"
    assert (await router.caption(FRAME)).source == "vlm"
    assert ocr.requests == ["query read the text", 'detect the text "EXIT"']
    assert vlm.requests == ["query what colour is the door?", "caption"]


@pytest.mark.anyio
async def test_two_backends_are_asked_at_once_and_their_agreement_is_recorded() -> None:
    owl = FixedPerception("owl", FIND_SKILLS, boxes=(box(0.1), box(0.5)), wait_s=0.2)
    vlm = FixedPerception("vlm", boxes=(box(0.11),), wait_s=0.2)
    with anyio.fail_after(0.35):
        found = await RouterPerception(detector=owl, answerer=vlm).detect(FRAME, "cone")
    assert found.source == "owl" and len(found.boxes) == 2
    assert found.agreement is not None
    assert (found.agreement.other, found.agreement.said, found.agreement.agrees) == ("vlm", "1 found", True)
    assert found.agreement.share == pytest.approx(2 / 3)
    assert len(found.attempts) == 2


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("mine", "other", "share"),
    [
        ((), (), 1.0),
        ((box(0.1),), (), 0.0),
        ((box(0.1), box(0.1, 0.7)), (box(0.6),), 0.0),
        ((box(0.1),), (box(0.1), box(0.12)), 2 / 3),
    ],
)
async def test_agreement_on_locations(mine: tuple[Box, ...], other: tuple[Box, ...], share: float) -> None:
    router = RouterPerception(
        detector=FixedPerception("owl", FIND_SKILLS, boxes=mine), answerer=FixedPerception("vlm", boxes=other)
    )
    for found in (await router.detect(FRAME, "cone"), await router.point(FRAME, "cone")):
        assert found.agreement is not None and found.agreement.share == pytest.approx(share)


@pytest.mark.anyio
async def test_the_next_backend_replaces_a_failed_one_with_a_note() -> None:
    owl, vlm = FixedPerception("owl", FIND_SKILLS, broken=True), FixedPerception("vlm", boxes=(box(0.3),))
    for compare in (True, False):
        found = await RouterPerception(detector=owl, answerer=vlm, compare=compare).detect(FRAME, "cone")
        assert found.source == "vlm" and found.notes == ("owl failed: owl is broken",)
        assert [a.kind for a in found.attempts] == ["server-error", None] and found.agreement is None


@pytest.mark.anyio
async def test_when_all_backends_fail_the_error_has_all_attempts() -> None:
    router = RouterPerception(
        detector=FixedPerception("owl", FIND_SKILLS, broken=True), answerer=FixedPerception("vlm", broken=True)
    )
    with pytest.raises(PerceptionError, match=r"owl is broken vlm is broken") as caught:
        await router.detect(FRAME, "cone")
    assert caught.value.kind == "server-error" and len(caught.value.attempts) == 2


@pytest.mark.anyio
async def test_the_model_answers_when_the_reader_finds_no_text() -> None:
    ocr, vlm = FixedPerception("ocr", text="nothing", known=False), FixedPerception("vlm", text="EXIT 14")
    answer = await RouterPerception(reader=ocr, answerer=vlm, compare=False).query(FRAME, "read the text")
    assert (answer.source, answer.text) == ("vlm", "EXIT 14")
    alone = await RouterPerception(reader=ocr).query(FRAME, "read the text")
    assert not alone.known


@pytest.mark.anyio
async def test_only_text_on_the_named_object_is_read() -> None:
    ocr = FixedPerception("ocr", text="everything", boxes=(box(0.15, 0.1, "EXIT"), box(0.6, 0.6, "CAFE")))
    owl = FixedPerception("owl", FIND_SKILLS, boxes=(Box(x_min=0.1, y_min=0.0, x_max=0.4, y_max=0.4),))
    router = RouterPerception(reader=ocr, detector=owl, answerer=FixedPerception("vlm", text="The sign says exit."))
    answer = await router.query(FRAME, "what does the gantry sign say?")
    assert answer.text == 'It reads: "EXIT".'
    assert owl.requests == ["detect gantry sign"]
    assert answer.agreement is not None and answer.agreement.share == 1.0


@pytest.mark.anyio
async def test_a_sign_that_is_not_found_is_noted_and_all_text_is_given() -> None:
    ocr = FixedPerception("ocr", text='It reads: "CAFE".', boxes=(box(0.6, 0.6, "CAFE"),))
    for owl in (
        FixedPerception("owl", FIND_SKILLS),
        FixedPerception("owl", FIND_SKILLS, broken=True),
        FixedPerception("owl", FIND_SKILLS, boxes=(box(0.0),)),
    ):
        answer = await RouterPerception(reader=ocr, detector=owl).query(FRAME, "what does the gantry sign say?")
        assert answer.text == 'It reads: "CAFE".' and "gantry sign" in answer.notes[0]


@pytest.mark.anyio
async def test_a_skill_that_no_part_has_is_an_error() -> None:
    router = RouterPerception(detector=FixedPerception("owl", FIND_SKILLS))
    assert router.skills == FIND_SKILLS
    with pytest.raises(PerceptionError, match="None of the backends"):
        await router.query(FRAME, "what colour is the door?")


@pytest.mark.anyio
async def test_all_parts_are_closed_once() -> None:
    one = FixedPerception("vlm")
    await RouterPerception(detector=one, answerer=one).close()
    assert one.closed


def test_a_router_is_created_from_a_spec() -> None:
    endpoint = {"url": "http://127.0.0.1:9/v1", "model": "m"}
    parts = {
        "answerer": {"name": "vlm", "backend": "openai_vision", "endpoint": endpoint},
        "reader": {"name": "ocr", "backend": "ocr"},
    }
    router = make_backend(BackendSpec(name="composed", backend="router", options=parts))
    assert isinstance(router, RouterPerception) and router.name == "composed" and router.skills == ALL_SKILLS
    with pytest.raises(ConfigError, match="combines no backends"):
        make_backend(BackendSpec(name="composed", backend="router"))
