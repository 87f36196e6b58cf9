"""The clients of a server, with their names and roles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Role = Literal["viewer", "operator"]

LOCAL = "local"
"""The name of every client of a server that needs no tokens."""


def display_name(name: str) -> str:
    """Return a client's name as messages show it."""
    return "another window or program on this computer" if name == LOCAL else name


@dataclass(frozen=True, slots=True)
class Client:
    """One client of the server: a program, or one browser tab.

    Attributes:
        name: The name of its token; ``LOCAL`` if the server needs none. Conversations are shared by all clients with the same name.
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
