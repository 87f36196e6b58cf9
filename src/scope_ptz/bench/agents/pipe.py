"""A channel to an agent in a separate process, using JSON lines on the agent's stdin and stdout.

A keeper (``keeper.py``), a small supervisor process, starts the agent, limits its resources, and kills all processes that the agent
started. The host closes the control pipe to stop the agent, and the keeper reports on the status pipe how the agent ended.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import anyio
from anyio.abc import ByteReceiveStream, ByteSendStream, Process

from scope_ptz.bench.agents import keeper, runner
from scope_ptz.bench.agents.channel import AgentChannel
from scope_ptz.bench.agents.faults import agent_failure
from scope_ptz.bench.agents.launch import AgentLaunch
from scope_ptz.bench.agents.messages import (
    MAX_MESSAGE_BYTES,
    MAX_QUOTED_CHARS,
    AgentMessage,
    End,
    HostMessage,
    encode_message,
    parse_agent_message,
    printable,
)
from scope_ptz.errors import PlannerError

MAX_PROCESSES = 256
"""Maximum number of processes that an agent may have."""
MAX_STDERR_BYTES = 64_000_000
"""Maximum number of bytes that an agent may write to stderr in one run."""
GRACE_S = 2.0
"""Seconds that an agent has to exit by itself after its run."""
WRITE_S = 0.5
"""Timeout in seconds for sending the last message to an agent, and for closing its stdin."""
KEEPER_S = keeper.TERMINATE_S + keeper.GIVE_UP_S + GRACE_S + 5.0
"""Seconds after which the keeper itself is killed."""
CHUNK_BYTES = 65_536
_UNUSED_GROUP_ID = 2**31 - 1
"""Process group id that no group has. Id 0 would mean the group of this process."""
_PIPE_ERRORS = (anyio.EndOfStream, anyio.ClosedResourceError, anyio.BrokenResourceError)


@dataclass(frozen=True, slots=True)
class ExitReport:
    """The keeper's report on how an agent's process ended.

    Attributes:
        code: The exit code, or the negative signal number; None if the process was killed together with its keeper.
        exceeded: The exceeded limit ("memory", "processes" or "stderr"), if any.
        last_line: The last line that the agent wrote to stderr.
    """

    code: int | None = None
    exceeded: str | None = None
    last_line: str = ""


class PipeChannel(AgentChannel):
    """A channel to an agent in a separate process. Create it with ``start``."""

    def __init__(self, launch: AgentLaunch, process: Process, control: int, status: int) -> None:
        """Take over a process that ``start`` has started."""
        self.launch, self.isolation = launch, launch.isolation
        self._process, self._control, self._status = process, control, status
        assert process.stdin is not None  # noqa: S101 - start() opens both pipes
        assert process.stdout is not None  # noqa: S101
        self._input: ByteSendStream = process.stdin
        self._output: ByteReceiveStream = process.stdout
        self._buffer = bytearray()
        self._report: ExitReport | None = None

    @classmethod
    async def start(cls, launch: AgentLaunch) -> PipeChannel:
        """Start an agent.

        Raises:
            OSError: The operating system cannot start another process.
        """
        control, control_writer = os.pipe()
        status, status_writer = os.pipe()
        options = {
            "command": launch.command, "control": control, "status": status_writer, "memory_mb": launch.memory_mb,
            "processes": MAX_PROCESSES, "stderr_bytes": MAX_STDERR_BYTES, "grace_s": GRACE_S,
        }  # fmt: skip
        try:
            process = await anyio.open_process(
                [sys.executable, "-I", "-S", str(Path(keeper.__file__)), json.dumps(options)],
                stderr=None,
                cwd=launch.folder,
                env=launch.environment,
                start_new_session=True,
                pass_fds=(control, status_writer),
            )
        except BaseException:
            os.close(control_writer)
            os.close(status)
            raise
        finally:
            os.close(control)
            os.close(status_writer)
        return cls(launch, process, control_writer, status)

    async def send(self, message: HostMessage) -> None:
        """Send a message to the agent.

        Raises:
            PlannerError: The agent has exited.
        """
        try:
            await self._input.send(encode_message(message))
        except _PIPE_ERRORS:
            raise await self._failure() from None

    async def receive(self) -> AgentMessage:
        """Wait for the agent's next message and return it.

        Raises:
            PlannerError: The agent has exited or sent an invalid message.
        """
        while True:
            end = self._buffer.find(b"\n")
            if end >= 0:
                line = bytes(self._buffer[:end])
                del self._buffer[: end + 1]
                if line.strip():
                    return parse_agent_message(line)
                continue
            if len(self._buffer) > MAX_MESSAGE_BYTES:
                raise agent_failure("agent-output", f"The agent sent a message of more than {MAX_MESSAGE_BYTES} bytes.")
            try:
                self._buffer += await self._output.receive(CHUNK_BYTES)
            except _PIPE_ERRORS:
                raise await self._failure() from None

    async def close(self, reason: str) -> None:
        """Stop the agent and all its processes. An agent that does not exit by itself within ``GRACE_S`` is killed."""
        with anyio.CancelScope(shield=True):
            if self._report is None:
                with suppress(*_PIPE_ERRORS), anyio.move_on_after(WRITE_S):
                    await self._input.send(encode_message(End(reason=reason)))
            await self._shut_down()

    async def _shut_down(self) -> ExitReport:
        """Wait until all processes of the agent have ended, release the resources, and return the keeper's report."""
        if self._report is not None:
            return self._report
        self._report = ExitReport()
        # Write to the pipe before closing it: if the agent also holds it open, the keeper gets no end of file.
        os.set_blocking(self._control, False)
        with suppress(OSError):
            os.write(self._control, b"end")
        os.close(self._control)
        with anyio.CancelScope(shield=True):
            with suppress(*_PIPE_ERRORS), anyio.move_on_after(WRITE_S):
                await self._input.aclose()
            with anyio.move_on_after(KEEPER_S):
                await self._process.wait()
            if self._process.returncode is None:
                self._process.kill()
            await self._process.aclose()
        self._report = _read_report(self._status)
        return self._report

    async def _failure(self) -> PlannerError:
        """Return the error for an agent that has exited unexpectedly."""
        report = await self._shut_down()
        detail = f": {report.last_line}" if report.last_line else "."
        limit = f"The agent used more than {self.launch.memory_mb} MB of memory. Raise the limit with --agent-memory-mb."
        code = report.code
        if report.exceeded == "memory" or code == runner.OUT_OF_MEMORY or report.last_line.startswith("MemoryError"):
            return agent_failure("agent-memory", limit)
        if report.exceeded == "processes":
            return agent_failure("agent-processes", f"The agent started more than {MAX_PROCESSES} processes.")
        if report.exceeded == "stderr":
            return agent_failure("agent-output", f"The agent wrote more than {MAX_STDERR_BYTES} bytes to stderr.")
        if code == runner.FAILED:
            return agent_failure("agent-error", f"The agent failed{detail}")
        if code == runner.NOT_LOADED:
            return agent_failure("agent-error", report.last_line)
        if code is None:
            return agent_failure("agent-exited", f"The agent's process was killed before the agent replied{detail}")
        if code < 0:
            name = signal.Signals(-code).name if -code in {*signal.Signals} else str(-code)
            return agent_failure(
                "agent-exited", f"The agent's process was terminated by signal {name} before the agent replied{detail}"
            )
        return agent_failure("agent-exited", f"The agent's process ended with exit code {code} before the agent replied{detail}")


def _read_report(status: int) -> ExitReport:
    """Read the keeper's report, and close the pipe. Reading does not block, because the keeper has ended."""
    with os.fdopen(status, "rb") as pipe:
        pid, _, data = pipe.read().partition(b"\n")
    try:
        fields = json.loads(data)
        lines = [line for line in fields["stderr"].splitlines() if line.strip()]
        return ExitReport(fields["code"], fields["exceeded"], printable(lines[-1].strip(), MAX_QUOTED_CHARS) if lines else "")
    except (ValueError, KeyError, TypeError, AttributeError):
        # Without a valid report, the agent has probably killed the keeper. Kill the agent's process group here.
        with suppress(OSError, ValueError):
            os.killpg(int(pid) or _UNUSED_GROUP_ID, signal.SIGKILL)
        return ExitReport()
