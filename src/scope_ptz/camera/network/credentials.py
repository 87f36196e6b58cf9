"""The credentials for signing in to a camera."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Credentials:
    """A user name and a password, which is hidden from ``repr``."""

    user: str
    password: str = field(repr=False)
