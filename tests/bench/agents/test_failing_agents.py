"""Crashes, hangs and floods count as failures of the agent, and no process or open file is left."""

from __future__ import annotations

import asyncio
import shlex
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from scope_ptz.bench.agents import pipe
from scope_ptz.bench.agents.faults import AGENT_FAULTS
from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.planner import AgentTimeLimits
from scope_ptz.bench.scoring.verdict import AGENT_FAILURES
from scope_ptz.errors import PlannerError
from tests.bench.agents.conformance import STATE
from tests.bench.agents.programs import local_agent_in, run_to_reply, write_agent

QUICK = AgentTimeLimits(step_s=1.0, run_s=5.0)


def is_running(pid: int) -> bool:
    """Return whether a process exists and is not a zombie."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def open_files() -> int:
    """Return the number of open file descriptors."""
    return len(list(Path("/proc/self/fd").iterdir()))


def pids_in(folder: Path) -> list[int]:
    """Return the ids of the processes that left a file in a folder."""
    return [int(path.name.removeprefix("pid-")) for path in folder.glob("pid-*")]


def wait_for_pid(folder: Path, parent: subprocess.Popen[bytes] | None = None) -> int:
    """Wait until a process has left a file in a folder, and return its id. Fail if the program that starts the process ends."""
    while not (found := pids_in(folder)):
        assert parent is None or parent.poll() is None, "The program ended before it started the agent."
        time.sleep(0.05)
    return found[0]


def wait_for_end(pid: int) -> None:
    """Wait until a process has ended."""
    while is_running(pid):
        time.sleep(0.05)


@pytest.fixture(autouse=True)
def check_for_leaks() -> Iterator[None]:
    """Check that no file descriptor and no child process is left."""
    before = open_files()
    yield
    children = [pid for task in Path("/proc/self/task").glob("*/children") for pid in task.read_text().split()]
    assert not [pid for pid in children if is_running(int(pid)) and b"keeper.py" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    assert open_files() <= before + 2  # an event loop keeps two open


async def failure_of(folder: Path, body: str, options: AgentOptions | None = None, imports: str = "") -> PlannerError:
    agent = local_agent_in(folder, write_agent(folder, body, imports=imports), options or AgentOptions(times=QUICK))
    with pytest.raises(PlannerError) as excinfo:
        await run_to_reply(agent)
    assert excinfo.value.kind in AGENT_FAULTS and excinfo.value.kind in AGENT_FAILURES
    return excinfo.value


@pytest.mark.parametrize(
    ("body", "kind", "message"),
    [
        ("raise ZeroDivisionError('oops')", "agent-error", "ZeroDivisionError: oops"),
        ("os.kill(os.getpid(), 11)", "agent-exited", "SIGSEGV"),
        ("os.kill(os.getpid(), 40)", "agent-exited", "signal 40"),
        ("os._exit(3)", "agent-exited", "exit code 3"),
        ("os._exit(0)", "agent-exited", "exit code 0"),
        ("sys.exit('I give up')", "agent-exited", "I give up"),
        ("time.sleep(60)", "agent-timeout", "1 s"),
        ("await asyncio.sleep(60)", "agent-timeout", "1 s"),
        ("while True: pass", "agent-timeout", "1 s"),
        ("signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(60)", "agent-timeout", "1 s"),
        ("await session.call('x' * 300)", "agent-protocol", "name"),
        ("await session.call('take_image', {'x': 'y' * 2_000_000})", "agent-output", "bytes"),
        ("return 'x' * 2_000_000", "agent-output", "bytes"),
        ("return {'text': 'x', 'kind': 'correct'}", "agent-error", "kind"),
        ("await session.call('take_image', {'x': object()})", "agent-error", "JSON"),
        ("await session.call('take_image', {'x': float('nan')})", "agent-error", "JSON"),
        ("raise MemoryError", "agent-memory", "MB"),
    ],
)
async def test_failures_of_an_agent(tmp_path: Path, body: str, kind: str, message: str) -> None:
    error = await failure_of(tmp_path, body, imports="import asyncio, os, signal, sys, time")
    assert error.kind == kind and message in str(error)


async def test_memory_above_the_limit(tmp_path: Path) -> None:
    options = AgentOptions(memory_mb=150, times=AgentTimeLimits(30, 30))
    body = "kept = []\nwhile True:\n    kept.append(b'x' * 5_000_000)\n    time.sleep(0.005)"
    error = await failure_of(tmp_path, body, options, "import time")
    assert error.kind == "agent-memory" and "150 MB" in str(error)


async def test_the_memory_limit_applies_to_all_processes_together(tmp_path: Path) -> None:
    body = """
    for _ in range(4):
        if os.fork() == 0:
            kept = os.urandom(60_000_000)
            time.sleep(60)
    time.sleep(60)
    """
    options = AgentOptions(memory_mb=150, times=AgentTimeLimits(30, 30))
    error = await failure_of(tmp_path, body, options, "import os, time")
    assert error.kind == "agent-memory"


async def test_too_many_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipe, "MAX_PROCESSES", 20)
    body = """
    while True:
        if os.fork() == 0:
            os.setsid()
            time.sleep(60)
        time.sleep(0.002)
    """
    error = await failure_of(tmp_path, body, AgentOptions(times=AgentTimeLimits(30, 30)), "import os, time")
    assert error.kind == "agent-processes" and "20" in str(error)


async def test_a_flood_on_stderr(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipe, "MAX_STDERR_BYTES", 100_000)
    error = await failure_of(tmp_path, "while True: print('x' * 1000)", AgentOptions(times=AgentTimeLimits(30, 30)))
    assert error.kind == "agent-output"


async def test_the_time_limit_of_a_run(tmp_path: Path) -> None:
    body = "while True:\n    await asyncio.sleep(0.2)\n    await session.call('take_image')"
    error = await failure_of(tmp_path, body, AgentOptions(times=AgentTimeLimits(step_s=30, run_s=1)), "import asyncio")
    assert error.kind == "agent-timeout" and "for the whole run" in str(error)


async def test_too_many_frames(tmp_path: Path) -> None:
    agent = local_agent_in(
        tmp_path, write_agent(tmp_path, "while True:\n    session._is_view_current = False\n    session.view()", sees=True)
    )
    with pytest.raises(PlannerError, match="more than 100 frames") as excinfo:
        await run_to_reply(agent)
    assert excinfo.value.kind == "agent-protocol"


@pytest.mark.parametrize("ending", ["return 'done'", "raise RuntimeError('no')", "time.sleep(60)", "os._exit(1)"])
async def test_processes_that_an_agent_started_end_with_it(tmp_path: Path, ending: str) -> None:
    body = f"""
    for detached in (False, True):
        if os.fork() == 0:
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
            signal.signal(signal.SIGHUP, signal.SIG_IGN)
            if detached:
                os.setsid()
                if os.fork():
                    os._exit(0)
            open(f"pid-{{os.getpid()}}", "w").close()
            time.sleep(60)
            os._exit(0)
    while len([name for name in os.listdir() if name.startswith("pid-")]) < 2:
        time.sleep(0.01)
    {ending}
    """
    name = write_agent(tmp_path, body, imports="import os, signal, time")
    agent = local_agent_in(tmp_path, name, AgentOptions(times=AgentTimeLimits(3, 30)))
    if ending.startswith("return"):
        reply, _ = await run_to_reply(agent)
        assert reply.text == "done"
    else:
        with pytest.raises(PlannerError):
            await run_to_reply(agent)
    pids = pids_in(tmp_path)
    assert len(pids) == 2 and not any(map(is_running, pids))


GARBLE = """
for name in os.listdir(f'/proc/{os.getppid()}/fd'):
        if os.readlink(f'/proc/{os.getppid()}/fd/{name}').startswith('pipe'):
            with contextlib.suppress(OSError):
                descriptor = os.open(f'/proc/{os.getppid()}/fd/{name}', os.O_WRONLY | os.O_NONBLOCK)
                os.write(descriptor, b'0\\n[1]\\n')
"""


@pytest.mark.parametrize(
    "attack", ["os.kill(os.getppid(), signal.SIGKILL)", "os.kill(os.getppid(), signal.SIGSTOP)", GARBLE.strip()],
    ids=["kills", "stops", "garbles"],
)  # fmt: skip
async def test_an_agent_that_attacks_its_keeper(tmp_path: Path, attack: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipe, "KEEPER_S", 3.0)
    body = f"""
    ctypes.CDLL(None).prctl(1, 0, 0, 0, 0)
    open(f"pid-{{os.getpid()}}", "w").close()
    {attack}
    time.sleep(60)
    """
    error = await failure_of(tmp_path, body, imports="import contextlib, ctypes, os, signal, time")
    assert error.kind in ("agent-timeout", "agent-exited")
    (pid,) = pids_in(tmp_path)
    wait_for_end(pid)


async def test_an_agent_that_is_cancelled_while_it_starts(tmp_path: Path) -> None:
    name = write_agent(tmp_path, "return 'x'", imports="import os, time\nopen(f'pid-{os.getpid()}', 'w').close()\ntime.sleep(60)")
    starting = asyncio.ensure_future(local_agent_in(tmp_path, name).open())
    await asyncio.to_thread(wait_for_pid, tmp_path)
    starting.cancel()
    with pytest.raises(asyncio.CancelledError):
        await starting
    wait_for_end(pids_in(tmp_path)[0])


async def test_a_cancelled_run_ends_the_agent(tmp_path: Path) -> None:
    body = """
    open(f"pid-{os.getpid()}", "w").close()
    try:
        await session.call("take_image")
    finally:
        open("ended", "w").close()
    """
    agent = local_agent_in(tmp_path, write_agent(tmp_path, body, imports="import os"))
    planner = await agent.open()
    await planner.step(STATE)
    await asyncio.wait_for(planner.close(), 30)
    (pid,) = pids_in(tmp_path)
    assert not is_running(pid) and (tmp_path / "ended").exists()


GARBAGE = """
import os, sys
os.write(1, {data})
os.read(0, 1)
"""


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        ("b'not json\\n'", "agent-protocol"),
        ("os.urandom(1000) + b'\\n'", "agent-protocol"),
        ('b\'{"type": "reply", "text": "4"}\\n\'', "agent-protocol"),
        ('b\'{"type": "hello", "protocol": 9, "name": "x"}\\n\'', "agent-protocol"),
        ("b'[' * 200_000 + b'\\n'", "agent-protocol"),
        ("b'x' * 3_000_000", "agent-output"),
        ("b'\\n' * 3_000_000", "agent-timeout"),
    ],
)
async def test_garbage(tmp_path: Path, data: str, kind: str) -> None:
    (tmp_path / "garbage.py").write_text(GARBAGE.format(data=data).replace("os.write(1,", "sys.stdout.buffer.write("))
    (tmp_path / "garbage.py").write_text((tmp_path / "garbage.py").read_text().replace("os.read", "sys.stdout.flush(); os.read"))
    options = AgentOptions(command=f"{shlex.quote(sys.executable)} -S garbage.py", times=QUICK)
    with pytest.raises(PlannerError) as excinfo:
        await run_to_reply(local_agent_in(tmp_path, "scope", options))
    assert excinfo.value.kind == kind


async def test_a_program_that_does_not_read(tmp_path: Path) -> None:
    (tmp_path / "deaf.sh").write_text('echo \'{"type": "hello", "protocol": 1, "name": "deaf"}\'; trap "" TERM; sleep 60; sleep 60')
    options = AgentOptions(command="sh deaf.sh", times=QUICK)
    with pytest.raises(PlannerError, match="longer than 1 s") as excinfo:
        await run_to_reply(local_agent_in(tmp_path, "scope", options))
    assert excinfo.value.kind == "agent-timeout"


def test_agents_do_not_outlive_a_scorer_that_is_killed(tmp_path: Path) -> None:
    name = write_agent(tmp_path, "open(f'pid-{os.getpid()}', 'w').close(); time.sleep(60)", imports="import os, time")
    scorer = f"""
import anyio
from tests.bench.agents.programs import *
anyio.run(run_to_reply, local_agent_in(Path({str(tmp_path)!r}), {name!r}))
"""
    process = subprocess.Popen([sys.executable, "-c", scorer])
    pid = wait_for_pid(tmp_path, process)
    process.send_signal(signal.SIGKILL)
    process.wait()
    wait_for_end(pid)


pytestmark = [
    pytest.mark.full,
    pytest.mark.anyio,
    pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc"),
]
