"""A server's clients, with their names and roles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Role = Literal["viewer", "operator"]

LOCAL = "local"
"""The name of every client if the server needs no tokens."""


def display_name(name: str) -> str:
    """Return a client's name for use in messages."""
    return "another window or program on this computer" if name == LOCAL else name


@dataclass(frozen=True, slots=True)
class Client:
    """A client of the server: a program, or one browser tab.

    Attributes:
        name: The name of the client's token; ``LOCAL`` if the server needs none. Clients with the same name share conversations.
        key: Distinguishes clients with the same name. Control of a camera belongs to one key.
        role: The role, which determines what the client may do.
    """

    name: str
    key: str
    role: Role

    @property
    def is_operator(self) -> bool:
        """Whether the client may send commands."""
        return self.role == "operator"
