"""What the program adds to a call of a model server: per planner turn beyond a bare call of the ``openai`` client, per look
beyond JPEG encoding and a bare HTTP call.

A loopback server in a process of its own answers at once. Bare calls and ours send the same conversation and the same picture,
and take turns within one run, so that whatever else the machine does falls on both. Every look is at a fresh frame, which has to
be encoded. The overhead is the median of the differences within pairs: on a busy machine both of a pair are slow.
"""

from __future__ import annotations

import argparse
import asyncio
import base64
import gc
import json
import multiprocessing
import random
import statistics
from collections.abc import Awaitable, Callable
from multiprocessing.connection import Connection
from time import perf_counter
from typing import Any

import cv2
import httpx2
import numpy as np
import openai

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.geometry import AXIS_M5075_G, Limits, Perspective, Pose
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.models.encoding import JPEG_QUALITY
from scope_ptz.planner.base import Briefing, Exchange, State, ToolCall, ToolOutcome
from scope_ptz.planner.chat.chat_messages import build_messages
from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner
from scope_ptz.tools.registry import schemas

TARGET_MS = 1.0
COORDINATES = ("qwen3-vl", "qwen2.5-vl")
"""Models that answer in pixels (qwen2.5-vl) get a picture that is resized first, which is counted as overhead too."""
MODEL = "loopback"
CALL = {"name": "adjust_ptz", "arguments": '{"pan_deg": 15}'}
WORDS = ("I ", "turn ", "to ", "the ", "right ", "to ", "see ", "more ", "of ", "the ", "road.")
TOKENS = {"prompt_tokens": 900, "completion_tokens": 20, "total_tokens": 920}
HEAD = {"id": "c", "created": 1, "model": MODEL}


def _completion(message: dict[str, Any], ending: str) -> bytes:
    choice = {"index": 0, "message": {"role": "assistant", **message}, "finish_reason": ending}
    return json.dumps({**HEAD, "object": "chat.completion", "choices": [choice], "usage": TOKENS}).encode()


def _stream() -> bytes:
    call = {"index": 0, "id": "call0", "type": "function", "function": CALL}
    deltas: list[tuple[dict[str, Any], str | None]] = [({"role": "assistant", "content": ""}, None)]
    deltas += [({"content": word}, None) for word in WORDS]
    deltas += [({"tool_calls": [call]}, None), ({}, "tool_calls")]
    chunks = [
        {**HEAD, "object": "chat.completion.chunk", "choices": [{"index": 0, "delta": d, "finish_reason": e}]} for d, e in deltas
    ]
    chunks.append({**HEAD, "object": "chat.completion.chunk", "choices": [], "usage": TOKENS})
    return b"".join(b"data: %s\n\n" % json.dumps(chunk).encode() for chunk in chunks) + b"data: [DONE]\n\n"


PLANNED = _completion({"content": None, "tool_calls": [{"id": "call0", "type": "function", "function": CALL}]}, "tool_calls")
STREAMED = _stream()
BOXES = [[100, 100, 200, 200], [300, 300, 400, 450]]
SEEN = _completion({"content": json.dumps([{"bbox_2d": box, "label": "cone"} for box in BOXES])}, "stop")
DETECTED = json.dumps(
    {"objects": [dict(zip(("x_min", "y_min", "x_max", "y_max"), (0.1, 0.1, 0.2, 0.2), strict=True))] * 2}
).encode()


class _Server(asyncio.Protocol):
    """The least that is an HTTP server: a request in, a reply of fixed bytes out."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport, self.held, self.wanted = transport, bytearray(), -1

    def data_received(self, data: bytes) -> None:
        self.held += data
        if self.wanted < 0 and (end := self.held.find(b"\r\n\r\n")) >= 0:
            head = bytes(self.held[:end]).lower()
            self.wanted = end + 4 + int(head.split(b"content-length:")[1].split(b"\r\n")[0])
        if 0 <= self.wanted <= len(self.held):
            self._answer(bytes(self.held[: self.wanted]))
            self.held, self.wanted = bytearray(), -1

    def _answer(self, request: bytes) -> None:
        kind = b"application/json"
        if request.startswith(b"POST /v1/detect"):
            reply = DETECTED
        elif b"image_url" in request:
            reply = SEEN
        elif b'"stream":true' in request[-200_000:]:
            kind, reply = b"text/event-stream", STREAMED
        else:
            reply = PLANNED
        assert isinstance(self.transport, asyncio.Transport)
        self.transport.write(b"HTTP/1.1 200 OK\r\nContent-Type: %s\r\nContent-Length: %d\r\n\r\n%s" % (kind, len(reply), reply))


def _serve(tell: Connection) -> None:
    async def work() -> None:
        server = await asyncio.get_running_loop().create_server(_Server, "127.0.0.1", 0)
        tell.send(server.sockets[0].getsockname()[1])
        await server.serve_forever()

    asyncio.run(work())


def _state(exchanges: int) -> State:
    """A conversation in its midst."""
    call = ToolCall(id="call0", name="adjust_ptz", arguments={"pan_deg": 15})
    result = {"pose": {"pan_deg": 15.0, "tilt_deg": 0.0, "zoom": 1.0}, "clamped": [], "notes": []}
    history = tuple(Exchange(outcomes=(ToolOutcome(call=call, result=result),)) for _ in range(exchanges))
    briefing = Briefing(presets=("gate", "highway"), pose=Pose(), limits=Limits())
    return State(instruction="count all cones", briefing=briefing, history=history, tools=tuple(schemas()))


Work = Callable[[], Awaitable[object]]


async def _compare(bare: Work, ours: Work, rounds: int, gap: random.Random) -> tuple[list[float], list[float]]:
    """Milliseconds of both, taken in turns, which of the two first being drawn by lot."""
    times: dict[str, list[float]] = {"bare": [], "ours": []}
    pair = [("bare", bare), ("ours", ours)]
    for index in range(rounds + 20):
        gap.shuffle(pair)
        for name, work in pair:
            began = perf_counter()
            await work()
            if index >= 20:  # warmed up
                times[name].append(1e3 * (perf_counter() - began))
    return times["bare"], times["ours"]


class _Frames:
    """Fresh frames of 1280x720, made before the clock runs: each is a shift of one textured picture."""

    def __init__(self) -> None:
        noise = np.random.default_rng(1).integers(0, 255, (90, 160, 3), np.uint8)
        self._image = cv2.resize(noise, (1280, 720), interpolation=cv2.INTER_CUBIC)
        self._ready: list[Frame] = []

    def prepare(self, number: int) -> None:
        hfov_deg = AXIS_M5075_G.hfov_deg(1.0)
        view = Perspective(0.0, 0.0, hfov_deg, 1280, 720)
        images = [np.roll(self._image, 7 * i, axis=1) for i in range(number)]
        self._ready = [Frame(image, Pose(), hfov_deg, float(i), view) for i, image in enumerate(images)]

    def next(self) -> Frame:
        return self._ready.pop()


def _data_url(frame: Frame) -> str:
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return "data:image/jpeg;base64," + base64.b64encode(jpeg.tobytes()).decode()


async def _planner_cases(url: str, bare: openai.AsyncOpenAI) -> dict[str, tuple[Work, Work]]:
    cases: dict[str, tuple[Work, Work]] = {}
    for exchanges in (0, 10):
        for stream in (False, True):
            planner, state = ChatPlanner(Endpoint(url=url, model=MODEL), ChatOptions(stream=stream)), _state(exchanges)
            request: dict[str, Any] = {
                "model": MODEL,
                "messages": build_messages(state, planner.prompt),
                "tools": list(state.tools),
            }

            async def whole(request: dict[str, Any] = request) -> object:
                return await bare.chat.completions.create(**request)

            async def streamed(request: dict[str, Any] = request) -> object:
                stream = await bare.chat.completions.create(**request, stream=True, stream_options={"include_usage": True})
                return [chunk async for chunk in stream]

            def ours(planner: ChatPlanner = planner, state: State = state) -> Awaitable[object]:
                return planner.step(state)

            how = "streaming" if stream else "whole"
            cases[f"turn, {how}, after {exchanges} steps"] = (streamed if stream else whole, ours)
    return cases


async def _perception_cases(url: str, bare: openai.AsyncOpenAI, frames: _Frames) -> dict[str, tuple[Work, Work]]:
    http = httpx2.AsyncClient()
    at = Endpoint(url=url, model=MODEL)
    moondream = make_backend(BackendSpec(name="moondream", backend="moondream", endpoint=at))
    kinds = {
        name: BackendSpec(name=name, backend="openai_vision", model=MODEL, endpoint=at, coordinates=name) for name in COORDINATES
    }
    visions = {name: make_backend(spec) for name, spec in kinds.items()}

    async def plain() -> object:
        reply = await http.post(f"{url}/detect", json={"image_url": _data_url(frames.next()), "object": "cones", "stream": False})
        return reply.json()

    async def chat() -> object:
        picture = {"type": "image_url", "image_url": {"url": _data_url(frames.next())}}
        message: Any = {"role": "user", "content": [picture, {"type": "text", "text": "Locate every cone, as JSON."}]}
        return await bare.chat.completions.create(model=MODEL, messages=[message])

    cases: dict[str, tuple[Work, Work]] = {"perception call, Moondream": (plain, lambda: moondream.detect(frames.next(), "cones"))}
    for name in COORDINATES:
        cases[f"perception call, {name} over chat"] = (chat, lambda vision=visions[name]: vision.detect(frames.next(), "cones"))  # type: ignore[misc]
    return cases


async def _measure(url: str, rounds: int) -> None:
    bare, frames, gap = openai.AsyncOpenAI(api_key="none", base_url=url, max_retries=0), _Frames(), random.Random(1)
    cases = await _planner_cases(url, bare) | await _perception_cases(url, bare, frames)
    print(f"{'':30}{'bare':>9}{'ours':>9}{'overhead':>10}   (medians, ms)")
    good = True
    for name, (theirs, ours) in cases.items():
        perceiving = name.startswith("perception")
        if perceiving:
            frames.prepare(2 * (rounds // 3 + 20))
        gc.collect()
        bare_ms, ours_ms = await _compare(theirs, ours, rounds // 3 if perceiving else rounds, gap)
        over = statistics.median(ours - bare for ours, bare in zip(ours_ms, bare_ms, strict=True))
        good = good and over <= TARGET_MS
        print(f"{name:30}{statistics.median(bare_ms):9.2f}{statistics.median(ours_ms):9.2f}{over:+10.2f}")
    print(f"Target: at most {TARGET_MS:g} ms each. {'Met.' if good else 'MISSED.'}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=300, help="calls of each kind (perception calls: a third of it)")
    rounds = parser.parse_args().rounds
    hear, tell = multiprocessing.Pipe(duplex=False)
    server = multiprocessing.get_context("spawn").Process(target=_serve, args=(tell,), daemon=True)
    server.start()
    try:
        asyncio.run(_measure(f"http://127.0.0.1:{hear.recv()}/v1", rounds))
    finally:
        server.terminate()
        server.join()


if __name__ == "__main__":
    main()
