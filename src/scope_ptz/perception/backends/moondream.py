"""Moondream over HTTP: moondream-station, the cloud, or any server with the same four endpoints."""

from __future__ import annotations

import json
from time import perf_counter
from typing import Any

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.endpoints.http import JsonClient
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec, Options
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.perception.models.coordinates import MAX_LOCATIONS, fit_size, get_convention
from scope_ptz.perception.models.encoding import encode_frame
from scope_ptz.perception.models.vision_prompts import one_line
from scope_ptz.perception.models.vision_reply import VisionReply, server_errors

KEY_HEADER = "X-Moondream-Auth"
UNIT = get_convention("unit")


class MoondreamOptions(Options):
    """Options for the Moondream backend.

    Attributes:
        max_pixels: Frames with more pixels are scaled down to this number. The model itself processes only a few crops of 378 x 378
            pixels.
        max_objects: Maximum number of objects to request; None selects the server's limit.
        reasoning: Whether Moondream 3 reasons before it answers a question; None selects the server's default.
        caption_length: "short", "normal" or "long".
    """

    max_pixels: int = 2048 * 2048
    max_objects: int | None = MAX_LOCATIONS
    reasoning: bool | None = None
    caption_length: str = "short"


class MoondreamPerception(Perception):
    """Perception through Moondream's own HTTP protocol. Its coordinates are in [0, 1], and it returns neither scores nor labels."""

    def __init__(self, client: JsonClient, options: MoondreamOptions | None = None, name: str = "moondream") -> None:
        self.name, self._client, self._options = name, client, options or MoondreamOptions()
        self._limit = self._options.max_objects

    async def caption(self, frame: Frame) -> Caption:
        return (await self._ask(frame, "caption", {"length": self._options.caption_length}, "caption")).caption()

    async def query(self, frame: Frame, question: str) -> Answer:
        if not question.strip():
            raise PerceptionError("The question is empty.")
        reasoning = {} if self._options.reasoning is None else {"reasoning": self._options.reasoning}
        return (await self._ask(frame, "query", {"question": question.strip(), **reasoning}, "answer")).answer()

    async def detect(self, frame: Frame, description: str) -> Detections:
        detections = (await self._locate(frame, "detect", description, "objects")).detections(UNIT, (1, 1))
        complete = self._limit is None or len(detections.boxes) < self._limit
        return detections if complete else detections.model_copy(update={"complete": False})

    async def point(self, frame: Frame, description: str) -> Points:
        return (await self._locate(frame, "point", description, "points")).points(UNIT, (1, 1))

    async def close(self) -> None:
        await self._client.close()

    async def _locate(self, frame: Frame, path: str, description: str, reply_field: str) -> VisionReply:
        """Request boxes or points. If the server rejects ``max_objects``, retry without it, and omit it from then on."""
        fields: dict[str, Any] = {"object": one_line(description)}
        if self._limit is None:
            return await self._ask(frame, path, fields, reply_field)
        try:
            return await self._ask(frame, path, {**fields, "settings": {"max_objects": self._limit}}, reply_field)
        except PerceptionError as error:
            if error.kind != FailureKind.BAD_REQUEST:
                raise
            reply = await self._ask(frame, path, fields, reply_field)
            self._limit = None
            return reply.with_earlier_attempts(error)

    async def _ask(self, frame: Frame, path: str, fields: dict[str, Any], reply_field: str) -> VisionReply:
        """Send one request, and return the text or the JSON data in the response field ``reply_field`` as a reply."""
        began = perf_counter()
        picture = await encode_frame(frame, fit_size(frame.width, frame.height, self._options.max_pixels))
        body = _body(picture.data_url, {**fields, "stream": False})
        with server_errors(self.name):
            data, attempts = await self._client.post(path, body)
        return self._reply(data, reply_field, began, attempts)

    def _reply(self, data: dict[str, Any], reply_field: str, began: float, attempts: tuple[Attempt, ...]) -> VisionReply:
        value = data.get(reply_field)
        if reply_field in ("answer", "caption"):
            if not isinstance(value, str):
                raise VisionReply(self.name, json.dumps(data, default=str), began, attempts).parse_error(f"no {reply_field}")
            return VisionReply(self.name, value, began, attempts)
        reply = VisionReply(self.name, json.dumps({"objects": value}), began, attempts)
        if not isinstance(value, list) or not all(isinstance(v, dict) for v in value):
            raise VisionReply(self.name, json.dumps(data, default=str), began, attempts).parse_error(f"no list of {reply_field}")
        return reply


def _body(data_url: str, fields: dict[str, Any]) -> bytes:
    """Encode a request body as JSON. The image bypasses the JSON encoder, because base64 text is long and needs no escaping."""
    rest = json.dumps(fields, separators=(",", ":"), ensure_ascii=False)[1:]
    return f'{{"image_url":"{data_url}",{rest}'.encode()


def make(spec: BackendSpec) -> Perception:
    """Create the backend that a spec describes."""
    client = JsonClient(spec.needed_endpoint(), key_header=KEY_HEADER)
    return MoondreamPerception(client, MoondreamOptions.of(spec), spec.name)
