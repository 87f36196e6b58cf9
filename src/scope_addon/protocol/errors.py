"""The error of the add-on. Its message states what is wrong and what to do, and is shown in the sidebar."""

from __future__ import annotations


class AddOnError(Exception):
    """Something that the user should know."""


class ServerRefusedError(AddOnError):
    """The server refused a request.

    Attributes:
        status: The HTTP status.
    """

    def __init__(self, status: int, message: str) -> None:
        self.status = status
        super().__init__(message)
