"""The backends in process, through the real loading code of transformers, on tiny checkpoints."""

from __future__ import annotations

import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends import make_eyes
from scope_ptz.perception.backends.spec import EyesSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.coordinates import convention
from scope_ptz.perception.grounding import CAPTION_PROMPT, detect_prompt, point_prompt, query_prompt, sent_size
from tests.perception import pictures

pytestmark = [
    pytest.mark.full,
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::FutureWarning"),
    pytest.mark.filterwarnings("ignore::UserWarning"),
]

STYLE = convention("qwen3-vl")
QUESTION = "Is there a square?"


@pytest.fixture(scope="session")
def vision_model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from tests.full import tiny_eyes

    os.environ["HF_HUB_OFFLINE"] = "1"
    sent = sent_size(frame("nowhere"), STYLE, 1280 * 1024)
    places = {corner: tiny_eyes.found(corner) for corner in tiny_eyes.CORNERS}
    lessons = [
        (detect_prompt(STYLE, "square", sent), places),
        (point_prompt(STYLE, "square", sent), places),
        (query_prompt(QUESTION), {c: "No." if c == "nowhere" else f"Yes, {c}." for c in tiny_eyes.CORNERS}),
        (CAPTION_PROMPT, {c: f"A square: {c}." for c in tiny_eyes.CORNERS}),
    ]
    return tiny_eyes.tiny_vision_chat(tmp_path_factory.mktemp("vision"), lessons)


def frame(corner: str) -> Frame:
    from tests.full import tiny_eyes

    return pictures.frame(tiny_eyes.square(corner))


@pytest.fixture(scope="session")
def eyes(vision_model: Path) -> Perception:
    return make_eyes(EyesSpec(name="tiny", backend="transformers_local", model=str(vision_model), coordinates=STYLE.name))


@pytest.mark.anyio
@pytest.mark.parametrize("corner", ["top left", "bottom right"])
async def test_a_vision_model_in_process_sees_where_a_thing_is(eyes: Perception, corner: str) -> None:
    from tests.full import tiny_eyes

    (box,) = (await eyes.detect(frame(corner), "square")).boxes
    expected = tuple(v / 1000 for v in tiny_eyes.CORNERS[corner] or ())
    assert (box.x_min, box.y_min, box.x_max, box.y_max) == pytest.approx(expected)
    (point,) = (await eyes.point(frame(corner), "square")).points
    assert (point.x, point.y) == pytest.approx(box.centre)
    assert (await eyes.query(frame(corner), QUESTION)).text == f"Yes, {corner}."
    assert (await eyes.caption(frame(corner))).text == f"A square: {corner}."


@pytest.mark.anyio
async def test_a_vision_model_in_process_says_when_there_is_nothing(eyes: Perception) -> None:
    assert (await eyes.detect(frame("nowhere"), "square")).boxes == ()
    assert (await eyes.query(frame("nowhere"), QUESTION)).text == "No."


@pytest.mark.anyio
@pytest.mark.parametrize("maker", ["tiny_owlv2", "tiny_grounding_dino"])
class TestDetectors:
    async def test_boxes_and_points_are_in_the_frame(self, maker: str, tmp_path: Path) -> None:
        detector = self.opened(maker, tmp_path, threshold=0.0)
        found = await detector.detect(frame("top left"), "orange cone")
        assert found.boxes and found.latency_s > 0 and found.source == maker
        scores = [b.score or 0.0 for b in found.boxes]
        assert scores == sorted(scores, reverse=True)
        assert all(0 <= b.x_min < b.x_max <= 1 and 0 <= b.y_min < b.y_max <= 1 for b in found.boxes)
        assert len((await detector.point(frame("top left"), "orange cone")).points) == len(found.boxes)

    async def test_nothing_above_the_threshold_is_nothing(self, maker: str, tmp_path: Path) -> None:
        assert (await self.opened(maker, tmp_path, threshold=1.0).detect(frame("top left"), "cone")).boxes == ()

    def opened(self, maker: str, folder: Path, threshold: float) -> Perception:
        from tests.full import tiny_eyes

        model = str(getattr(tiny_eyes, maker)(folder))
        return make_eyes(EyesSpec(name=maker, backend="zero_shot", model=model, options={"threshold": threshold}))


@pytest.mark.anyio
@pytest.mark.parametrize("backend", ["zero_shot", "transformers_local"])
async def test_a_model_that_is_not_there_is_an_error(backend: str, tmp_path: Path) -> None:
    eyes = make_eyes(EyesSpec(name="eyes", backend=backend, model=str(tmp_path / "nowhere")))
    with pytest.raises(PerceptionError):
        await eyes.detect(frame("top left"), "square")


@pytest.mark.anyio
class TestTinyVisionModel(PerceptionConformance):
    present, absent, question = "square", "square", QUESTION

    @pytest.fixture(autouse=True)
    def _opened(self, eyes: Perception) -> None:
        self.eyes = eyes

    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield self.eyes

    def frame(self) -> Frame:
        return frame("bottom right")

    async def test_absent_things_are_an_empty_list(self) -> None:
        """The tiny model knows one thing only, so it is shown a picture without it."""
        assert (await self.eyes.detect(frame("nowhere"), self.absent)).boxes == ()
