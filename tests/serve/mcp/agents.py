"""Agents that use the official client library, and helpers that read their results."""

from __future__ import annotations

import base64
import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import cv2
import httpx2
import numpy as np
from mcp import Client
from mcp.client.streamable_http import streamable_http_client
from mcp_types import BlobResourceContents, CallToolResult, ImageContent, ResourceLink, TextContent, TextResourceContents
from numpy.typing import NDArray

from tests.serve.serving import CAMERA, Served

PRESENT, OLDER = "2026-07-28", "2025-11-25"
MODES = {PRESENT: "auto", OLDER: "legacy"}
"""How a client negotiates each version of the protocol: by discovery, or by the handshake of desktop programs."""

LONG = {"camera": CAMERA, "description": "ball", "duration_s": 300.0}
"""The arguments of a call of ``track_object`` that is still in progress when a test ends it."""


@asynccontextmanager
async def agent(
    served: Served, version: str = PRESENT, *, token: str | None = None, name: str | None = None
) -> AsyncIterator[Client]:
    """Connect to a server over streamable HTTP. The server treats each ``name`` as a separate client."""
    headers = ({"Authorization": f"Bearer {token}"} if token else {}) | ({"Scope-Client": name} if name else {})
    async with httpx2.AsyncClient(headers=headers, timeout=60.0, trust_env=False) as http:
        transport = streamable_http_client(f"{served.root}/mcp", http_client=http)
        async with Client(transport, mode=MODES[version]) as client:
            yield client


def text_of(result: CallToolResult) -> str:
    """Return the text of a result."""
    return "\n".join(part.text for part in result.content if isinstance(part, TextContent))


def pictures_of(result: CallToolResult) -> list[NDArray[Any]]:
    """Return the pictures of a result, decoded."""
    images = [part for part in result.content if isinstance(part, ImageContent)]
    assert all(image.mime_type == "image/jpeg" for image in images)
    return [decode(image.data) for image in images]


def links_of(result: CallToolResult) -> list[str]:
    """Return the URIs of the links of a result."""
    return [part.uri for part in result.content if isinstance(part, ResourceLink)]


def decode(data: str) -> NDArray[Any]:
    """Decode a JPEG in base64."""
    raw = base64.b64decode(data)
    assert raw.startswith(b"\xff\xd8"), "it is not a JPEG"
    image: Any = cv2.imdecode(np.frombuffer(raw, np.uint8), cv2.IMREAD_COLOR)
    return np.asarray(image)


async def read_json(client: Client, uri: str) -> Any:
    """Read a resource that contains JSON."""
    (content,) = (await client.read_resource(uri)).contents
    assert isinstance(content, TextResourceContents)
    return json.loads(content.text)


async def read_picture(client: Client, uri: str) -> NDArray[Any]:
    """Read a resource that contains a picture."""
    (content,) = (await client.read_resource(uri)).contents
    assert isinstance(content, BlobResourceContents)
    assert len(content.blob) < 1024 * 1024, "clients refuse larger results"
    return decode(content.blob)
