"""Encode live video as H.264 with libx264 in a single thread, without frame reordering or look-ahead."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from scope_ptz.errors import CameraError, ConfigError
from scope_ptz.virtual_camera.picture_size import crop_and_scale
from scope_ptz.virtual_camera.rtsp.rtp import CLOCK_HZ

if TYPE_CHECKING:
    from av.video.codeccontext import VideoCodecContext

QUALITY_CRF = 23  # constant rate factor for libx264; lower means better quality
BITS_PER_PIXEL_S = 6.5
"""Maximum bit rate in bits per second per pixel: 6 Mbit/s at 1280x720."""

MIN_BITS_PER_S = 500_000  # lower bound for the maximum bit rate, because headers make up a larger part of small pictures

BURST_S = 0.33
"""Maximum size of an encoded picture, expressed in seconds at the maximum bit rate. This limits the size of keyframes."""

_START_CODE = re.compile(b"\x00{2,3}\x01")
_SEI = 6  # type of the NAL units with supplemental enhancement information, which are not sent
# Codes that tell decoders how colours are represented.
_BT601 = 6  # the colour matrix that ``encode`` uses to convert RGB to YUV
_BT709 = 1
_LIMITED_RANGE = 1


@dataclass(frozen=True, slots=True)
class ParameterSets:
    """The sequence and picture parameter sets (SPS and PPS), without start codes. A decoder requires them before any picture."""

    sps: bytes
    pps: bytes

    @property
    def profile_level_id(self) -> str:
        """The H.264 profile and level in SDP notation: six hexadecimal digits."""
        return self.sps[1:4].hex()


class H264Encoder:
    """Encodes pictures of a fixed size.

    Args:
        width: Width in pixels; must be even.
        height: Height in pixels; must be even.
        fps: Frames per second, used for rate control.

    Raises:
        ConfigError: PyAV is not installed, or lacks libx264.
    """

    def __init__(self, width: int, height: int, fps: float) -> None:
        self.width, self.height = width, height
        self._codec = _open_codec(width, height, fps)
        sps, pps = (nal for nal in nal_units(self._codec.extradata or b"") if nal[0] & 0x1F in (7, 8))
        self.sets = ParameterSets(sps, pps)
        self._last_pts = -1

    def encode(self, image: NDArray[np.uint8], time_s: float, *, keyframe: bool) -> list[bytes]:
        """Encode a picture and return its NAL units. This blocks until the picture has been encoded.

        Args:
            image: Array of shape ``(H, W, 3)``, RGB. It is scaled and cropped to the encoder's size if necessary.
            time_s: The time at which the image was taken, in seconds from an arbitrary origin.
            keyframe: Whether decoding can start at this picture. If so, the parameter sets come first.

        Raises:
            CameraError: libx264 failed.
        """
        from av import FFmpegError
        from av.video.frame import PictureType, VideoFrame

        yuv = cv2.cvtColor(crop_and_scale(image, self.width, self.height), cv2.COLOR_RGB2YUV_I420)
        frame = VideoFrame.from_ndarray(np.asarray(yuv, np.uint8), format="yuv420p")
        frame.time_base = Fraction(1, CLOCK_HZ)
        self._last_pts = frame.pts = max(self._last_pts + 1, round(time_s * CLOCK_HZ))
        frame.pict_type = PictureType.I if keyframe else PictureType.NONE
        try:
            packets = self._codec.encode(frame)
        except FFmpegError as error:
            raise CameraError(f"The picture cannot be encoded: {error}") from error
        units = [nal for packet in packets for nal in nal_units(bytes(packet)) if nal[0] & 0x1F != _SEI]
        return [self.sets.sps, self.sets.pps, *units] if keyframe else units


def nal_units(stream: bytes) -> list[bytes]:
    """Split a byte stream with start codes (Annex B of H.264) into NAL units."""
    return [nal for nal in _START_CODE.split(stream) if nal]


@lru_cache(maxsize=64)
def parameter_sets(width: int, height: int, fps: float) -> ParameterSets:
    """Return the parameter sets for a stream format.

    Raises:
        ConfigError: PyAV is not installed, or lacks libx264.
    """
    return H264Encoder(width, height, fps).sets


def _open_codec(width: int, height: int, fps: float) -> VideoCodecContext:
    try:
        import av
        from av.codec.context import Flags
    except ModuleNotFoundError as error:
        raise ConfigError("RTSP requires PyAV. Install it with: pip install 'scope-ptz[serve]'") from error
    bits_per_s = max(MIN_BITS_PER_S, BITS_PER_PIXEL_S * width * height)
    try:
        codec: VideoCodecContext = av.CodecContext.create("libx264", "w")
        codec.width, codec.height, codec.pix_fmt = width, height, "yuv420p"
        codec.time_base, codec.framerate = Fraction(1, CLOCK_HZ), Fraction(fps).limit_denominator(1000)
        codec.thread_count = 1
        codec.gop_size = 10_000  # large enough that only the caller decides which pictures are keyframes
        codec.flags |= Flags.global_header
        codec.colorspace, codec.color_range = _BT601, _LIMITED_RANGE
        codec.color_primaries = codec.color_trc = _BT709
        codec.options = {
            "preset": "ultrafast",
            "tune": "zerolatency",
            "profile": "baseline",
            "forced-idr": "1",
            "crf": str(QUALITY_CRF),
            "maxrate": str(int(bits_per_s)),
            "bufsize": str(int(bits_per_s * BURST_S)),
        }
        codec.open()
    except (av.FFmpegError, ValueError) as error:
        raise ConfigError(f"This build of PyAV cannot encode H.264 with libx264 ({error}). Install PyAV from PyPI.") from error
    return codec
