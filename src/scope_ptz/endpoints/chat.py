"""The chat client: the ``openai`` client with this project's retries, deadlines and parsing of replies."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Any, cast

import anyio
from pydantic_core import to_json

from scope_ptz.endpoints.bodies import chunks, content_type, is_json, load_object, read_object, wrong_type
from scope_ptz.endpoints.chat_replies import ChatReply, Gathering, RawToolCall
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
UNKNOWN_FIELD = 422
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
            stream: Whether to stream the reply, which measures the time to its first token. The reply is the same.
            extra: Request fields that only some servers know.
            options: Further request fields, such as ``temperature``; those that are None are left out.

        Raises:
            ServerFailure: There was no usable reply.
        """
        body: dict[str, Any] = {"model": self.endpoint.model, "messages": messages}
        if tools:
            body["tools"] = tools
        body.update((name, value) for name, value in options.items() if value is not None)
        body.update(extra or {})
        self._client()  # made before the clock starts, because importing the library takes most of a second
        began = perf_counter()
        reply, attempts = await (self._streamed(body | {"stream": True}) if stream else self._called(body))
        return reply.model_copy(update={"attempts": attempts, "seconds": perf_counter() - began})

    async def _called(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        # Serialised once, by a serialiser that is fast with pictures; the library's own takes several times as long.
        content, streaming = to_json(body, inf_nan_mode="null"), bool(body.get("stream"))
        return await self.caller.call(lambda: self._exchange(content, streaming))

    async def _streamed(self, body: dict[str, Any]) -> tuple[ChatReply, tuple[Attempt, ...]]:
        """Stream with a token count at the end, which servers send only on request.

        A server that refuses this request field is asked without it, now and from then on.
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
            raise failure.after((*refused, *failure.history)) from None
        self._counts_tokens = False
        return reply, (*refused, *attempts)

    async def _exchange(self, content: bytes, streaming: bool) -> ChatReply:
        import httpx2
        from openai import AsyncStream

        began = perf_counter()
        # No response is read by the library, so that the size of its body can be limited.
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
            whole = Gathering(self.endpoint)
            whole.add(await read_object(response, self.endpoint))
            return whole.reply()
        finally:
            await response.aclose()

    async def _read_stream(self, response: Response, began: float) -> ChatReply:
        gathering, first_token_s, done = Gathering(self.endpoint), None, False
        head, events = b"", Events()
        pieces = chunks(response, self.endpoint)

        def take(stream: list[bytes]) -> bool:
            nonlocal first_token_s
            for data in stream:
                if data == DONE:
                    return True
                brought = gathering.add(load_object(data, self.endpoint, response.status_code))
                if brought and first_token_s is None:
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
        if not done and gathering.finish_reason is None:
            raise self._broken_off(gathering, head, response.status_code)
        return gathering.reply().model_copy(update={"first_token_s": first_token_s})

    def _broken_off(self, gathering: Gathering, head: bytes, status: int) -> ServerFailure:
        """Return the failure for a stream without an end: it broke off, or it was no stream. ``head`` is its beginning."""
        where = self.endpoint.url
        if gathering.pieces:
            return ServerFailure(K.CUT_OFF, where=where, status=status, detail="the stream ended before the answer did")
        if not head.strip():
            return ServerFailure(K.EMPTY, where=where, status=status, detail="an empty body")
        detail = f"no event stream: {in_brief(head[:200].decode(errors='replace'), self.endpoint.secret)}"
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
