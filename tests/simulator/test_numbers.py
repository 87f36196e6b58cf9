"""Sheets of instance IDs: one byte per pixel, and every ID is exact."""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from scope_ptz.simulator.layers import decode_numbers
from scope_ptz.simulator.sheets.atlas import STRIP_PX, Atlas
from scope_ptz.simulator.sheets.layout import BORDER_PX
from scope_ptz.simulator.sheets.numbers import BLOCK_HEIGHT_PX, BLOCK_WIDTH_PX, IdAtlas, IdCodes, SparseIds

SIZES = ((300, STRIP_PX + 40), (70, 50), (33, 20))
"""The panorama, which is read in two strips, and two tiles."""


def _pictures(seed: int, most: int) -> list[NDArray[np.uint16]]:
    rng = np.random.default_rng(seed)
    return [rng.integers(0, most + 1, (height, width), np.uint16) for width, height in SIZES]


def _whole(pictures: list[NDArray[np.uint16]]) -> Atlas:
    """Return an atlas of the same pictures with two bytes per pixel."""
    return Atlas(SIZES, lambda _, i: pictures[i], np.uint16, 1)


@given(st.integers(0, 2**31), st.sampled_from([3, 254, 255, 700, 65535]), st.integers(0, 400))
@settings(max_examples=30, deadline=None)
def test_numbers_are_those_of_a_sheet_of_two_bytes_per_pixel(seed: int, most: int, common: int) -> None:
    pictures = _pictures(seed, most)
    numbers = IdAtlas(SIZES, lambda _, i: pictures[i], IdCodes(range(1, common + 1)))
    expected = _whole(pictures)
    rng = np.random.default_rng(seed + 1)
    for index in range(len(SIZES)):
        slot, same = numbers.ensure(index), expected.ensure(index)
        assert slot == same
        low = np.array([slot.x - BORDER_PX, slot.y - BORDER_PX])
        high = np.array([slot.x + slot.width + BORDER_PX - 1, slot.y + slot.height + BORDER_PX - 1])
        positions = (low + rng.random((40, 50, 2)) * (high - low)).astype(np.float32)
        for where in (positions, cv2.convertMaps(positions, None, cv2.CV_16SC2, nninterpolation=True)[0]):
            np.testing.assert_array_equal(numbers.sample(where), cv2.remap(expected.sheet, where, None, cv2.INTER_NEAREST))
        rows, columns = np.arange(low[1], high[1] + 1)[:, None], np.arange(low[0], high[0] + 1)
        np.testing.assert_array_equal(numbers.at(rows, columns), expected.sheet[rows, columns])


def test_positions_halfway_between_pixels_are_rounded_as_in_remap() -> None:
    pictures = _pictures(1, 60000)
    numbers, expected = IdAtlas(SIZES, lambda _, i: pictures[i], IdCodes([])), _whole(pictures)
    slot = numbers.ensure(0)
    expected.ensure(0)
    x, y = np.meshgrid(slot.x + np.arange(0, 40, 0.5), slot.y + np.arange(0, 30, 0.5))
    positions = np.stack([x, y], axis=-1).astype(np.float32)
    np.testing.assert_array_equal(numbers.sample(positions), cv2.remap(expected.sheet, positions, None, cv2.INTER_NEAREST))


def test_numbers_are_decoded_as_they_are_read() -> None:
    numbers = _pictures(2, 900)[0]
    high, low = (numbers >> np.uint16(8)).astype(np.uint8), numbers.astype(np.uint8)
    coded: NDArray[Any] = np.stack([high, low, np.zeros_like(low)], axis=-1)
    atlas = IdAtlas(SIZES[:1], lambda *_: coded, IdCodes(range(1, 100)), decode=decode_numbers)
    slot = atlas.ensure(0)
    rows, columns = np.arange(slot.y, slot.y + slot.height)[:, None], np.arange(slot.x, slot.x + slot.width)
    np.testing.assert_array_equal(atlas.at(rows, columns), numbers)


def test_numbers_that_no_pixel_can_have_get_no_code() -> None:
    codes = IdCodes([70_000, -3, 0, 9])
    np.testing.assert_array_equal(codes.encode(np.array([[0, 9, 8]], np.uint16)), [[0, 1, 255]])


def test_no_positions_have_no_numbers() -> None:
    atlas = IdAtlas(SIZES, lambda _, i: _pictures(3, 5)[i], IdCodes([1]))
    nothing = np.zeros(0, np.int64)
    assert atlas.at(nothing, nothing).shape == (0,)


@given(st.integers(1, 200), st.integers(1, 300), st.integers(0, 2**31))
@settings(max_examples=40, deadline=None)
def test_every_pixel_has_a_separate_place(height: int, width: int, seed: int) -> None:
    numbers = np.random.default_rng(seed).integers(0, 65536, (height, width), np.uint16)
    memory = np.zeros(SparseIds.bytes_for((height, width)), np.uint8)
    sparse = SparseIds(memory, (height, width))
    rows, columns = np.indices((height, width))
    sparse.write(rows, columns, numbers)
    np.testing.assert_array_equal(sparse.read(rows, columns), numbers)


def test_a_small_object_takes_the_memory_of_its_blocks_only() -> None:
    shape = (40 * BLOCK_HEIGHT_PX, 40 * BLOCK_WIDTH_PX)
    memory = np.zeros(SparseIds.bytes_for(shape), np.uint8)
    rows, columns = np.mgrid[10 * BLOCK_HEIGHT_PX - 8 : 10 * BLOCK_HEIGHT_PX + 8, 700 : 700 + BLOCK_WIDTH_PX]
    SparseIds(memory, shape).write(rows, columns, np.full(rows.shape, 777, np.uint16))
    block_bytes = 2 * BLOCK_HEIGHT_PX * BLOCK_WIDTH_PX
    assert 0 < memory.reshape(-1, block_bytes).any(axis=1).sum() <= 4
