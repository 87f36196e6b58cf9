"""Run a program with limited resources, and kill it with all processes that it started. Uses only the standard library.

Usage: ``python keeper.py '{"command": [...], ...}'``, with the fields of ``KeeperOptions``. The keeper is a process between the
host and an agent, which inherits the keeper's stdin and stdout. The keeper kills the agent and all of the agent's processes when

- the agent's first process ends,
- the host closes the control pipe or dies (after a grace period), or
- the agent uses more memory, processes or output than allowed.

It writes two lines to the status pipe: first the agent's process id, and finally a JSON object with the exit code or signal, the
exceeded limit, and the last part of stderr.
"""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

CHECK_S = 0.2  # seconds between checks of memory and processes
TERMINATE_S = 1.0  # seconds between SIGTERM and SIGKILL
GIVE_UP_S = 10.0  # seconds after which processes that cannot be killed are abandoned
TAIL_BYTES = 4_000  # size of the last part of stderr, which is reported
RESERVED_MB = 512  # headroom, because the kernel's limit also counts memory that is reserved but not used, such as stacks
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36


@dataclass
class KeeperOptions:
    """The program to run and its limits.

    Attributes:
        command: The program and its arguments.
        control: File descriptor of the control pipe. End of file stops the program.
        status: File descriptor of the status pipe, for the report.
        memory_mb: Maximum total memory of all processes in MB; None for no limit.
        processes: Maximum number of processes.
        stderr_bytes: Maximum number of bytes that the processes may write to stderr.
        grace_s: Seconds that the program is given to exit on its own after the control pipe is closed.
    """

    command: list[str]
    control: int
    status: int
    memory_mb: int | None
    processes: int
    stderr_bytes: int
    grace_s: float


class Keeper:
    """The supervisor of a running program."""

    def __init__(self, options: KeeperOptions) -> None:
        self.options = options
        self.exceeded: str | None = None
        self.tail = b""
        self.stderr_bytes = 0
        self.wait_status: int | None = None
        self.stderr, writer = os.pipe()
        self.wake, wake_writer = os.pipe()
        os.set_blocking(wake_writer, False)
        signal.set_wakeup_fd(wake_writer, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        self.pid = self._start(writer)
        os.close(writer)
        # Only the agent may keep the pipes to the host open, so that the host sees end of file when the agent ends.
        devnull = os.open(os.devnull, os.O_RDWR)
        for descriptor in (0, 1, 2):
            os.dup2(devnull, descriptor)

    def _start(self, stderr: int) -> int:
        import resource  # not available on every system

        pid = os.fork()
        if pid:
            return pid
        try:
            os.setsid()
            set_process_attribute(PR_SET_PDEATHSIG, signal.SIGKILL)
            os.dup2(stderr, 2)
            for number in (signal.SIGCHLD, signal.SIGPIPE, signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
                signal.signal(number, signal.SIG_DFL)
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            if self.options.memory_mb is not None:
                limit = (self.options.memory_mb + RESERVED_MB) * 1_000_000
                resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
            os.execvp(self.options.command[0], self.options.command)  # noqa: S606 - no shell is needed
        except OSError as error:
            os.write(2, f"{self.options.command[0]} cannot be started: {error.strerror}\n".encode())
        finally:
            os._exit(127)

    def watch(self) -> None:
        """Wait until the program has ended or must be stopped, then kill all remaining processes."""
        readable: list[int] = [self.options.control, self.wake, self.stderr]
        deadlines: list[tuple[float, int]] = []
        next_check = 0.0
        while self.wait_status is None and self.exceeded is None:
            for descriptor in select.select(readable, [], [], CHECK_S)[0]:
                if descriptor == self.stderr:
                    self._read_stderr(readable)
                elif descriptor == self.wake:
                    os.read(self.wake, 512)
                else:
                    readable.remove(self.options.control)
                    now = time.monotonic() + self.options.grace_s
                    deadlines = [(now + TERMINATE_S, signal.SIGKILL), (now, signal.SIGTERM)]
            self._reap()
            while deadlines and time.monotonic() >= deadlines[-1][0] and self.wait_status is None:
                self._signal_group(deadlines.pop()[1])
            if time.monotonic() >= next_check:
                self._check_limits()
                next_check = time.monotonic() + CHECK_S
        self._kill_all()
        while self.stderr in readable and select.select([self.stderr], [], [], 0)[0]:
            self._read_stderr(readable)

    def report(self) -> None:
        """Write the report to the status pipe."""
        code = os.waitstatus_to_exitcode(self.wait_status) if self.wait_status is not None else None
        fields = {"code": code, "exceeded": self.exceeded, "stderr": self.tail.decode("utf-8", "replace")}
        os.write(self.options.status, json.dumps(fields).encode())

    def _read_stderr(self, readable: list[int]) -> None:
        data = os.read(self.stderr, 65_536)
        if not data:
            readable.remove(self.stderr)
        self.stderr_bytes += len(data)
        self.tail = (self.tail + data)[-TAIL_BYTES:]

    def _reap(self) -> bool:
        """Reap the processes that have ended. Return whether other processes remain."""
        while True:
            try:
                pid, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                return False
            if pid == 0:
                return True
            if pid == self.pid:
                self.wait_status = status

    def _check_limits(self) -> None:
        pids = descendants(os.getpid())
        if len(pids) > self.options.processes:
            self.exceeded = "processes"
        elif self.stderr_bytes > self.options.stderr_bytes:
            self.exceeded = "stderr"
        elif self.options.memory_mb is not None and exceeds_memory(pids, self.options.memory_mb * 1_000_000):
            self.exceeded = "memory"

    def _kill_all(self) -> None:
        """Kill all remaining processes. They are suspended first, so that they cannot start other processes in the meantime."""
        if sys.platform != "linux":
            self._signal_group(signal.SIGKILL)
        deadline = time.monotonic() + GIVE_UP_S
        stopped: set[int] = set()
        while (new := set(descendants(os.getpid())) - stopped) and time.monotonic() < deadline:
            for pid in new:
                self._signal(pid, signal.SIGSTOP)
            stopped |= new
        while self._reap() and time.monotonic() < deadline:
            for pid in descendants(os.getpid()) or [self.pid]:
                self._signal(pid, signal.SIGKILL)
            time.sleep(0.005)

    def _signal_group(self, number: int) -> None:
        with suppress(OSError):
            os.killpg(self.pid, number)

    @staticmethod
    def _signal(pid: int, number: int) -> None:
        with suppress(OSError):
            os.kill(pid, number)


def descendants(root: int) -> list[int]:
    """Return the ids of all descendants of a process. On systems without ``/proc``, the list is empty."""
    found: list[int] = []
    pending = [root]
    while pending:
        for children in Path(f"/proc/{pending.pop()}/task").glob("*/children"):
            try:
                pids = [int(pid) for pid in children.read_text().split()]
            except OSError:
                continue
            found += pids
            pending += pids
    return found


def exceeds_memory(pids: list[int], limit_bytes: int) -> bool:
    """Return whether the total memory of processes exceeds a limit. Pages that several processes share are counted once."""
    # The exact total is slow to compute for large processes, but it never exceeds the simple estimate.
    return simple_memory_bytes(pids) > limit_bytes and exact_memory_bytes(pids) > limit_bytes


def simple_memory_bytes(pids: list[int]) -> int:
    """Return the total memory of processes in bytes. Shared pages are counted once for each process."""
    page_bytes = os.sysconf("SC_PAGE_SIZE")
    return sum(int(text.split()[1]) * page_bytes for text in _read_process_files(pids, "statm") if text)


def exact_memory_bytes(pids: list[int]) -> int:
    """Return the total memory of processes in bytes. Shared pages are counted once."""
    lines = [line for text in _read_process_files(pids, "smaps_rollup") for line in text.splitlines()]
    return sum(int(line.split()[1]) * 1024 for line in lines if line.startswith("Pss:"))


def _read_process_files(pids: list[int], name: str) -> list[str]:
    """Read a file in the ``/proc`` folder of each process. Processes that have ended are omitted."""
    texts = []
    for pid in pids:
        with suppress(OSError):
            texts.append(Path(f"/proc/{pid}/{name}").read_text())
    return texts


def set_process_attribute(option: int, value: int) -> None:
    """Set an attribute of this process with ``prctl`` (Linux only)."""
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def main() -> None:
    """Run the program described by the first command-line argument."""
    options = KeeperOptions(**json.loads(sys.argv[1]))
    for descriptor in (options.control, options.status):
        os.set_inheritable(descriptor, False)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    # Orphaned descendants become children of this process, so that it finds processes that detached themselves.
    set_process_attribute(PR_SET_CHILD_SUBREAPER, 1)
    keeper = Keeper(options)
    os.write(options.status, f"{keeper.pid}\n".encode())
    keeper.watch()
    keeper.report()


if __name__ == "__main__":
    main()
