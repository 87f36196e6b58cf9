"""The accounts of a virtual camera."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from enum import IntEnum


class Role(IntEnum):
    """The permissions of an account. Each role includes those of all roles with lower numbers."""

    VIEWER = 1
    """May view pictures and streams."""
    OPERATOR = 2
    """May also move the camera, including to presets."""
    ADMINISTRATOR = 3
    """May also change presets, the home position and parameters."""


@dataclass(frozen=True, slots=True)
class Account:
    """A user name with its password and role. The password is hidden from ``repr``."""

    name: str
    password: str = field(repr=False)
    role: Role = Role.ADMINISTRATOR


class Accounts:
    """The accounts of a camera.

    Args:
        accounts: The accounts. If there are none, the camera requires no password.
    """

    def __init__(self, accounts: Iterable[Account] = ()) -> None:
        self._accounts = {account.name: account for account in accounts}

    @property
    def is_open(self) -> bool:
        """Whether the camera requires no password."""
        return not self._accounts

    def __iter__(self) -> Iterator[Account]:
        return iter(self._accounts.values())

    def find(self, name: str) -> Account | None:
        """Return an account by name; None if there is no such account."""
        return self._accounts.get(name)
