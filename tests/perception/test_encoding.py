"""Each frame is encoded once, and the cache forgets deleted frames."""

from __future__ import annotations

import gc
import threading
from typing import Any

import anyio
import cv2
import numpy as np
import pytest

from scope_ptz.errors import PerceptionError
from scope_ptz.perception.models.encoding import EncodedPicture, Size, encode, encode_frame
from scope_ptz.perception.models.frame_memo import FrameMemo, Image
from tests.perception import pictures


def test_encoding_keeps_colours() -> None:
    picture = encode(pictures.frame().image)
    back: Any = cv2.imdecode(np.frombuffer(picture.jpeg, np.uint8), cv2.IMREAD_COLOR_RGB)
    assert picture.size == (640, 360)
    assert np.abs(back[135, 240].astype(int) - (255, 128, 0)).max() < 12
    assert picture.data_url.startswith("data:image/jpeg;base64,/9j/")


def test_a_frame_can_be_encoded_at_another_size() -> None:
    assert encode(pictures.frame().image, (56, 84)).size == (56, 84)


def test_frames_too_large_for_jpeg_are_an_error() -> None:
    with pytest.raises(PerceptionError, match="70000x2"):
        encode(np.zeros((2, 70_000, 3), np.uint8))


@pytest.mark.anyio
async def test_concurrent_callers_share_one_encoding() -> None:
    made: list[Size | None] = []
    together = threading.Barrier(2, timeout=5)

    def slow(image: Image, size: Size | None) -> EncodedPicture:
        made.append(size)
        if len(made) <= 2:
            together.wait()  # two sizes are encoded side by side
        return encode(image, size)

    memo, frame = FrameMemo[Size | None, EncodedPicture](slow), pictures.frame()
    got: list[EncodedPicture] = []

    async def ask(size: Size | None) -> None:
        got.append(await encode_frame(frame, size, memo))

    async with anyio.create_task_group() as group:
        for _ in range(6):
            group.start_soon(ask, None)
            group.start_soon(ask, (64, 36))
        group.start_soon(ask, (640, 360))
    assert sorted(made, key=str) == [(64, 36), None]
    assert len({id(p) for p in got}) == 2


def test_equal_frames_are_encoded_separately() -> None:
    made: list[int] = []

    def number(image: Image, key: None) -> int:
        made.append(id(image))
        return len(made)

    memo = FrameMemo[None, int](number)
    one, other = pictures.frame(), pictures.frame()
    assert [memo.get(one.image, None), memo.get(other.image, None), memo.get(one.image, None)] == [1, 2, 1]


def test_the_cache_forgets_deleted_frames_and_is_bounded() -> None:
    memo = FrameMemo[None, int](lambda image, _: int(image[0, 0, 0]), size=2)
    frames = [pictures.frame(np.full((2, 2, 3), i, np.uint8)) for i in range(4)]
    assert [memo.get(f.image, None) for f in frames] == [0, 1, 2, 3]
    assert len(memo) == 2
    del frames
    gc.collect()
    assert len(memo) == 0


def test_a_failed_computation_is_repeated() -> None:
    tries: list[int] = []

    def make(image: Image, key: None) -> int:
        tries.append(1)
        if len(tries) == 1:
            raise PerceptionError("not yet")
        return 7

    memo, frame = FrameMemo[None, int](make), pictures.frame()
    with pytest.raises(PerceptionError):
        memo.get(frame.image, None)
    assert memo.get(frame.image, None) == 7
