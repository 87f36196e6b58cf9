"""A small VAPIX device that shows faults on demand. It is a deliberate fake: its picture is noise and its motors are simple."""

from __future__ import annotations

import asyncio
import hashlib
import json
import re
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from urllib.parse import parse_qs, urlsplit

import cv2
import numpy as np
from numpy.typing import NDArray

from tests.support.loopback import Exchange, Loopback

USER, PASSWORD = "operator", "s3cret-word"
NONCE, REALM = "c0ffee", "AXIS_FAKE"
SMALL = (320, 180)


def _world() -> NDArray[np.uint8]:
    """Return a textured strip in which every view is another one."""
    rng = np.random.default_rng(5)
    coarse = rng.integers(0, 255, (90, 360, 3), dtype=np.uint8)
    return np.asarray(cv2.resize(coarse, (2880, 720), interpolation=cv2.INTER_CUBIC), np.uint8)


WORLD = _world()


@dataclass
class FakeVapix:
    """The device. Set the attributes to change how it behaves.

    ``moves`` are the motion commands in the order of their arrival, with their arrival times.
    """

    speed_dps: float = 0.0  # 0: absolute moves end at once
    password: str = PASSWORD
    delay_s: float = 0.0
    hang_up: int = 0  # so many requests are answered by a reset
    status: int = 0  # answer everything with this status
    garbage: bool = False
    picture: str = ""
    stuck: frozenset[str] = frozenset()
    redirect: str = ""
    basic_only: bool = False
    other_has_control: bool = False
    control_queue_on: bool = False
    cloak: frozenset[str] = frozenset()  # queries that the device does not know
    clamp_pan: float | None = None  # a limit that appears later
    locked: bool = False
    more_support: tuple[str, ...] = ()  # functions that it announces and does not have
    shake: bool = False  # the picture keeps moving
    actor: bool = False  # something walks through the picture
    stall_after: int | None = None  # the MJPEG stream falls silent after so many pictures
    presets: dict[str, tuple[float, float, float]] = field(
        default_factory=lambda: {"home": (0.0, 0.0, 1.0), "gate": (40.0, -5.0, 3000.0)}
    )
    auto: dict[str, str] = field(default_factory=lambda: {"focus": "on", "iris": "on"})
    moves: list[tuple[float, str]] = field(default_factory=list)
    on_move: Callable[[FakeVapix], None] = lambda _: None

    def __post_init__(self) -> None:
        self._lock = threading.RLock()
        self._at = np.zeros(3)
        self._at[2] = 1.0
        self._target = self._at.copy()
        self._velocity = np.zeros(3)
        self._since_s = monotonic()
        self._shots = 0
        self._frozen: bytes | None = None
        self.loopback = Loopback([], self.answer)

    # --- motors

    def position(self) -> NDArray[np.float64]:
        with self._lock:
            now_s = monotonic()
            passed_s, self._since_s = now_s - self._since_s, now_s
            if self._velocity.any():
                self._at = self._at + self._velocity * passed_s
                self._target = self._at.copy()
            elif self.speed_dps:
                step = np.array([self.speed_dps, self.speed_dps, self.speed_dps * 100]) * passed_s
                self._at = self._at + np.clip(self._target - self._at, -step, step)
            else:
                self._at = self._target.copy()
            limits = np.array([[-170.0, -90.0, 1.0], [self.clamp_pan or 170.0, 20.0, 9999.0]])
            self._at = np.clip(self._at, *limits)
            return self._at

    @property
    def driving(self) -> bool:
        with self._lock:
            return bool(self._velocity.any())

    def nudge(self, pan_deg: float) -> None:
        """Somebody else moves the camera."""
        with self._lock:
            self._target = np.array([pan_deg, 0.0, 1.0])
            self._at = self._target.copy()

    def _go(self, pan: float, tilt: float, zoom: float) -> None:
        with self._lock:
            here, wanted = self.position(), np.array([pan, tilt, zoom])
            free = np.array([axis not in self.stuck for axis in ("pan", "tilt", "zoom")])
            self._velocity[:] = 0
            self._target = np.where(free, wanted, here)
            self._target[0] = min(self._target[0], self.clamp_pan or 170.0)

    # --- HTTP

    async def answer(self, exchange: Exchange) -> None:
        parts = urlsplit(exchange.request.path)
        query = {name: values[0] for name, values in parse_qs(parts.query, keep_blank_values=True).items()}
        if self.delay_s:
            await asyncio.sleep(self.delay_s)
        if self.hang_up:
            self.hang_up -= 1
            exchange.hang_up()
        elif self.redirect:
            await exchange.whole(b"", 302, headers={"Location": self.redirect})
        elif self.status:
            await exchange.whole(b"busy", self.status, "text/plain")
        elif not self._signed_in(exchange):
            scheme = (
                f'Basic realm="{REALM}"'
                if self.basic_only
                else f'Digest realm="{REALM}", nonce="{NONCE}", algorithm=MD5, qop="auth"'
            )
            await exchange.whole(b"", 401, "text/plain", {"WWW-Authenticate": scheme})
        elif self.garbage:
            await exchange.whole(b"\x00\xff\x00<<<", 200, "application/octet-stream")
        elif parts.path.endswith("video.cgi"):
            await self._stream(exchange, query)
        else:
            code, kind, body = self._reply(parts.path, query)
            await exchange.whole(body, code, kind)

    def _signed_in(self, exchange: Exchange) -> bool:
        given = exchange.request.headers.get("authorization", "")
        values = dict(re.findall(r'(\w+)="?([^",]+)"?', given.removeprefix("Digest ")))
        if not given.startswith("Digest ") or values.get("nonce") != NONCE:
            return False
        first = _md5(f"{USER}:{REALM}:{self.password}")
        second = _md5(f"{exchange.request.method}:{values['uri']}")
        expected = _md5(f"{first}:{NONCE}:{values['nc']}:{values['cnonce']}:auth:{second}")
        found = (values["username"], values["uri"], values["response"])
        return found == (USER, exchange.request.path, expected)

    def _reply(self, path: str, query: dict[str, str]) -> tuple[int, str, bytes]:
        if path.endswith("image.cgi"):
            return 200, "image/jpeg", self._jpeg(query)
        if path.endswith("param.cgi"):
            return 200, "text/plain", self._parameters(query["group"]).encode()
        if path.endswith("ptzqueue.cgi"):
            place = "2" if self.other_has_control and query["control"] != "drop" else "1"
            self.moves.append((monotonic(), f"queue {query['control']}"))
            return 200, "text/html", f'<a name="{place}"></a><a name="410"></a><a name="20"></a>'.encode()
        if path.endswith(("ptz.cgi", "ptzconfig.cgi")):
            text = self._ptz(query)
            return (204, "", b"") if text is None else (200, "text/plain", text.encode())
        return 404, "text/html", b"<html>not found</html>"

    def _parameters(self, group: str) -> str:
        if group == "root.Brand":
            return "root.Brand.ProdFullName=AXIS FAKE PTZ\r\nroot.Brand.Brand=AXIS\r\n"
        if group == "root.PTZ":
            supported = (
                "ContinuousPan",
                "ContinuousTilt",
                "ContinuousZoom",
                "ServerPreset",
                "AutoFocus",
                "RelativeFocus",
                "AutoIris",
            )
            lines = [f"root.PTZ.Support.S1.{name}=true" for name in (*supported, *self.more_support)]
            various = {"CtlQueueing": self.control_queue_on, "Locked": self.locked}
            return "\r\n".join([*lines, *(f"root.PTZ.Various.V1.{name}={str(on).lower()}" for name, on in various.items())])
        if group == "root.Properties.Image":
            return "root.Properties.Image.Resolution=640x360,320x180,160x120"
        return f"# Error: Error -1 getting param in group '{group}'"

    def _ptz(self, query: dict[str, str]) -> str | None:
        what = query.get("query")
        if what is None:
            return self._command({name: value for name, value in query.items() if name != "camera"})
        key = query.get("group", what)
        if key in self.cloak:
            return f"Error: query: unknown value: {what}"
        if what == "position":
            pan, tilt, zoom = self.position()
            modes = "".join(f"auto{name}={mode}\r\n" for name, mode in self.auto.items())
            return f"pan={pan:.4f}\r\ntilt={tilt:.4f}\r\nzoom={zoom:.0f}\r\n{modes}"
        if what == "limits":
            fields = "" if "fields" in self.cloak else "MinFieldAngle=140\nMaxFieldAngle=710\n"
            return f"MinPan=-170\nMaxPan={self.clamp_pan or 170}\nMinTilt=-90\nMaxTilt=20\nMinZoom=1\nMaxZoom=9999\n{fields}"
        if what == "presetposcam":
            lines = [f"presetposno{k}={name}" for k, name in enumerate(self.presets, 1)]
            return "\n".join(["Preset Positions for camera 1", *reversed(lines)])
        if what == "attributes":
            rows = {"zoom": ("zoomSteps", "zoom", ((1, 1), (9999, 5))), "speed": ("speeds", "speed", ((1, 0.1), (100, 100)))}
            name, column, table = rows[query["group"]]
            return json.dumps({"Camera 1": {name: [{"value": str(v), column: str(x)} for v, x in table]}})
        return "Error: query: unknown value"

    def _command(self, query: dict[str, str]) -> str | None:
        self.moves.append((monotonic(), "&".join(f"{name}={value}" for name, value in query.items())))
        if self.control_queue_on and self.other_has_control:
            return "Error: no PTZ control"
        self.on_move(self)
        if "pan" in query:
            self._go(float(query["pan"]), float(query["tilt"]), float(query["zoom"]))
        elif query.get("move") == "home":
            self._go(*self.presets["home"])
        elif "gotoserverpresetname" in query:
            if (name := query["gotoserverpresetname"]) not in self.presets:
                return "Error: no such preset"
            self._go(*self.presets[name])
        elif "setserverpresetname" in query:
            pan, tilt, zoom = self.position()
            self.presets[query["setserverpresetname"]] = (float(pan), float(tilt), float(zoom))
        elif "removeserverpresetname" in query:
            self.presets.pop(query["removeserverpresetname"], None)
        elif "autofocus" in query:
            self.auto["focus"] = query["autofocus"]
        elif "autoiris" in query:
            self.auto["iris"] = query["autoiris"]
        else:
            self._drive(query)
        return None

    def _drive(self, query: dict[str, str]) -> None:
        with self._lock:
            here = self.position()
            if "continuouspantiltmove" in query:
                self._velocity[:2] = [float(v) for v in query["continuouspantiltmove"].split(",")]
            if "continuouszoommove" in query:
                self._velocity[2] = 100 * float(query["continuouszoommove"])
            if query.get("move") == "stop":
                self._velocity[:] = 0
                self._target = here.copy()

    # --- pictures

    def _jpeg(self, query: dict[str, str]) -> bytes:
        width, height = (int(v) for v in query["resolution"].split("x"))
        if self.picture == "frozen" and self._frozen is not None:
            return self._frozen
        if self.picture == "size":
            width, height = width // 2, height // 2
        image = self._view(width, height)
        data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes()
        if self.picture == "truncated":
            data = data[: len(data) // 2]
        if self.picture == "frozen":
            self._frozen = data
        return data

    def _view(self, width: int, height: int) -> NDArray[np.uint8]:
        if self.picture == "black":
            return np.zeros((height, width, 3), np.uint8)
        self._shots += 1
        pan, tilt, zoom = self.position()
        left = int((pan + 180) * 5) % 2240 + (60 * (self._shots % 5) if self.shake else 0)
        top = int(np.clip((tilt + 90) * 2, 0, 350))
        share = 1 / (1 + 4 * zoom / 9999)
        seen = WORLD[top : top + int(360 * share), left : left + int(640 * share)]
        view = cv2.resize(seen, (width, height), interpolation=cv2.INTER_AREA)
        if self.actor:
            x = (37 * self._shots) % (width - width // 5)
            view[height // 4 : -height // 4, x : x + width // 5] = 255 - view[height // 4 : -height // 4, x : x + width // 5]
        return np.asarray(view, np.uint8)

    async def _stream(self, exchange: Exchange, query: dict[str, str]) -> None:
        await exchange.head(200, "multipart/x-mixed-replace; boundary=--myboundary", headers={"Connection": "close"})
        sent = 0
        while True:
            if self.stall_after is not None and sent >= self.stall_after:
                await asyncio.sleep(0.02)
                continue
            data = self._jpeg(query)
            header = f"--myboundary\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
            await exchange.chunk(header.encode() + data + b"\r\n")
            sent += 1
            if self.hang_up:
                self.hang_up -= 1
                exchange.hang_up()
                return
            await asyncio.sleep(0.01)


def _md5(text: str) -> str:
    return hashlib.md5(text.encode(), usedforsecurity=False).hexdigest()
