"""Vision-language models behind an OpenAI-compatible server, prompted in each model's coordinate convention."""

from __future__ import annotations

from time import perf_counter
from typing import Any

from pydantic import Field

from scope_ptz.camera.base import Frame
from scope_ptz.endpoints.chat import ChatClient, ChatReply
from scope_ptz.endpoints.failures import Attempt, FailureKind
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec, Options
from scope_ptz.perception.base import ALL_SKILLS, Answer, Caption, Detections, Perception, Points, Skill
from scope_ptz.perception.models.coordinates import Convention, get_convention
from scope_ptz.perception.models.encoding import EncodedPicture, encode_frame
from scope_ptz.perception.models.vision_prompts import (
    CAPTION_PROMPT,
    detect_prompt,
    locations_schema,
    no_location_error,
    point_prompt,
    query_prompt,
    sent_size,
)
from scope_ptz.perception.models.vision_reply import VisionReply, server_errors

NO_COORDINATES = "none"
"""The value of ``coordinates`` for models that return neither boxes nor points, such as Moondream 3 served by vLLM."""


class VisionOptions(Options):
    """Options for OpenAI-compatible vision models.

    Attributes:
        max_pixels: Frames with more pixels are scaled down to this number.
        max_tokens: Maximum number of tokens in a reply.
        temperature: The sampling temperature; None selects the server's default.
        structured: Whether to request boxes and points with a JSON schema (``response_format``).
        extra: Additional request fields that the server or the model family needs, such as ``{"chat_template_kwargs":
            {"enable_thinking": false}}``.
    """

    max_pixels: int = Field(default=2048 * 1024, ge=64 * 64)
    max_tokens: int = Field(default=2048, ge=16)
    temperature: float | None = 0.0
    structured: bool = True
    extra: dict[str, Any] = Field(default_factory=dict)


class OpenAIVisionPerception(Perception):
    """Perception by a chat model that accepts images. ``convention`` is the model's coordinate convention, or None."""

    def __init__(
        self, client: ChatClient, convention: Convention | None, options: VisionOptions | None = None, name: str = "vision"
    ) -> None:
        self.name, self._client, self._convention = name, client, convention
        self._options = options or VisionOptions()
        self._rejected: set[str] = set()
        self.skills = ALL_SKILLS if convention is not None else frozenset[Skill](("caption", "query"))

    async def caption(self, frame: Frame) -> Caption:
        began = perf_counter()
        return self._read(await self._ask(await self._picture(frame), CAPTION_PROMPT), began).caption()

    async def query(self, frame: Frame, question: str) -> Answer:
        if not question.strip():
            raise PerceptionError("The question is empty.")
        began = perf_counter()
        return self._read(await self._ask(await self._picture(frame), query_prompt(question)), began).answer()

    async def detect(self, frame: Frame, description: str) -> Detections:
        convention, began = self._required_convention(), perf_counter()
        picture = await self._picture(frame)
        prompt = detect_prompt(convention, description, picture.size)
        reply = await self._ask(picture, prompt, locations_schema(convention.box_key, 4))
        return self._read(reply, began).detections(convention, picture.size)

    async def point(self, frame: Frame, description: str) -> Points:
        convention, began = self._required_convention(), perf_counter()
        picture = await self._picture(frame)
        prompt = point_prompt(convention, description, picture.size)
        reply = await self._ask(picture, prompt, locations_schema(convention.point_key, 2))
        return self._read(reply, began).points(convention, picture.size)

    async def close(self) -> None:
        await self._client.close()

    def _required_convention(self) -> Convention:
        if self._convention is None:
            raise no_location_error(self.name)
        return self._convention

    async def _picture(self, frame: Frame) -> EncodedPicture:
        size = sent_size(frame, self._convention or get_convention("generic"), self._options.max_pixels)
        return await encode_frame(frame, size)

    def _read(self, reply: tuple[ChatReply, tuple[Attempt, ...]], began: float) -> VisionReply:
        chat_reply, earlier = reply
        return VisionReply(
            self.name, chat_reply.text, began, (*earlier, *chat_reply.attempts), truncated=chat_reply.finish_reason == "length"
        )

    async def _ask(
        self, picture: EncodedPicture, prompt: str, schema: dict[str, Any] | None = None
    ) -> tuple[ChatReply, tuple[Attempt, ...]]:
        """Send a request, and repeat it without the fields that the server rejects. Return the reply and the earlier attempts.

        Rejected fields are omitted from later requests, too.
        """
        rejected, earlier = set(self._rejected), tuple[Attempt, ...]()
        while True:
            fields = self._fields(schema, rejected)
            try:
                reply = await self._complete(picture, prompt, fields)
            except PerceptionError as error:
                rejected_here = rejected_fields(error, fields)
                if not rejected_here:
                    raise PerceptionError(str(error), kind=error.kind, attempts=(*earlier, *error.attempts)) from error
                rejected |= rejected_here
                earlier += tuple(a for a in error.attempts if isinstance(a, Attempt))
            else:
                self._rejected = rejected
                return reply, earlier

    def _fields(self, schema: dict[str, Any] | None, rejected: set[str]) -> dict[str, Any]:
        """Return the request fields, without the messages. Newer hosted models require ``max_completion_tokens``."""
        limit = "max_completion_tokens" if "max_tokens" in rejected else "max_tokens"
        fields: dict[str, Any] = {limit: self._options.max_tokens, **self._options.extra}
        if self._options.temperature is not None:
            fields["temperature"] = self._options.temperature
        if schema is not None and self._options.structured:
            fields["response_format"] = {"type": "json_schema", "json_schema": {"name": "places", "schema": schema, "strict": True}}
        return {name: value for name, value in fields.items() if name not in rejected}

    async def _complete(self, picture: EncodedPicture, prompt: str, fields: dict[str, Any]) -> ChatReply:
        content = [{"type": "image_url", "image_url": {"url": picture.data_url}}, {"type": "text", "text": prompt}]
        with server_errors(self.name):
            return await self._client.complete([{"role": "user", "content": content}], extra=fields)


_FIELD_ALIASES = {"response_format": ("response_format", "json_schema", "json schema", "grammar", "guided", "structured")}
"""Words that error messages use for a request field. Other fields are recognised by name."""


def rejected_fields(error: PerceptionError, sent: dict[str, Any]) -> set[str]:
    """Return the request fields that an error message rejects.

    If a bad-request error does not name a field, the JSON schema is assumed to be the cause.
    """
    if error.kind not in (FailureKind.BAD_REQUEST, FailureKind.SERVER_ERROR):
        return set()
    words = str(error).lower()
    rejected_here = {field for field in sent if any(name in words for name in _FIELD_ALIASES.get(field, (field,)))}
    return rejected_here or ({"response_format"} & sent.keys() if error.kind == FailureKind.BAD_REQUEST else set())


def make(spec: BackendSpec) -> Perception:
    """Create the backend that a spec describes."""
    endpoint = spec.needed_endpoint()
    if spec.model:
        endpoint = endpoint.model_copy(update={"model": spec.model})
    convention = None if spec.coordinates == NO_COORDINATES else get_convention(spec.coordinates)
    return OpenAIVisionPerception(ChatClient(endpoint), convention, VisionOptions.of(spec), spec.name)
