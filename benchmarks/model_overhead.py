"""Measure SCOPE's overhead in calls to a model server.

Planner turns are compared with bare calls of the ``openai`` client, and perception calls with JPEG encoding followed by a bare HTTP
call. A loopback server in a separate process replies immediately. Bare calls and SCOPE's calls send the same conversation and
images of the same size. They alternate, so that other load on the machine affects both. Each perception call gets a new frame,
which must be encoded. The overhead is the median of the differences within pairs of calls.
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
from scope_ptz.perception.base import Perception
from scope_ptz.perception.models.encoding import JPEG_QUALITY
from scope_ptz.planner.base import Briefing, Exchange, State, ToolCall, ToolOutcome
from scope_ptz.planner.chat.chat_messages import build_messages
from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner
from scope_ptz.tools.registry import schemas

TARGET_MS = 1.0
"""Maximum acceptable overhead of a call in milliseconds."""
COORDINATES = ("qwen3-vl", "qwen2.5-vl")
"""Coordinate conventions of vision models. For qwen2.5-vl, images are also resized, and this counts as overhead."""
WARM_UP_ROUNDS = 20
MODEL = "loopback"
CALL = {"name": "adjust_ptz", "arguments": '{"pan_deg": 15}'}
WORDS = ("I ", "turn ", "to ", "the ", "right ", "to ", "see ", "more ", "of ", "the ", "road.")
TOKENS = {"prompt_tokens": 900, "completion_tokens": 20, "total_tokens": 920}
COMPLETION_FIELDS = {"id": "c", "created": 1, "model": MODEL}


def _completion(message: dict[str, Any], finish_reason: str) -> bytes:
    choice = {"index": 0, "message": {"role": "assistant", **message}, "finish_reason": finish_reason}
    return json.dumps({**COMPLETION_FIELDS, "object": "chat.completion", "choices": [choice], "usage": TOKENS}).encode()


def _stream() -> bytes:
    call = {"index": 0, "id": "call0", "type": "function", "function": CALL}
    deltas: list[tuple[dict[str, Any], str | None]] = [({"role": "assistant", "content": ""}, None)]
    deltas += [({"content": word}, None) for word in WORDS]
    deltas += [({"tool_calls": [call]}, None), ({}, "tool_calls")]
    chunks = [
        {**COMPLETION_FIELDS, "object": "chat.completion.chunk", "choices": [{"index": 0, "delta": d, "finish_reason": e}]}
        for d, e in deltas
    ]
    chunks.append({**COMPLETION_FIELDS, "object": "chat.completion.chunk", "choices": [], "usage": TOKENS})
    return b"".join(b"data: %s\n\n" % json.dumps(chunk).encode() for chunk in chunks) + b"data: [DONE]\n\n"


PLANNER_REPLY = _completion({"content": None, "tool_calls": [{"id": "call0", "type": "function", "function": CALL}]}, "tool_calls")
STREAMED_PLANNER_REPLY = _stream()
BOXES = [[100, 100, 200, 200], [300, 300, 400, 450]]
VISION_REPLY = _completion({"content": json.dumps([{"bbox_2d": box, "label": "cone"} for box in BOXES])}, "stop")
DETECT_REPLY = json.dumps(
    {"objects": [dict(zip(("x_min", "y_min", "x_max", "y_max"), (0.1, 0.1, 0.2, 0.2), strict=True))] * 2}
).encode()


class _Server(asyncio.Protocol):
    """A minimal HTTP server that answers each request with a fixed reply."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport, self.received, self.request_length = transport, bytearray(), -1

    def data_received(self, data: bytes) -> None:
        self.received += data
        if self.request_length < 0 and (end := self.received.find(b"\r\n\r\n")) >= 0:
            head = bytes(self.received[:end]).lower()
            self.request_length = end + 4 + int(head.split(b"content-length:")[1].split(b"\r\n")[0])
        if 0 <= self.request_length <= len(self.received):
            self._answer(bytes(self.received[: self.request_length]))
            self.received, self.request_length = bytearray(), -1

    def _answer(self, request: bytes) -> None:
        kind = b"application/json"
        if request.startswith(b"POST /v1/detect"):
            reply = DETECT_REPLY
        elif b"image_url" in request:
            reply = VISION_REPLY
        elif b'"stream":true' in request[-200_000:]:
            kind, reply = b"text/event-stream", STREAMED_PLANNER_REPLY
        else:
            reply = PLANNER_REPLY
        assert isinstance(self.transport, asyncio.Transport)
        self.transport.write(b"HTTP/1.1 200 OK\r\nContent-Type: %s\r\nContent-Length: %d\r\n\r\n%s" % (kind, len(reply), reply))


def _serve(port_sender: Connection) -> None:
    async def work() -> None:
        server = await asyncio.get_running_loop().create_server(_Server, "127.0.0.1", 0)
        port_sender.send(server.sockets[0].getsockname()[1])
        await server.serve_forever()

    asyncio.run(work())


def _state(exchanges: int) -> State:
    """Return the state of a conversation after a number of exchanges."""
    call = ToolCall(id="call0", name="adjust_ptz", arguments={"pan_deg": 15})
    result = {"pose": {"pan_deg": 15.0, "tilt_deg": 0.0, "zoom": 1.0}, "clamped": [], "notes": []}
    history = tuple(Exchange(outcomes=(ToolOutcome(call=call, result=result),)) for _ in range(exchanges))
    briefing = Briefing(presets=("gate", "highway"), pose=Pose(), limits=Limits())
    return State(instruction="count all cones", briefing=briefing, history=history, tools=tuple(schemas()))


Call = Callable[[], Awaitable[object]]


async def _compare(bare: Call, scope_call: Call, rounds: int, rng: random.Random) -> tuple[list[float], list[float]]:
    """Return the milliseconds of both calls in each round. Their order in a round is random."""
    times: dict[str, list[float]] = {"bare": [], "scope": []}
    pair = [("bare", bare), ("scope", scope_call)]
    for index in range(rounds + WARM_UP_ROUNDS):
        rng.shuffle(pair)
        for name, call in pair:
            start = perf_counter()
            await call()
            if index >= WARM_UP_ROUNDS:
                times[name].append(1e3 * (perf_counter() - start))
    return times["bare"], times["scope"]


class _Frames:
    """Different frames of 1280x720 pixels, prepared before the measurement. Each frame is a shifted copy of one textured image."""

    def __init__(self) -> None:
        noise = np.random.default_rng(1).integers(0, 255, (90, 160, 3), np.uint8)
        self._image = cv2.resize(noise, (1280, 720), interpolation=cv2.INTER_CUBIC)
        self._ready: list[Frame] = []

    def prepare(self, number: int) -> None:
        """Prepare the given number of frames."""
        hfov_deg = AXIS_M5075_G.hfov_deg(1.0)
        view = Perspective(0.0, 0.0, hfov_deg, 1280, 720)
        images = [np.roll(self._image, 7 * i, axis=1) for i in range(number)]
        self._ready = [Frame(image, Pose(), hfov_deg, float(i), view) for i, image in enumerate(images)]

    def next(self) -> Frame:
        """Return a frame that has not been used."""
        return self._ready.pop()


def _data_url(frame: Frame) -> str:
    _, jpeg = cv2.imencode(".jpg", cv2.cvtColor(frame.image, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return "data:image/jpeg;base64," + base64.b64encode(jpeg.tobytes()).decode()


async def _planner_cases(url: str, client: openai.AsyncOpenAI) -> dict[str, tuple[Call, Call]]:
    cases: dict[str, tuple[Call, Call]] = {}
    for exchanges in (0, 10):
        for stream in (False, True):
            planner, state = ChatPlanner(Endpoint(url=url, model=MODEL), ChatOptions(stream=stream)), _state(exchanges)
            request: dict[str, Any] = {
                "model": MODEL,
                "messages": build_messages(state, planner.prompt),
                "tools": list(state.tools),
            }

            async def bare(request: dict[str, Any] = request) -> object:
                return await client.chat.completions.create(**request)

            async def bare_stream(request: dict[str, Any] = request) -> object:
                stream = await client.chat.completions.create(**request, stream=True, stream_options={"include_usage": True})
                return [chunk async for chunk in stream]

            def scope_call(planner: ChatPlanner = planner, state: State = state) -> Awaitable[object]:
                return planner.step(state)

            mode = "streaming" if stream else "not streaming"
            cases[f"turn, {mode}, after {exchanges} steps"] = (bare_stream if stream else bare, scope_call)
    return cases


async def _perception_cases(url: str, client: openai.AsyncOpenAI, frames: _Frames) -> dict[str, tuple[Call, Call]]:
    http = httpx2.AsyncClient()
    endpoint = Endpoint(url=url, model=MODEL)
    moondream = make_backend(BackendSpec(name="moondream", backend="moondream", endpoint=endpoint))
    specs = {
        name: BackendSpec(name=name, backend="openai_vision", model=MODEL, endpoint=endpoint, coordinates=name)
        for name in COORDINATES
    }
    visions = {name: make_backend(spec) for name, spec in specs.items()}

    async def bare_detect() -> object:
        reply = await http.post(f"{url}/detect", json={"image_url": _data_url(frames.next()), "object": "cones", "stream": False})
        return reply.json()

    async def bare_chat() -> object:
        picture = {"type": "image_url", "image_url": {"url": _data_url(frames.next())}}
        message: Any = {"role": "user", "content": [picture, {"type": "text", "text": "Locate every cone, as JSON."}]}
        return await client.chat.completions.create(model=MODEL, messages=[message])

    cases: dict[str, tuple[Call, Call]] = {
        "perception call, Moondream": (bare_detect, lambda: moondream.detect(frames.next(), "cones"))
    }
    for name in COORDINATES:

        def scope_call(vision: Perception = visions[name]) -> Awaitable[object]:
            return vision.detect(frames.next(), "cones")

        cases[f"perception call, {name} over chat"] = (bare_chat, scope_call)
    return cases


async def _measure(url: str, rounds: int) -> None:
    client, frames, rng = openai.AsyncOpenAI(api_key="none", base_url=url, max_retries=0), _Frames(), random.Random(1)
    cases = await _planner_cases(url, client) | await _perception_cases(url, client, frames)
    print(f"{'':36}{'bare':>9}{'SCOPE':>9}{'overhead':>10}   (medians, ms)")
    met = True
    for name, (bare, scope_call) in cases.items():
        is_perception = name.startswith("perception")
        if is_perception:
            frames.prepare(2 * (rounds // 3 + WARM_UP_ROUNDS))
        gc.collect()
        bare_ms, scope_ms = await _compare(bare, scope_call, rounds // 3 if is_perception else rounds, rng)
        overhead_ms = statistics.median(a - b for a, b in zip(scope_ms, bare_ms, strict=True))
        met = met and overhead_ms <= TARGET_MS
        print(f"{name:36}{statistics.median(bare_ms):9.2f}{statistics.median(scope_ms):9.2f}{overhead_ms:+10.2f}")
    print(f"Target: at most {TARGET_MS:g} ms each. {'Met.' if met else 'MISSED.'}")


def main() -> None:
    """Start the server, measure the overheads, and print them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--rounds",
        type=int,
        default=300,
        help="number of planner turns per case; perception calls run a third as often (default: 300)",
    )
    rounds = parser.parse_args().rounds
    port_receiver, port_sender = multiprocessing.Pipe(duplex=False)
    server = multiprocessing.get_context("spawn").Process(target=_serve, args=(port_sender,), daemon=True)
    server.start()
    try:
        asyncio.run(_measure(f"http://127.0.0.1:{port_receiver.recv()}/v1", rounds))
    finally:
        server.terminate()
        server.join()


if __name__ == "__main__":
    main()
