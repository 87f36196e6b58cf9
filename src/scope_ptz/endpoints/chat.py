"""The chat client: the ``openai`` client with SCOPE's own retries, deadlines and reply parsing."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Any, cast

import anyio
from pydantic_core import to_json

from scope_ptz.endpoints.bodies import chunks, content_type, is_json, load_object, read_object, wrong_type
from scope_ptz.endpoints.chat_replies import ChatReply, RawToolCall, ReplyAssembler
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.events import DONE, Events
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure, in_brief
from scope_ptz.endpoints.retries import Caller

if TYPE_CHECKING:
    from httpx2 import Response
    from openai import AsyncOpenAI

__all__ = ["ChatClient", "ChatReply", "RawToolCall"]

K = FailureKind
EVENT_STREAM = "text/event-stream"
UNKNOWN_FIELD = 422  # the status with which strict servers reject unknown request fields
DRAIN_S = 0.1
"""Time limit for draining a finished stream, so that its connection can be reused."""


class ChatClient:
    """A client of one OpenAI-compatible server. Concurrent callers in one event loop may share it."""

    def __init__(self, endpoint: Endpoint, *, caller: Caller | None = None) -> None:
        self.endpoint = endpoint
        self.caller = caller or Caller(endpoint)
        self._openai: AsyncOpenAI | None = None
        self._counts_tokens = True

    async def complete(
        self,
        messages: list[dict[str, Any]],
        *,
        tools: list[dict[str, Any]] | None = None,
        stream: bool = False,
        extra: dict[str, Any] | None = None,
        **options: Any,
    ) -> ChatReply:
        """Return the model's reply.

        Args:
            messages: The conversation in the wire format.
            tools: Function schemas of the offered tools.
            stream: Whether to stream the reply, so that the time to its first token can be measured.
            extra: Request fields that only some servers support.
            options: Further request fields, such as ``temperature``; fields that are None are omitted.

        Raises:
            ServerFailure: The server gave no usable reply.
        """
        body: dict[str, Any] = {"model": self.endpoint.model, "messages": messages}
        if tools:
            body["tools"] = tools
        body.update((name, value) for name, value in options.items() if value is not None)
        body.update(extra or {})
        self._client()  # created before the clock starts, because importing the library takes most of a second
        began = perf_counter()
        reply, attempts = await (self._streamed(body | {"stream": True}) if stream else self._called(body))
        return reply.model_copy(update={"attempts": attempts, "seconds": perf_counter() - began})

    async def _called(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        # The body is serialised once for all attempts. The library's own serialiser is several times slower with pictures.
        content, streaming = to_json(body, inf_nan_mode="null"), bool(body.get("stream"))
        return await self.caller.call(lambda: self._exchange(content, streaming))

    async def _streamed(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        """Stream a reply that ends with the token counts, which servers send only on request.

        If the server rejects the request field for that, the request is repeated without it, and later requests omit it.
        """
        if not self._counts_tokens:
            return await self._called(body)
        try:
            return await self._called(body | {"stream_options": {"include_usage": True}})
        except ServerFailure as failure:
            if failure.kind is not K.BAD_REQUEST or not (failure.status == UNKNOWN_FIELD or "stream_options" in failure.detail):
                raise
            refused = failure.history
        try:
            reply, attempts = await self._called(body)
        except ServerFailure as failure:
            raise failure.with_history((*refused, *failure.history)) from None
        self._counts_tokens = False
        return reply, (*refused, *attempts)

    async def _exchange(self, content: bytes, streaming: bool) -> ChatReply:
        import httpx2
        from openai import AsyncStream

        began = perf_counter()
        # The library does not read the response, so that the size of the body can be limited.
        answer = await self._client().post(
            "/chat/completions", cast_to=httpx2.Response, content=content, stream=True, stream_cls=AsyncStream[Any]
        )
        response = cast(httpx2.Response, answer)
        try:
            media_type = content_type(response)
            if media_type == EVENT_STREAM or (not media_type and streaming):
                return await self._read_stream(response, began)
            if not is_json(media_type):
                raise wrong_type(media_type, self.endpoint, response.status_code)
            assembler = ReplyAssembler(self.endpoint)
            assembler.add(await read_object(response, self.endpoint))
            return assembler.reply()
        finally:
            await response.aclose()

    async def _read_stream(self, response: Response, began: float) -> ChatReply:
        assembler, first_token_s, done = ReplyAssembler(self.endpoint), None, False
        head, events = b"", Events()
        pieces = chunks(response, self.endpoint)

        def take(stream: list[bytes]) -> bool:
            nonlocal first_token_s
            for data in stream:
                if data == DONE:
                    return True
                has_content = assembler.add(load_object(data, self.endpoint, response.status_code))
                if has_content and first_token_s is None:
                    first_token_s = perf_counter() - began
            return False

        try:
            async for piece in pieces:
                head = head or piece
                done = take(events.feed(piece))
                if done:
                    break
            if done:
                with anyio.move_on_after(DRAIN_S):
                    async for _ in pieces:
                        pass
        finally:
            await pieces.aclose()
        done = done or take(events.end())
        if not done and assembler.finish_reason is None:
            raise self._unfinished_stream(assembler, head, response.status_code)
        return assembler.reply().model_copy(update={"first_token_s": first_token_s})

    def _unfinished_stream(self, assembler: ReplyAssembler, head: bytes, status: int) -> ServerFailure:
        """Return the failure for a stream that was cut off, or for a reply that is not an event stream.

        Args:
            assembler: The chunks received so far.
            head: The first bytes of the reply.
            status: The HTTP status.
        """
        where = self.endpoint.url
        if assembler.pieces:
            return ServerFailure(K.CUT_OFF, where=where, status=status, detail="the stream ended before the answer did")
        if not head.strip():
            return ServerFailure(K.EMPTY, where=where, status=status, detail="an empty body")
        detail = f"not an event stream: {in_brief(head[:200].decode(errors='replace'), self.endpoint.secret)}"
        return ServerFailure(K.MALFORMED, where=where, status=status, detail=detail)

    def _client(self) -> AsyncOpenAI:
        if self._openai is None:
            from openai import AsyncOpenAI

            from scope_ptz.endpoints.transport import make_client

            # The transport adds the key, and removes everything that comes from OPENAI_... variables.
            client = make_client(self.endpoint)
            self._openai = AsyncOpenAI(
                api_key="unused", base_url=self.endpoint.url, max_retries=0, http_client=client, timeout=client.timeout
            )
        return self._openai

    async def close(self) -> None:
        """Close the connections. The next request opens new ones."""
        if self._openai is not None:
            client, self._openai = self._openai, None
            await client.close()
