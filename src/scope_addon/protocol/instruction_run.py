"""Run an instruction on the server, and receive the events of the run in a thread."""

from __future__ import annotations

import queue
import re
import threading
from pathlib import Path
from typing import NamedTuple

from .address import Address
from .errors import AddOnError
from .server_client import ServerClient, quote_part
from .steps import End, Step, parse_end, parse_step

_PICTURE_PATH = re.compile(r"(?:frames|pictures)/[A-Za-z0-9._-]{1,60}")


class StepStarted(NamedTuple):
    """The planner has chosen the tool calls of step number ``step``."""

    step: int


class PictureStored(NamedTuple):
    """A picture of the run, with detections marked, was stored in a file."""

    path: Path


class Problem(NamedTuple):
    """The run could not be started, followed or cancelled."""

    text: str


RunEvent = Step | End | StepStarted | PictureStored | Problem


class InstructionRun:
    """An instruction, and its run on the server.

    Args:
        address: The server.
        client: The name of this client.
        camera: The name of the camera on the server.
        instruction: The instruction, as the user typed it.
        pair: The name of the pair of models.
        folder: The folder for the pictures of the run.
    """

    def __init__(self, address: Address, client: str, camera: str, instruction: str, pair: str, folder: Path) -> None:
        self._address, self._client, self._folder = address, client, folder
        self._body = {"camera": camera, "instruction": instruction, **({"pair": pair} if pair else {})}
        self._run_id = ""
        self._cancelled = threading.Event()
        self._stream = ServerClient(address, client)
        self._thread = threading.Thread(target=self._run_and_follow, name="scope-run", daemon=True)
        self.instruction = instruction
        self.events: queue.SimpleQueue[RunEvent] = queue.SimpleQueue()
        """The events of the run, for the main thread, which stops reading at the first ``End`` or ``Problem``."""

    def start(self) -> None:
        """Start the run, in the background."""
        self._thread.start()

    def cancel(self) -> None:
        """Cancel the run, in the background."""
        self._cancelled.set()
        threading.Thread(target=self._cancel, name="scope-cancel", daemon=True).start()

    def abandon(self) -> None:
        """Stop following the run. It continues on the server."""
        self._stream.close()

    def join(self, timeout_s: float) -> None:
        """Wait until the thread has ended."""
        if self._thread.is_alive():
            self._thread.join(timeout_s)

    def _run_and_follow(self) -> None:
        client = ServerClient(self._address, self._client)
        try:
            self._run_id = str(client.request("POST", "/runs", self._body)["id"])
            if self._cancelled.is_set():
                self._cancel()
            if not self._follow(client):
                self.events.put(Problem("The server ended the connection before the run had ended."))
        except AddOnError as error:
            self.events.put(Problem(str(error)))
        except Exception as error:  # a thread that fails silently would leave the sidebar showing "working"
            self.events.put(Problem(f"The run cannot be followed: {type(error).__name__}."))
        finally:
            client.close()

    def _follow(self, client: ServerClient) -> bool:
        """Add the run's events to ``events``. Return whether the run has ended."""
        for event in self._stream.events(f"/runs/{quote_part(self._run_id)}/events"):
            if event is None:
                continue
            if event.name == "decision":
                self.events.put(StepStarted(int(event.data["step"])))
            elif event.name == "call":
                step = parse_step(event.data)
                self.events.put(step)
                self._fetch(client, step.picture)
            elif event.name == "end":
                self.events.put(parse_end(event.data))
                return True
        return False

    def _fetch(self, client: ServerClient, picture: str) -> None:
        """Download a picture with its detections marked. Ignore a picture that is not available."""
        if not _PICTURE_PATH.fullmatch(picture):
            return
        try:
            data = client.request_bytes("GET", f"/runs/{quote_part(self._run_id)}/pictures/{picture}?marks=true")
        except AddOnError:
            return
        # The name is fixed, so that nothing from the server becomes part of a path.
        path = self._folder / "scope-frame.jpg"
        temporary = path.with_suffix(".new")
        temporary.write_bytes(data)
        temporary.replace(path)
        self.events.put(PictureStored(path))

    def _cancel(self) -> None:
        if not self._run_id:
            return
        client = ServerClient(self._address, self._client)
        try:
            client.request("POST", f"/runs/{quote_part(self._run_id)}/cancel")
        except AddOnError as error:
            self.events.put(Problem(f"The run could not be cancelled: {error}"))
        finally:
            client.close()
