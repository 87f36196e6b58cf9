"""Tiled panoramas: every object is found once, at the resolution of a frame."""

from __future__ import annotations

from itertools import pairwise

import anyio
import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import PerceptionError
from scope_ptz.geometry import Equirectangular, Pose
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Answer, Box, Caption, Detections, Perception, Point, Points
from scope_ptz.perception.models.tile_geometry import OVERLAP, TILE_ASPECT, iou, non_maximum_suppression, tiles
from scope_ptz.perception.models.tiled_panoramas import TiledPerception
from tests.perception import pictures

HEIGHT, WIDTH = 200, 1600


class Blobs(Perception):
    """Perception that finds white blobs as boxes clipped at the edges of the picture."""

    name = "blobs"

    def __init__(self, *, fails_on: int | None = None) -> None:
        self.shown: list[tuple[int, int]] = []
        self.spans: list[float] = []
        self.at_once = self.max_concurrent = 0
        self.fails_on = fails_on

    async def _boxes(self, frame: Frame) -> tuple[Box, ...]:
        self.shown.append((frame.width, frame.height))
        self.spans.append(frame.hfov_deg)
        number = len(self.shown)
        self.at_once += 1
        self.max_concurrent = max(self.max_concurrent, self.at_once)
        await anyio.sleep(0.01)
        self.at_once -= 1
        if self.fails_on == number:
            raise PerceptionError("blobs is tired", kind="server-error", attempts=(Attempt(kind=FailureKind.SERVER_ERROR),))
        _, _, stats, _ = cv2.connectedComponentsWithStats((frame.image[:, :, 0] > 200).astype(np.uint8))
        w, h = frame.width, frame.height
        return tuple(
            Box(x_min=x / w, y_min=y / h, x_max=(x + wide) / w, y_max=(y + high) / h) for x, y, wide, high, _ in stats[1:].tolist()
        )

    async def caption(self, frame: Frame) -> Caption:
        return Caption(text=f"{frame.width} wide", source=self.name)

    async def query(self, frame: Frame, question: str) -> Answer:
        return Answer(text=f"{frame.width} wide", source=self.name)

    async def detect(self, frame: Frame, description: str) -> Detections:
        return Detections(boxes=await self._boxes(frame), source=self.name, attempts=(Attempt(),), notes=("as seen",))

    async def point(self, frame: Frame, description: str) -> Points:
        points = tuple(Point(x=b.centre[0], y=b.centre[1]) for b in await self._boxes(frame))
        return Points(points=points, source=self.name, attempts=(Attempt(),))


def panorama(*spans: tuple[int, int], full_turn: bool = False) -> Frame:
    """White blobs from column to column, at middle height."""
    image = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
    for left, right in spans:
        image[80:120, left:right] = 255
    pan = 360.0 if full_turn else 280.0
    projection = Equirectangular(-pan / 2, pan, 20.0, -15.0, WIDTH, HEIGHT)
    return Frame(image, Pose(0.0, 0.0, 1.0), pan, 0.0, projection)


@given(st.integers(1, 9000), st.integers(1, 2000))
def test_tiles_cover_the_picture_and_overlap(width: int, height: int) -> None:
    cuts = tiles(width, height)
    assert cuts[0].left == 0 and cuts[-1].right == width
    for one, other in pairwise(cuts):
        assert one.right - other.left >= OVERLAP * TILE_ASPECT * height - 2
    assert all(t.right - t.left <= 2.4 * height + 1 for t in cuts)


@pytest.mark.anyio
@pytest.mark.parametrize(
    "spans",
    [
        [(10, 30), (300, 330), (310 + 300, 660), (1500, 1599)],
        [(260, 330)],
        [(200, 420)],
        [(100, 1500)],
        [(0, 40)],
        [(290, 300), (305, 315)],
        [],
    ],
    ids=["apart", "in an overlap", "across a border", "across all", "at the end", "neighbours", "none"],
)
async def test_objects_in_a_panorama_are_found_once_at_their_location(spans: list[tuple[int, int]]) -> None:
    tiled = TiledPerception(Blobs())
    found = await tiled.detect(panorama(*spans), "blob")
    seen = sorted((b.x_min * WIDTH, b.x_max * WIDTH) for b in found.boxes)
    assert np.allclose(seen, sorted(spans), atol=1.0) if spans else seen == []
    assert found.complete and found.latency_s > 0


@pytest.mark.anyio
async def test_parts_are_frames_that_are_processed_together() -> None:
    blobs = Blobs()
    found = await TiledPerception(blobs).detect(panorama((10, 30)), "blob")
    assert set(blobs.shown) == {(320, HEIGHT)} and blobs.spans[0] == pytest.approx(280 * 320 / WIDTH)
    assert 1 < blobs.max_concurrent <= 4
    assert len(found.attempts) == len(blobs.shown) and found.notes == ("as seen",)


@pytest.mark.anyio
async def test_points_in_a_panorama_are_found_once() -> None:
    found = await TiledPerception(Blobs()).point(panorama((10, 30), (300, 320), (900, 960)), "blob")
    assert sorted(p.x * WIDTH for p in found.points) == pytest.approx([20, 310, 930], abs=2)


@pytest.mark.anyio
async def test_a_failing_part_fails_the_call() -> None:
    with pytest.raises(PerceptionError, match="tired") as caught:
        await TiledPerception(Blobs(fails_on=3)).detect(panorama((10, 30)), "blob")
    assert caught.value.kind == "server-error" and "server-error" in [a.kind for a in caught.value.attempts]


@pytest.mark.anyio
async def test_an_object_across_the_ends_of_a_full_turn_is_one_object() -> None:
    spans = [(0, 30), (1580, WIDTH), (700, 720)]
    around = await TiledPerception(Blobs()).detect(panorama(*spans, full_turn=True), "blob")
    assert len(around.boxes) == 2
    assert len((await TiledPerception(Blobs()).detect(panorama(*spans), "blob")).boxes) == 3


@pytest.mark.anyio
async def test_ordinary_frames_and_questions_are_not_split() -> None:
    blobs = Blobs()
    tiled = TiledPerception(blobs)
    await tiled.detect(pictures.frame(), "blob")
    await tiled.point(pictures.frame(), "blob")
    assert blobs.shown == [(640, 360)] * 2
    assert (await tiled.query(panorama(), "what?")).text == (await tiled.caption(panorama())).text == f"{WIDTH} wide"


def test_backends_that_cannot_handle_panoramas_are_wrapped() -> None:
    endpoint = {"url": "http://127.0.0.1:9/v1", "model": "m"}
    served = make_backend(BackendSpec(name="eyes", backend="moondream", endpoint=endpoint))  # type: ignore[arg-type]
    assert isinstance(served, TiledPerception) and served.name == "eyes"
    assert not isinstance(make_backend(BackendSpec(name="ocr", backend="ocr")), TiledPerception)


def test_overlap_and_suppression() -> None:
    a = Box(x_min=0.0, y_min=0.0, x_max=0.5, y_max=0.5, score=0.5)
    b = a.model_copy(update={"x_max": 0.45, "score": 0.9})
    c = Box(x_min=0.6, y_min=0.6, x_max=0.9, y_max=0.9, score=0.1)
    assert iou(a, b) == pytest.approx(0.9) and iou(a, c) == 0.0
    assert non_maximum_suppression([a, b, c], 0.5) == [b, c]
