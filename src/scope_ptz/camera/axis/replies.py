"""Parse VAPIX replies, which are text or JSON. Replies are untrusted, so every value is checked."""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass

from scope_ptz.camera.network.errors import CameraReplyError
from scope_ptz.errors import CameraError

MAX_QUOTED = 120
"""Maximum number of characters to quote from a device's error message."""

_PRESET = re.compile(r"presetposno(\d{1,6})=(.*)")
# In the control queue's replies, the names of the HTML anchors hold the position, the seconds and the poll interval.
_ANCHOR = re.compile(r'name="(-?\d{1,9})"')


class VapixError(CameraError):
    """The device understood the request but refused it."""


@dataclass(frozen=True, slots=True)
class Position:
    """A reported position. Pan and tilt are in degrees, the other numbers in the device's units.

    A value is None if the device does not report it.
    """

    pan_deg: float
    tilt_deg: float
    zoom_units: float
    autofocus: bool | None = None
    autoiris: bool | None = None
    focus_units: float | None = None
    iris_units: float | None = None


@dataclass(frozen=True, slots=True)
class DeviceLimits:
    """The limits that a device reports. Field angles are in tenths of a degree; None means not reported."""

    min_pan_deg: float
    max_pan_deg: float
    min_tilt_deg: float
    max_tilt_deg: float
    min_zoom_units: float
    max_zoom_units: float
    min_field_angle: float | None = None
    max_field_angle: float | None = None


@dataclass(frozen=True, slots=True)
class QueuePlace:
    """A client's position in the control queue.

    Attributes:
        place: Position in the queue: 1 if the client has control, 2 or more if it is waiting, 0 if it is not in the queue.
        seconds: Seconds of control left, or seconds until control; -1 if unknown.
        poll_s: Seconds within which the client must renew its place.
    """

    place: int
    seconds: int
    poll_s: int


def decode_text(body: bytes) -> str:
    """Decode a text reply: UTF-8, or ISO 8859-1 from older devices.

    Raises:
        VapixError: The device refuses the request.
        CameraReplyError: The reply is HTML or binary.
    """
    try:
        text = body.decode("utf-8")
    except UnicodeDecodeError:
        text = body.decode("iso-8859-1")
    stripped = text.lstrip().removeprefix("#").lstrip()
    if stripped[:6].lower() == "error:":
        raise VapixError(f"The camera refused the request: {_quote(stripped[6:])}.")
    if "\0" in text or (stripped[:1] == "<" and "name=" not in stripped[:20]):
        raise CameraReplyError("The reply is not VAPIX text. Check that the device is an AXIS camera with up-to-date firmware.")
    return text


def parse_values(text: str) -> dict[str, str]:
    """Return the ``name=value`` lines of a reply as a dictionary. The prefix ``root.`` is removed from names."""
    pairs = (line.strip().partition("=") for line in text.splitlines())
    return {name.strip().removeprefix("root."): value.strip() for name, equals, value in pairs if equals and name.strip()}


def parse_position(body: bytes) -> Position:
    """Parse the reply to ``query=position``.

    Raises:
        VapixError: The device refuses the request.
        CameraReplyError: An axis is missing or not a number.
    """
    values = _lower_keys(parse_values(decode_text(body)))
    return Position(
        _required_number(values, "pan"),
        _required_number(values, "tilt"),
        _required_number(values, "zoom"),
        _parse_flag(values, "autofocus"),
        _parse_flag(values, "autoiris"),
        _required_number(values, "focus") if "focus" in values else None,
        _required_number(values, "iris") if "iris" in values else None,
    )


def parse_limits(body: bytes) -> DeviceLimits:
    """Parse the reply to ``query=limits``.

    Raises:
        VapixError: The device refuses the request.
        CameraReplyError: A limit is missing or is not a number, or a maximum is too small. The maximum pan and tilt must be
            greater than the minimum; the maximum zoom may equal the minimum.
    """
    values = _lower_keys(parse_values(decode_text(body)))
    fields = [_optional_number(values, name) for name in ("minfieldangle", "maxfieldangle")]
    limits = DeviceLimits(
        *(_required_number(values, name) for name in ("minpan", "maxpan", "mintilt", "maxtilt", "minzoom", "maxzoom")), *fields
    )  # fmt: skip
    if not (
        limits.min_pan_deg < limits.max_pan_deg
        and limits.min_tilt_deg < limits.max_tilt_deg
        and limits.min_zoom_units <= limits.max_zoom_units
    ):
        raise CameraReplyError("The camera reports a minimum limit that is not below the maximum. Reset its PTZ limits.")
    return limits


def parse_presets(body: bytes) -> dict[int, str]:
    """Parse the reply to ``query=presetposcam`` and return the preset names by number, in numerical order."""
    presets: dict[int, str] = {}
    for line in decode_text(body).splitlines():
        if (match := _PRESET.fullmatch(line.strip())) and match.group(2).strip():
            presets[int(match.group(1))] = match.group(2).strip()
    return dict(sorted(presets.items()))


def parse_table(body: bytes, channel: int, attribute: str, key: str) -> tuple[tuple[float, float], ...]:
    """Parse a calibration table from the reply to ``query=attributes&format=json``.

    Args:
        body: The reply.
        channel: The video channel.
        attribute: The table: ``zoomSteps`` or ``speeds``.
        key: The column with the physical values: ``zoom`` or ``speed``. The column ``value`` contains the device's values.

    Returns:
        Rows of (device value, physical value), increasing in both columns; empty if the device has no such table. Rows that break
        the order are dropped.
    """
    text = decode_text(body)
    try:
        document = json.loads(text)
        rows = document[f"Camera {channel}"][attribute]
        pairs = sorted((float(row["value"]), float(row[key])) for row in rows)
    except (ValueError, KeyError, TypeError, RecursionError):
        return ()
    increasing: list[tuple[float, float]] = []
    for value, physical in pairs:
        if math.isfinite(value) and math.isfinite(physical) and physical > 0:
            if increasing and (value <= increasing[-1][0] or physical <= increasing[-1][1]):
                continue
            increasing.append((value, physical))
    return tuple(increasing)


def parse_queue(body: bytes) -> QueuePlace:
    """Parse a reply from the control queue.

    Raises:
        VapixError: The device refuses the request, for example because the queue is full.
        CameraReplyError: The reply contains no position.
    """
    numbers = [int(number) for number in _ANCHOR.findall(decode_text(body))]
    if len(numbers) < 3 or numbers[0] < 0:
        raise CameraReplyError(
            "The camera did not report a position in its control queue. Check the camera's firmware, or turn the queue off."
        )
    return QueuePlace(numbers[0], numbers[1], max(1, numbers[2]))


def check_done(body: bytes) -> None:
    """Check the reply to a command, which is empty on success. Raise ``VapixError`` if it is an error message."""
    if body.strip():
        decode_text(body)


def _lower_keys(values: dict[str, str]) -> dict[str, str]:
    return {name.lower(): value for name, value in values.items()}


def _required_number(values: dict[str, str], name: str) -> float:
    number = _optional_number(values, name)
    if number is None:
        raise CameraReplyError(f"The reply contains no {name}. Check that the device is an AXIS camera with pan, tilt and zoom.")
    return number


def _optional_number(values: dict[str, str], name: str) -> float | None:
    try:
        number = float(values[name])
    except (KeyError, ValueError):
        return None
    return number if math.isfinite(number) else None


def _parse_flag(values: dict[str, str], name: str) -> bool | None:
    return {"on": True, "off": False}.get(values.get(name, "").lower())


def _quote(text: str) -> str:
    """Return the start of a device's message as one printable line."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return line[:MAX_QUOTED].rstrip(".") or "no reason given"
