"""The encoder, judged by what FFmpeg decodes."""

from __future__ import annotations

import av
import numpy as np
import pytest
from numpy.typing import NDArray

from scope_ptz.geometry import Pose
from scope_ptz.simulator.pack import Scene
from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.rtsp.encoder import H264Encoder, nal_units, parameter_sets
from tests.virtual_camera.rtsp.pictures import difference


def decoded(pictures: list[list[bytes]]) -> list[NDArray[np.uint8]]:
    """Return what a decoder makes of pictures, as RGB."""
    codec = av.CodecContext.create("h264", "r")
    assert isinstance(codec, av.VideoCodecContext)
    codec.thread_count = 1
    frames = []
    for nals in pictures:
        frames += codec.decode(av.Packet(b"".join(b"\x00\x00\x00\x01" + nal for nal in nals)))
    frames += codec.decode(None)
    return [np.asarray(frame.to_ndarray(format="rgb24"), np.uint8) for frame in frames]


@pytest.fixture(scope="module")
def images(analytic_scene: Scene) -> list[NDArray[np.uint8]]:
    device = VirtualDevice(analytic_scene, width=320, height=180, time_scale=1e6)
    taken = []
    for pan_deg in range(0, 40, 4):
        device.move(Pose(float(pan_deg), 0.0, 1.0))
        while device.is_moving():
            pass
        taken.append(device.expose().image)
    return taken


def test_pictures_and_colours_survive(images: list[NDArray[np.uint8]]) -> None:
    encoder = H264Encoder(320, 180, 25)
    stream = [encoder.encode(image, k / 25, keyframe=k == 0) for k, image in enumerate(images)]
    found = decoded(stream)
    assert len(found) == len(images)
    for k, image in enumerate(found):
        same, others = difference(image, images[k]), [difference(image, other) for j, other in enumerate(images) if j != k]
        assert same < 6, k
        assert same < min(others) / 2, k
        assert np.abs(image.astype(float).mean((0, 1)) - images[k].astype(float).mean((0, 1))).max() < 3


def test_keyframes_come_when_asked_for_and_bring_their_parameter_sets(images: list[NDArray[np.uint8]]) -> None:
    encoder = H264Encoder(320, 180, 25)
    wanted = [k in {0, 4, 5} for k in range(len(images))]
    stream = [encoder.encode(image, k / 25, keyframe=wanted[k]) for k, image in enumerate(images)]
    sets = parameter_sets(320, 180, 25)
    for keyframe, nals in zip(wanted, stream, strict=True):
        kinds = [nal[0] & 0x1F for nal in nals]
        assert kinds == ([7, 8, 5] if keyframe else [1])
        if keyframe:
            assert nals[:2] == [sets.sps, sets.pps]
    assert len(decoded(stream[4:])) == len(stream) - 4
    assert sets.profile_level_id.startswith("42c0")  # constrained baseline, which every decoder knows


def test_a_picture_of_another_shape_is_cropped_and_time_never_stands_still(images: list[NDArray[np.uint8]]) -> None:
    encoder = H264Encoder(160, 160, 10)
    stream = [encoder.encode(images[0], time_s, keyframe=True) for time_s in (5.0, 5.0, 4.0)]
    assert [image.shape for image in decoded(stream)] == [(160, 160, 3)] * 3


def test_a_byte_stream_is_split_at_both_start_codes() -> None:
    assert nal_units(b"\x00\x00\x00\x01gab\x00\x00\x01hcd\x00\x00\x00\x01ee") == [b"gab", b"hcd", b"ee"]
    assert nal_units(b"") == []
