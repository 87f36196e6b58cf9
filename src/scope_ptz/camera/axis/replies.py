"""Parse VAPIX replies, which are text or JSON. Replies are not trusted, so every value is checked."""

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
# In replies from the queue, the names of HTML anchors are the place, the seconds and the poll interval.
_ANCHOR = re.compile(r'name="(-?\d{1,9})"')


class VapixError(CameraError):
    """The device understood the request but refused it."""


@dataclass(frozen=True, slots=True)
class Position:
    """A position that the device reports. Pan and tilt are in degrees, and other values in the device's units.

    None means that the device does not report the value.
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
    """The limits that a device reports. Field angles are in tenths of a degree, and None if it does not report them."""

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
    """A place in the control queue.

    Attributes:
        place: Position in the queue: 1 has control, 2 and above are waiting, and 0 is not in the queue.
        seconds: Seconds of control left, or seconds until control; -1 if unknown.
        poll_s: Seconds after which the place must be renewed.
    """

    place: int
    seconds: int
    poll_s: int


def text_of(body: bytes) -> str:
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
        raise CameraReplyError(
            "The camera's reply is not VAPIX text. Check that it is an AXIS camera and that its firmware is up to date."
        )
    return text


def values_of(text: str) -> dict[str, str]:
    """Return the ``name=value`` lines of a reply as a dictionary. The prefix ``root.`` is removed from names."""
    pairs = (line.strip().partition("=") for line in text.splitlines())
    return {name.strip().removeprefix("root."): value.strip() for name, equals, value in pairs if equals and name.strip()}


def parse_position(body: bytes) -> Position:
    """Parse the reply to ``query=position``.

    Raises:
        VapixError: The device refuses the request.
        CameraReplyError: An axis is missing or not a number.
    """
    values = _lower(values_of(text_of(body)))
    return Position(
        _number(values, "pan"),
        _number(values, "tilt"),
        _number(values, "zoom"),
        _flag(values, "autofocus"),
        _flag(values, "autoiris"),
        _number(values, "focus") if "focus" in values else None,
        _number(values, "iris") if "iris" in values else None,
    )


def parse_limits(body: bytes) -> DeviceLimits:
    """Parse the reply to ``query=limits``.

    Raises:
        VapixError: The device refuses the request.
        CameraReplyError: A limit is missing or not a number, or a maximum is too small. The maximum of pan and of tilt must be
            greater than the minimum; that of zoom may be equal to it.
    """
    values = _lower(values_of(text_of(body)))
    fields = [_optional(values, name) for name in ("minfieldangle", "maxfieldangle")]
    limits = DeviceLimits(
        *(_number(values, name) for name in ("minpan", "maxpan", "mintilt", "maxtilt", "minzoom", "maxzoom")), *fields
    )  # fmt: skip
    if not (
        limits.min_pan_deg < limits.max_pan_deg
        and limits.min_tilt_deg < limits.max_tilt_deg
        and limits.min_zoom_units <= limits.max_zoom_units
    ):
        raise CameraReplyError("The camera reports limits whose minimum is not below the maximum. Reset its PTZ limits.")
    return limits


def parse_presets(body: bytes) -> dict[int, str]:
    """Parse the reply to ``query=presetposcam``. Return preset names by number, in numerical order."""
    found: dict[int, str] = {}
    for line in text_of(body).splitlines():
        if (match := _PRESET.fullmatch(line.strip())) and match.group(2).strip():
            found[int(match.group(1))] = match.group(2).strip()
    return dict(sorted(found.items()))


def parse_table(body: bytes, channel: int, attribute: str, key: str) -> tuple[tuple[float, float], ...]:
    """Parse a calibration table from the reply to ``query=attributes&format=json``.

    Args:
        body: The reply.
        channel: The video channel.
        attribute: The table: ``zoomSteps`` or ``speeds``.
        key: The column with the physical values, ``zoom`` or ``speed``. The column ``value`` has the device's values.

    Returns:
        Rows of (device value, physical value), increasing in both columns; empty if the device has no such table. Rows that break
        the order are dropped.
    """
    text = text_of(body)
    try:
        found = json.loads(text)
        rows = found[f"Camera {channel}"][attribute]
        pairs = sorted((float(row["value"]), float(row[key])) for row in rows)
    except (ValueError, KeyError, TypeError, RecursionError):
        return ()
    rising: list[tuple[float, float]] = []
    for value, physical in pairs:
        if math.isfinite(value) and math.isfinite(physical) and physical > 0:
            if rising and (value <= rising[-1][0] or physical <= rising[-1][1]):
                continue
            rising.append((value, physical))
    return tuple(rising)


def parse_queue(body: bytes) -> QueuePlace:
    """Parse a reply from the control queue.

    Raises:
        VapixError: The device refuses the request, for example because the queue is full.
        CameraReplyError: The reply contains no place.
    """
    numbers = [int(number) for number in _ANCHOR.findall(text_of(body))]
    if len(numbers) < 3 or numbers[0] < 0:
        raise CameraReplyError("The reply of the camera's control queue has no place. Check its firmware, or turn the queue off.")
    return QueuePlace(numbers[0], numbers[1], max(1, numbers[2]))


def check_done(body: bytes) -> None:
    """Raise ``VapixError`` if a command was refused. The reply to a successful command is empty."""
    if body.strip():
        text_of(body)


def _lower(values: dict[str, str]) -> dict[str, str]:
    return {name.lower(): value for name, value in values.items()}


def _number(values: dict[str, str], name: str) -> float:
    number = _optional(values, name)
    if number is None:
        raise CameraReplyError(f"The camera reports no {name}. Check that it is an AXIS camera with pan, tilt and zoom.")
    return number


def _optional(values: dict[str, str], name: str) -> float | None:
    try:
        number = float(values[name])
    except (KeyError, ValueError):
        return None
    return number if math.isfinite(number) else None


def _flag(values: dict[str, str], name: str) -> bool | None:
    return {"on": True, "off": False}.get(values.get(name, "").lower())


def _quote(text: str) -> str:
    """Return the start of a device's message as one printable line."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return line[:MAX_QUOTED].rstrip(".") or "no reason given"
