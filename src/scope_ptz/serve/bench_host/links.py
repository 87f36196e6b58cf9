"""The connection between the host and a worker: pipes to a separate process, or two queues within one process."""

from __future__ import annotations

import asyncio
import sys
from abc import ABC, abstractmethod
from collections.abc import Awaitable, Callable
from contextlib import suppress

from scope_ptz.serve.bench_host.wire import COMMAND, EVENT, MAX_LINE_BYTES, Command, Event, WorkerSettings

STOP_S = 20.0
"""Seconds that a worker has to write its log after its input is closed."""

RunWorker = Callable[["WorkerSide", WorkerSettings], Awaitable[None]]
"""A function that runs a worker. It reads commands from the worker's side of a link and sends events to the host."""


class HostSide(ABC):
    """The host's side of a link."""

    @abstractmethod
    async def send(self, command: Command) -> None:
        """Send a command. If the worker has ended, the command is lost."""

    @abstractmethod
    async def receive(self) -> Event | None:
        """Return the next event; None when the worker has ended."""

    @abstractmethod
    async def close(self) -> None:
        """Stop the worker and wait until it has ended."""


class WorkerSide(ABC):
    """The worker's side of a link."""

    @abstractmethod
    async def send(self, event: Event) -> None:
        """Send an event to the host."""

    @abstractmethod
    async def receive(self) -> Command | None:
        """Return the next command; None when the host has disconnected."""


OpenLink = Callable[[WorkerSettings], Awaitable[HostSide]]
"""A function that starts a worker and returns the link to it."""


class ProcessLink(HostSide):
    """The link to a worker in a separate process. Create it with ``start``."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        assert process.stdin is not None and process.stdout is not None  # noqa: S101 - both are pipes
        self._process, self._input, self._output = process, process.stdin, process.stdout

    @classmethod
    async def start(cls, settings: WorkerSettings) -> ProcessLink:
        """Start a worker. Its settings are sent over the pipe, because other users can see a process's arguments."""
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "scope_ptz.serve.bench_host.worker",
            stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, limit=MAX_LINE_BYTES,
            start_new_session=True,  # Ctrl-C reaches only the host, which then closes the pipe
        )  # fmt: skip
        link = cls(process)
        await link._write(settings.model_dump_json())
        return link

    async def send(self, command: Command) -> None:
        await self._write(command.model_dump_json())

    async def receive(self) -> Event | None:
        try:
            line = await self._output.readline()
            return EVENT.validate_json(line) if line.endswith(b"\n") else None
        except ValueError:  # a line that is too long or is not an event, so the worker has failed
            return None

    async def close(self) -> None:
        with suppress(OSError, ConnectionError):
            self._input.close()
        try:
            async with asyncio.timeout(STOP_S):
                await self._process.wait()
        except TimeoutError:
            with suppress(ProcessLookupError):
                self._process.kill()
            await self._process.wait()

    async def _write(self, line: str) -> None:
        with suppress(OSError, ConnectionError):
            self._input.write(line.encode() + b"\n")
            await self._input.drain()


class StandardStreams(WorkerSide):
    """The worker's side of a process link: its standard input and output."""

    def __init__(self, reader: asyncio.StreamReader, write: Callable[[bytes], None]) -> None:
        self._reader, self._write = reader, write
        self._lock = asyncio.Lock()

    async def send(self, event: Event) -> None:
        async with self._lock:
            await asyncio.to_thread(self._write, event.model_dump_json().encode() + b"\n")

    async def receive(self) -> Command | None:
        line = await self._reader.readline()
        return COMMAND.validate_json(line) if line.endswith(b"\n") else None


class _Queues(WorkerSide):
    def __init__(self) -> None:
        self.events: asyncio.Queue[Event | None] = asyncio.Queue()
        self.commands: asyncio.Queue[Command | None] = asyncio.Queue()

    async def send(self, event: Event) -> None:
        # Events pass through JSON as over a pipe, so that the host receives the same data.
        await self.events.put(EVENT.validate_json(event.model_dump_json()))

    async def receive(self) -> Command | None:
        return await self.commands.get()


class LocalLink(HostSide):
    """The link to a worker that runs in the host's event loop. Only one such worker can run at a time."""

    def __init__(self, run: RunWorker, settings: WorkerSettings) -> None:
        self._queues = _Queues()
        self._task = asyncio.ensure_future(run(self._queues, settings))
        self._task.add_done_callback(lambda _: self._queues.events.put_nowait(None))

    async def send(self, command: Command) -> None:
        await self._queues.commands.put(command)

    async def receive(self) -> Event | None:
        return await self._queues.events.get()

    async def close(self) -> None:
        self._queues.commands.put_nowait(None)
        await asyncio.gather(self._task, return_exceptions=True)
