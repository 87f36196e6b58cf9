"""Hosts on a free port in the event loop of a test, and clients that record everything that they receive."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx2
from mcp import Client
from mcp.client.streamable_http import streamable_http_client

from scope_ptz.bench.signatures.keys import generate_key
from scope_ptz.serve.bench_host.application import serve_host
from scope_ptz.serve.bench_host.host import Host, participants_file
from scope_ptz.serve.bench_host.http_routes import MESSAGES_PATH, PROGRESS_PATH
from scope_ptz.serve.bench_host.links import HostSide, LocalLink, RunWorker
from scope_ptz.serve.bench_host.wire import EvaluationSettings, WorkerSettings
from scope_ptz.serve.security.access import MCP_PATH, Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.security.tokens import TokenFile

HELLO: dict[str, Any] = {"type": "hello", "protocol": 1, "name": "test agent"}


def call(name: str, **arguments: Any) -> dict[str, Any]:
    """Return a message with one call."""
    return {"type": "calls", "calls": [{"id": "a", "name": name, "arguments": arguments}]}


def reply(text: str) -> dict[str, Any]:
    """Return an answer."""
    return {"type": "reply", "text": text}


@dataclass
class Agent:
    """A participant's HTTP client. ``received`` contains every reply, with its headers."""

    http: httpx2.AsyncClient
    received: list[bytes]

    async def post(self, message: dict[str, Any] | bytes) -> httpx2.Response:
        """Send a message, which need not be valid."""
        if isinstance(message, bytes):
            return await self.http.post(MESSAGES_PATH, content=message)
        return await self.http.post(MESSAGES_PATH, json=message)

    async def say(self, message: dict[str, Any]) -> dict[str, Any]:
        """Send a message, and return the host's next one."""
        response = await self.post(message)
        assert response.status_code == 200, response.text
        data: dict[str, Any] = response.json()
        return data

    async def until(self, phase: str) -> None:
        """Wait until the evaluation has a phase."""
        while (await self.progress())["phase"] != phase:  # noqa: ASYNC110 - as participants do
            await asyncio.sleep(0.05)

    async def progress(self) -> dict[str, Any]:
        """Return the progress of the evaluation."""
        data: dict[str, Any] = (await self.http.get(PROGRESS_PATH)).json()
        return data


@dataclass
class Hosted:
    """A running host."""

    port: int
    host: Host
    tokens: dict[str, str]
    received: list[bytes] = field(default_factory=list)

    @property
    def root(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @asynccontextmanager
    async def agent(self, name: str = "anna", **headers: str) -> AsyncIterator[Agent]:
        """Connect a participant over HTTP."""
        headers = {"Authorization": f"Bearer {self.tokens[name]}"} | headers if name else headers
        async with self._http(headers) as http:
            yield Agent(http, self.received)

    @asynccontextmanager
    async def mcp(self, name: str = "anna") -> AsyncIterator[Client]:
        """Connect a participant over MCP."""
        headers = {"Authorization": f"Bearer {self.tokens[name]}"}
        async with self._http(headers) as http, Client(streamable_http_client(self.root + MCP_PATH, http_client=http)) as client:
            yield client

    def _http(self, headers: dict[str, str]) -> httpx2.AsyncClient:
        async def record(response: httpx2.Response) -> None:
            await response.aread()
            head = "\n".join(f"{key}: {value}" for key, value in response.headers.items())
            self.received.append(head.encode() + b"\n\n" + response.content)

        hooks: dict[str, Any] = {"response": [record]}
        return httpx2.AsyncClient(base_url=self.root, headers=headers, timeout=120.0, trust_env=False, event_hooks=hooks)


@asynccontextmanager
async def hosting(
    folder: Path,
    run: RunWorker,
    settings: EvaluationSettings,
    participants: Sequence[str] = ("anna",),
    *,
    fail_unfinished: bool = False,
    limits: RateLimits | None = None,
) -> AsyncIterator[Hosted]:
    """Serve a host whose workers run in this event loop. A folder that exists is resumed."""

    async def open_link(worker: WorkerSettings) -> HostSide:
        return LocalLink(run, worker)

    key = folder.parent / f"{folder.name}.key"
    if not key.exists():
        generate_key(key)
    host = Host(folder, settings, key, open_link=open_link, fail_unfinished=fail_unfinished)
    file = TokenFile(participants_file(folder))
    tokens = {}
    for name in participants:
        if any(token.name == name for token in file.tokens):
            file.remove(name)
        tokens[name] = file.add(name, "viewer")
    access = Access("127.0.0.1", host.tokens, limits=limits or RateLimits(None))
    async with serve_host(host, access, port=0) as port:
        yield Hosted(port, host, tokens)
