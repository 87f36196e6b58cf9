"""The account with which a driver signs in to a camera."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Credentials:
    """A user name and a password. The password does not appear in ``repr``."""

    user: str
    password: str = field(repr=False)
