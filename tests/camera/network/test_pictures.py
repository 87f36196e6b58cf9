"""JPEG pictures are decoded whole or refused."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scope_ptz.camera.network.errors import PictureError
from scope_ptz.camera.network.pictures import FrozenCheck, decode_jpeg, is_black
from scope_ptz.geometry import Pose


def _jpeg(width: int = 64, height: int = 48, seed: int = 1) -> bytes:
    image = cv2.resize(np.random.default_rng(seed).integers(0, 255, (6, 8, 3), np.uint8), (width, height))
    return cv2.imencode(".jpg", image)[1].tobytes()


def test_decodes_rgb() -> None:
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 2] = 255  # OpenCV writes BGR
    image = decode_jpeg(cv2.imencode(".jpg", red)[1].tobytes(), width=16, height=16)
    assert image.shape == (16, 16, 3)
    assert image[8, 8, 0] > 240
    assert image[8, 8, 2] < 15


@given(cut=st.integers(0, 400))
def test_a_truncated_picture_is_refused(cut: int) -> None:
    data = _jpeg()
    with pytest.raises(PictureError) as caught:
        decode_jpeg(data[: min(cut, len(data) - 2)])
    assert caught.value.fault in ("truncated", "damaged")


@given(data=st.binary(max_size=300))
def test_any_bytes_are_refused(data: bytes) -> None:
    for each in (data, b"\xff\xd8" + data + b"\xff\xd9"):
        with pytest.raises(PictureError):
            decode_jpeg(each)


def test_another_size_is_refused() -> None:
    with pytest.raises(PictureError, match="64x48 pixels instead of 1280x720") as caught:
        decode_jpeg(_jpeg(), width=1280, height=720)
    assert caught.value.fault == "size"


def test_a_png_is_refused() -> None:
    with pytest.raises(PictureError, match="not a JPEG"):
        decode_jpeg(cv2.imencode(".png", np.zeros((4, 4, 3), np.uint8))[1].tobytes())


def test_black_is_black_and_night_is_not() -> None:
    night: NDArray[np.uint8] = np.random.default_rng(0).integers(0, 14, (90, 160, 3), np.uint8)
    assert is_black(np.zeros((90, 160, 3), np.uint8))
    assert not is_black(night)
    lamp = np.zeros((90, 160, 3), np.uint8)
    lamp[3, 5] = 200
    assert not is_black(lamp)


HERE, THERE = Pose(0, 0, 1), Pose(30, 0, 1)


@pytest.mark.parametrize("other", [THERE, Pose(0, -5, 1), Pose(0, 0, 1.5)])
def test_a_picture_that_is_the_same_at_two_standing_poses_is_frozen(other: Pose) -> None:
    check = FrozenCheck()
    assert [check.is_frozen(b"picture", pose) for pose in (HERE, HERE, HERE, other, other)] == [False, False, False, False, True]


def test_a_repeated_picture_at_one_pose_is_fine() -> None:
    check = FrozenCheck()
    assert not any(check.is_frozen(b"picture", Pose(0.01 * k, 0, 1)) for k in range(10))


def test_a_new_picture_is_not_frozen_although_the_first_pose_was_off() -> None:
    check = FrozenCheck()
    poses = [(b"a", HERE), (b"a", HERE), (b"b", Pose(17, 0, 1)), (b"b", THERE), (b"b", THERE), (b"b", THERE)]
    assert not any(check.is_frozen(data, pose) for data, pose in poses)


def test_the_way_round_is_no_turn() -> None:
    check = FrozenCheck()
    assert not any(check.is_frozen(b"a", Pose(pan, 0, 1)) for pan in (180.0, 180.0, -180.0, -180.0))


def test_a_frozen_picture_is_waited_for_and_then_an_error() -> None:
    check = FrozenCheck()
    for pose in (HERE, HERE, THERE):
        assert not check.is_lagging(b"a", pose, 0.0)
    assert check.is_lagging(b"a", THERE, float("inf"))
    with pytest.raises(PictureError, match="frozen") as caught:
        check.is_lagging(b"a", THERE, 0.0)
    assert caught.value.fault == "frozen"
