"""OCR on the pixels of a real camera's frame, with the reader from the extra."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import numpy as np
import pytest

from scope_ptz.camera.base import Frame
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends import make_backend, ocr
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Box, Perception
from scope_ptz.perception.conformance import PerceptionConformance
from scope_ptz.perception.models.frame_memo import Image
from tests.perception import pictures


@pytest.fixture(scope="module")
def perception_backend() -> Perception:
    return make_backend(BackendSpec(name="ocr", backend="ocr"))


BOARD = pictures.board(("EXIT 14", 60, 90), ("Airport", 380, 90), ("SITE OFFICE", 60, 270))


@pytest.mark.full
@pytest.mark.anyio
class TestOcr(PerceptionConformance):
    present = 'the text "EXIT 14"'
    absent = 'the text "purple unicorn"'
    question = "what does the board say?"
    engine = ocr.RapidOcr()

    @asynccontextmanager
    async def perception(self) -> AsyncIterator[Perception]:
        yield ocr.OcrPerception(self.engine)

    def frame(self) -> Frame:
        return BOARD


@pytest.mark.full
@pytest.mark.anyio
async def test_text_is_read_row_by_row(perception_backend: Perception) -> None:
    answer = await perception_backend.query(BOARD, "read the text")
    assert answer.known
    assert answer.text.replace(" ", "") == 'Itreads:"EXIT14","Airport","SITEOFFICE".'
    assert "EXIT" in (await perception_backend.caption(BOARD)).text


@pytest.mark.anyio
async def test_a_text_is_found_where_it_is(perception_backend: Perception) -> None:
    (box,) = (await perception_backend.detect(BOARD, "the sign that says Airport")).boxes
    assert 0.55 < box.x_min < 0.62 and 0.8 < box.x_max < 0.95 and 0.1 < box.y_min < box.y_max < 0.3
    assert box.label == "Airport" and box.score is not None and box.score > 0.8
    (point,) = (await perception_backend.point(BOARD, '"site office"')).points
    assert 0.1 < point.x < 0.5 and 0.6 < point.y < 0.8


@pytest.mark.full
@pytest.mark.anyio
async def test_a_wall_without_text_gives_no_texts_and_no_answer(perception_backend: Perception) -> None:
    frame = pictures.frame()
    answer = await perception_backend.query(frame, "what does it say?")
    assert not answer.known and "no readable text" in answer.text
    assert (await perception_backend.detect(frame, "text")).boxes == ()


@pytest.mark.anyio
@pytest.mark.parametrize("description", ["traffic cone", "cars", "sign"])
async def test_descriptions_of_other_objects_are_errors(perception_backend: Perception, description: str) -> None:
    for look in (perception_backend.detect, perception_backend.point):
        with pytest.raises(PerceptionError, match="only finds text"):
            await look(BOARD, description)
    with pytest.raises(PerceptionError, match="only reads text"):
        await perception_backend.query(BOARD, f"how many of these are there: {description}?")


def line(text: str, x: float, y: float) -> ocr.Line:
    return ocr.Line(text, Box(x_min=x, y_min=y, x_max=x + 0.1, y_max=y + 0.05, label=text, score=0.9))


@pytest.mark.anyio
async def test_a_frame_is_read_once() -> None:
    seen: list[tuple[int, ...]] = []

    def reader(image: Image) -> list[ocr.Line]:
        seen.append(image.shape)
        return [line("EXIT", 0.1, 0.1)]

    perception_backend, frame = ocr.OcrPerception(reader), pictures.frame()
    for _ in range(2):
        await perception_backend.query(frame, "read it")
        await perception_backend.detect(frame, "text")
    assert len(seen) == 1
    await perception_backend.caption(pictures.frame())
    assert len(seen) == 2


@pytest.mark.anyio
async def test_panoramas_are_read_in_parts_without_duplicates() -> None:
    """A reader that finds one text where a column is bright."""

    def reader(image: Image) -> list[ocr.Line]:
        columns = np.flatnonzero(image[:, :, 0].max(axis=0) > 200)
        if not len(columns):
            return []
        x, width = columns[0] / image.shape[1], len(columns) / image.shape[1]
        return [ocr.Line("SIGN", Box(x_min=x, y_min=0.4, x_max=x + width, y_max=0.6, label="SIGN", score=0.9))]

    for at in (10, 380, 700, 1500, 1930):
        image = np.zeros((300, 2000, 3), np.uint8)
        image[:, at : at + 40] = 255
        (found,) = (await ocr.OcrPerception(reader).detect(pictures.frame(image), "text")).boxes
        assert found.x_min * 2000 == pytest.approx(at, abs=1) and found.x_max * 2000 == pytest.approx(at + 40, abs=1)


@pytest.mark.anyio
async def test_a_failing_reader_is_an_error() -> None:
    def reader(image: Image) -> list[ocr.Line]:
        raise RuntimeError("onnxruntime is out of memory")

    with pytest.raises(PerceptionError, match="out of memory"):
        await ocr.OcrPerception(reader).query(pictures.frame(), "read it")


def test_quotes_within_texts_are_replaced() -> None:
    assert ocr.quote_lines([line('say "hi"', 0.1, 0.1)]) == "\"say 'hi'\""
