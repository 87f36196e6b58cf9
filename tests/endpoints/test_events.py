"""Server-sent events: the formats of the standard and of servers, split at any byte."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.endpoints.chat import ChatClient
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.endpoints.events import EventParser
from scope_ptz.endpoints.failures import FailureKind, ServerFailure
from tests.support.misbehaving import Misbehaving, Say, body, pieces

WANTED: list[dict[str, Any]] = [{"a": "Käse 三"}, {"b": {"c": [1, 2]}}]
LINES = [json.dumps(event, ensure_ascii=False) for event in WANTED]


def spread(event: dict[str, Any]) -> str:
    return "\n".join(f"data: {line}" for line in json.dumps(event, indent=1, ensure_ascii=False).split("\n")) + "\n\n"


FORMS = {
    "plain": "".join(f"data: {line}\n\n" for line in LINES),
    "no space": "".join(f"data:{line}\n\n" for line in LINES),
    "no blank line": "".join(f"data: {line}\n" for line in LINES),
    "no last line end": "\n\n".join(f"data: {line}" for line in LINES),
    "other fields": ": ping\n\nevent: message\nid: 7\nretry: 100\n" + ": ping\n".join(f"data: {line}\n\n" for line in LINES),
    "several lines": "".join(spread(event) for event in WANTED),
    "empty data": "data:\n\n" + "data: \n\n".join(f"data: {line}\n\n" for line in LINES),
}


def read(stream: bytes, cuts: list[int]) -> list[object]:
    events, found, at = EventParser(), list[bytes](), 0
    for cut in [*sorted(cuts), len(stream)]:
        found += events.feed(stream[at:cut])
        at = cut
    return [json.loads(event) for event in (*found, *events.end())]


@pytest.mark.parametrize("form", FORMS)
@given(line_end=st.sampled_from(["\n", "\r\n", "\r"]), mark=st.booleans(), data=st.data())
def test_every_format_split_at_any_byte(form: str, line_end: str, mark: bool, data: st.DataObject) -> None:
    stream = (("\ufeff" if mark else "") + FORMS[form].replace("\n", line_end)).encode()
    cuts = data.draw(st.lists(st.integers(0, len(stream)), max_size=12))
    assert read(stream, cuts) == WANTED


@given(st.lists(st.binary(max_size=30)))
def test_any_bytes_are_parsed_without_an_exception(parts: list[bytes]) -> None:
    events = EventParser()
    for part in parts:
        events.feed(part)
    events.end()


@pytest.mark.anyio
@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
async def test_an_answer_that_begins_with_a_mark_and_ends_without_a_line_end(line_end: str) -> None:
    whole = (line_end * 2).join(f"data: {json.dumps(piece)}" for piece in pieces(Say("All of it.")))
    with Misbehaving(then=body("\ufeff" + whole, "text/event-stream")) as server:
        client = ChatClient(Endpoint(url=server.url, retries=0))
        reply = await client.complete([{"role": "user", "content": "?"}], stream=True)
        await client.close()
    assert reply.text == "All of it."


@pytest.mark.anyio
@pytest.mark.parametrize(
    ("content", "kind"),
    [("", FailureKind.EMPTY), ("<html>Please log in</html>", FailureKind.MALFORMED), ("data: {}\n\n", FailureKind.CUT_OFF)],
)
async def test_a_reply_that_is_not_a_stream_is_described(content: str, kind: FailureKind) -> None:
    with Misbehaving(then=body(content, "text/event-stream")) as server:
        client = ChatClient(Endpoint(url=server.url, retries=0))
        with pytest.raises(ServerFailure) as raised:
            await client.complete([{"role": "user", "content": "?"}], stream=True)
        await client.close()
    assert raised.value.kind == kind
    assert ("Please log in" in str(raised.value)) == ("log in" in content)
