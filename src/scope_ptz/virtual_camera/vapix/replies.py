"""VAPIX replies, and the clients that send requests."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from scope_ptz.virtual_camera.accounts import Role


@dataclass(frozen=True, slots=True)
class Client:
    """A client that sends a request. ``name`` is its account name, or its address if the camera has no accounts."""

    name: str
    role: Role


@dataclass(frozen=True, slots=True)
class Reply:
    """A VAPIX reply: HTTP status, body and media type."""

    status: int
    body: str = ""
    content_type: str = "text/plain; charset=utf-8"


DONE = Reply(204)
"""The reply to a successful command, which has no body."""


def error(message: str) -> Reply:
    """Return an error reply to a PTZ request. Its HTTP status is 200, as on AXIS cameras."""
    return Reply(200, f"Error: {_one_line(message)}\n")


def parameter_error(message: str) -> Reply:
    """Return an error reply from ``param.cgi``."""
    return Reply(200, f"# Error: {_one_line(message)}\n")


def lines(content: Iterable[str]) -> Reply:
    """Return a reply with lines of text."""
    return Reply(200, "".join(f"{line}\n" for line in content))


def values(content: Mapping[str, object]) -> Reply:
    """Return a reply with ``name=value`` lines."""
    return lines(f"{name}={value}" for name, value in content.items())


def document(content: Mapping[str, Any]) -> Reply:
    """Return a reply with a JSON document."""
    return Reply(200, json.dumps(content), "application/json")


def _one_line(message: str) -> str:
    return " ".join(message.split())
