"""Errors of the add-on. The sidebar shows their messages, which state what is wrong and what to do."""

from __future__ import annotations


class AddOnError(Exception):
    """An error that is reported to the user."""


class ServerRefusedError(AddOnError):
    """The server refused a request.

    Attributes:
        status: The HTTP status.
    """

    def __init__(self, status: int, message: str) -> None:
        self.status = status
        super().__init__(message)
