"""The clients of a server, with their names and roles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Role = Literal["viewer", "operator"]

LOCAL = "local"
"""The name of every client where no token is needed."""


def shown_name(name: str) -> str:
    """Return a client's name in the form used in messages."""
    return "another window or program on this computer" if name == LOCAL else name


@dataclass(frozen=True, slots=True)
class Client:
    """One client: a program, or one tab of a browser.

    Attributes:
        name: The name of the token; ``LOCAL`` if the server needs none. A conversation belongs to a name.
        key: A key that distinguishes clients with the same name. Control of a camera belongs to a key.
        role: The role, which determines the permissions.
    """

    name: str
    key: str
    role: Role

    @property
    def operates(self) -> bool:
        """Whether the client may send commands."""
        return self.role == "operator"
