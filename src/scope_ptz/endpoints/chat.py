"""The chat client, which is the ``openai`` client with SCOPE's own retries, deadlines and reply parsing."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Any, cast

import anyio
from pydantic_core import to_json

from scope_ptz.endpoints.bodies import chunks, content_type, is_json, load_object, read_object, wrong_type_failure
from scope_ptz.endpoints.chat_replies import ChatReply, RawToolCall, ReplyAssembler
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.events import DONE, EventParser
from scope_ptz.endpoints.failures import Attempt, FailureKind, ServerFailure, one_line_excerpt
from scope_ptz.endpoints.retries import Caller

if TYPE_CHECKING:
    from httpx2 import Response
    from openai import AsyncOpenAI

__all__ = ["ChatClient", "ChatReply", "RawToolCall"]

EVENT_STREAM = "text/event-stream"
UNKNOWN_FIELD_STATUS = 422  # the status code with which strict servers reject unknown request fields
DRAIN_S = 0.1
"""Maximum time in seconds to read the rest of a finished stream, so that its connection can be reused."""


class ChatClient:
    """A client for an OpenAI-compatible server. Concurrent callers in one event loop may share it."""

    def __init__(self, endpoint: Endpoint, *, caller: Caller | None = None) -> None:
        self.endpoint = endpoint
        self.caller = caller or Caller(endpoint)
        self._openai: AsyncOpenAI | None = None
        self._usage_supported = True

    async def complete(
        self,
        messages: list[dict[str, Any]],
        *,
        tools: list[dict[str, Any]] | None = None,
        stream: bool = False,
        extra: dict[str, Any] | None = None,
        **options: Any,
    ) -> ChatReply:
        """Request a chat completion, and return the model's reply.

        Args:
            messages: The conversation in the wire format.
            tools: The function schemas of the available tools.
            stream: Whether to stream the reply, so that the time to the first token can be measured.
            extra: Request fields that only some servers support.
            options: Other request fields, such as ``temperature``; fields that are None are omitted.

        Raises:
            ServerFailure: The server did not return a usable reply.
        """
        body: dict[str, Any] = {"model": self.endpoint.model, "messages": messages}
        if tools:
            body["tools"] = tools
        body.update((name, value) for name, value in options.items() if value is not None)
        body.update(extra or {})
        self._client()  # create the client before timing starts, because importing the library takes most of a second
        began = perf_counter()
        reply, attempts = await (self._post_streaming(body | {"stream": True}) if stream else self._post(body))
        return reply.model_copy(update={"attempts": attempts, "seconds": perf_counter() - began})

    async def _post(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        # Serialise the body once for all attempts. The library's own serialiser is several times slower with pictures.
        content, streaming = to_json(body, inf_nan_mode="null"), bool(body.get("stream"))
        return await self.caller.call(lambda: self._exchange(content, streaming))

    async def _post_streaming(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        """Stream a reply, and ask the server to send token counts at the end.

        If the server rejects ``stream_options``, repeat the request without it, and omit it from later requests.
        """
        if not self._usage_supported:
            return await self._post(body)
        try:
            return await self._post(body | {"stream_options": {"include_usage": True}})
        except ServerFailure as failure:
            if failure.kind is not FailureKind.BAD_REQUEST or not (
                failure.status == UNKNOWN_FIELD_STATUS or "stream_options" in failure.detail
            ):
                raise
            rejected = failure.history
        try:
            reply, attempts = await self._post(body)
        except ServerFailure as failure:
            raise failure.with_history((*rejected, *failure.history)) from None
        self._usage_supported = False
        return reply, (*rejected, *attempts)

    async def _exchange(self, content: bytes, streaming: bool) -> ChatReply:
        import httpx2
        from openai import AsyncStream

        began = perf_counter()
        # With stream=True, the library does not read the body, so this client can limit its size.
        answer = await self._client().post(
            "/chat/completions", cast_to=httpx2.Response, content=content, stream=True, stream_cls=AsyncStream[Any]
        )
        response = cast(httpx2.Response, answer)
        try:
            media_type = content_type(response)
            if media_type == EVENT_STREAM or (not media_type and streaming):
                return await self._read_stream(response, began)
            if not is_json(media_type):
                raise wrong_type_failure(media_type, self.endpoint, response.status_code)
            assembler = ReplyAssembler(self.endpoint)
            assembler.add(await read_object(response, self.endpoint))
            return assembler.reply()
        finally:
            await response.aclose()

    async def _read_stream(self, response: Response, began: float) -> ChatReply:
        assembler, first_token_s, is_done = ReplyAssembler(self.endpoint), None, False
        head, events = b"", EventParser()
        pieces = chunks(response, self.endpoint)

        def add(stream: list[bytes]) -> bool:
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
                is_done = add(events.feed(piece))
                if is_done:
                    break
            if is_done:
                with anyio.move_on_after(DRAIN_S):
                    async for _ in pieces:
                        pass
        finally:
            await pieces.aclose()
        is_done = is_done or add(events.end())
        if not is_done and assembler.finish_reason is None:
            raise self._unfinished_stream(assembler, head, response.status_code)
        return assembler.reply().model_copy(update={"first_token_s": first_token_s})

    def _unfinished_stream(self, assembler: ReplyAssembler, head: bytes, status: int) -> ServerFailure:
        """Return a failure for a stream that was cut off, or for a reply that is not an event stream.

        Args:
            assembler: The chunks received so far.
            head: The first bytes of the reply.
            status: The HTTP status code.
        """
        where = self.endpoint.url
        if assembler.chunk_count:
            return ServerFailure(
                FailureKind.CUT_OFF, where=where, status=status, detail="the stream ended before the reply was complete"
            )
        if not head.strip():
            return ServerFailure(FailureKind.EMPTY, where=where, status=status, detail="an empty body")
        detail = f"not an event stream: {one_line_excerpt(head[:200].decode(errors='replace'), self.endpoint.secret)}"
        return ServerFailure(FailureKind.MALFORMED, where=where, status=status, detail=detail)

    def _client(self) -> AsyncOpenAI:
        if self._openai is None:
            from openai import AsyncOpenAI

            from scope_ptz.endpoints.transport import make_client

            # The transport adds the key, and removes headers that the library takes from OPENAI_... variables.
            client = make_client(self.endpoint)
            self._openai = AsyncOpenAI(
                api_key="unused", base_url=self.endpoint.url, max_retries=0, http_client=client, timeout=client.timeout
            )
        return self._openai

    async def close(self) -> None:
        """Close the connections. The next request opens new connections."""
        if self._openai is not None:
            client, self._openai = self._openai, None
            await client.close()
