"""The file ``request.json`` in a run folder, which stores who requested the run and in which conversation."""

from __future__ import annotations

from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from scope_ptz.errors import OutputError
from scope_ptz.store.rows import RunKind

FILE_NAME = "request.json"
MAX_BYTES = 10_000


class RunRequest(BaseModel):
    """The request that started a run.

    Attributes:
        kind: The kind of run: an instruction, a dry run, or a tool call by a person.
        camera: The camera's name in its site; empty if it has none.
        conversation: Id of the conversation; None if the run belongs to none.
        actor: The client that sent the request; empty if unknown.
    """

    model_config = ConfigDict(frozen=True)

    kind: RunKind = "instruction"
    camera: str = ""
    conversation: str | None = None
    actor: str = ""

    def write(self, folder: Path) -> None:
        """Write the file.

        Raises:
            OutputError: The file cannot be written.
        """
        path = folder / FILE_NAME
        try:
            path.write_text(self.model_dump_json() + "\n", encoding="utf-8")
        except OSError as error:
            raise OutputError(f"{path} cannot be written: {error.strerror}.") from error


def read_request(folder: Path) -> RunRequest:
    """Return the request in a run folder. Runs that were not started through a server have a default request."""
    try:
        with (folder / FILE_NAME).open("rb") as file:
            return RunRequest.model_validate_json(file.read(MAX_BYTES))
    except (OSError, ValidationError):
        return RunRequest()
