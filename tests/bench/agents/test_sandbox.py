"""Access of sandboxed agents to files, processes and the network."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

import scope_ptz
from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.planner import AgentTimeLimits
from scope_ptz.bench.agents.sandbox import SandboxContents, require_sandbox, sandbox_command
from scope_ptz.errors import ConfigError, PlannerError
from tests.bench.agents.programs import create_environment, local_agent_in, run_to_reply, write_agent
from tests.bench.agents.sandboxes import needs_sandbox

SANDBOX = AgentOptions(sandbox=True)


async def answer_of(folder: Path, body: str, *, imports: str = "", hidden: tuple[Path, ...] = ()) -> str:
    reply, _ = await run_to_reply(local_agent_in(folder, write_agent(folder, body, imports=imports), SANDBOX, hidden))
    return reply.text


@needs_sandbox
async def test_an_agent_works_as_it_does_outside(tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("WORD = 'helped'\n")
    body = """
    with tempfile.TemporaryDirectory() as folder:
        open(folder + "/x", "w").close()
    seen = await session.call("count_objects", {"description": "x"})
    return f"{seen['count']} {helper.WORD} {sys.version_info[0]} {os.getcwd()}"
    """
    name = write_agent(tmp_path, body, imports="import helper, os, sys, tempfile")
    agent = local_agent_in(tmp_path, name, SANDBOX)
    assert agent.isolation == "sandboxed"
    reply, _ = await run_to_reply(agent, lambda _: {"count": 4})
    assert reply.text == f"4 helped 3 {tmp_path}"


WRITE_ATTEMPTS = ("/usr/x", "/x", "new.txt", "/etc/passwd", "/proc/sys/kernel/core_pattern", "/proc/sys/vm/drop_caches")


@pytest.mark.full
@needs_sandbox
async def test_inaccessible_resources(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    body = f"""
    def attempt(work):
        try:
            return repr(work())
        except Exception as error:
            return type(error).__name__

    package = {str(Path(scope_ptz.__file__).parent)!r}
    return json.dumps({{
        "import": attempt(lambda: __import__("scope_ptz")),
        "package": os.path.exists(package),
        "found": [place for place, folders, _ in os.walk("/") if not place.startswith("/proc/") and "scope_ptz" in folders
                  and os.listdir(place + "/scope_ptz")],
        "network": attempt(lambda: socket.create_connection(("127.0.0.1", 22), 1)),
        "interfaces": [name for _, name in socket.if_nameindex()],
        "processes": sum(name.isdigit() for name in os.listdir("/proc")),
        "home": os.path.exists({str(Path.home())!r} + "/.bashrc"),
        "tmp": os.listdir("/tmp"),
        "write": [attempt(lambda place=place: os.open(place, os.O_WRONLY | os.O_CREAT)) for place in {WRITE_ATTEMPTS}],
        "kill": attempt(lambda: os.kill({1 + 2**21}, 0)),
        "environment": sorted(os.environ),
    }})
    """
    report = json.loads(await answer_of(tmp_path, body, imports="import json, os, socket"))
    assert report["import"] == "ModuleNotFoundError" and not report["package"] and report["found"] == []
    assert report["network"] in ("ConnectionRefusedError", "OSError") and set(report["interfaces"]) <= {"lo"}
    assert report["processes"] <= 3 and not report["home"]
    mounted = {*tmp_path.parts, *Path(sys.prefix).parts, *Path(sys.base_prefix).parts}  # the tests themselves may run in /tmp
    assert [name for name in report["tmp"] if name not in mounted] == []
    assert all(error in ("OSError", "PermissionError") for error in report["write"])
    assert not [name for name in report["environment"] if name.startswith("SCOPE_")]


@needs_sandbox
async def test_hidden_files_within_the_agents_folder(tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "a.eval").write_text("answers")
    (tmp_path / "tasks.jsonl").write_text("answers")
    (tmp_path / "notes.txt").write_text("notes")
    installed_data = tmp_path / "env" / "lib" / "python3.11" / "site-packages" / "scope_ptz" / "data"
    installed_data.mkdir(parents=True)
    (installed_data / "tasks.jsonl").write_text("answers")
    body = """
    try:
        tasks = open("tasks.jsonl").read()
    except PermissionError:
        tasks = ""
    return "|".join([tasks, open("notes.txt").read(), *(name for _, _, files in os.walk(".") for name in files)])
    """
    hidden = (tmp_path / "logs", tmp_path / "tasks.jsonl", tmp_path / "nothing")
    seen = (await answer_of(tmp_path, body, imports="import os", hidden=hidden)).split("|")
    assert seen[:2] == ["", "notes"] and "a.eval" not in seen and seen.count("tasks.jsonl") == 1


@needs_sandbox
async def test_a_linked_folder_hides_the_same_files(tmp_path: Path) -> None:
    (tmp_path / "real" / "logs").mkdir(parents=True)
    (tmp_path / "real" / "logs" / "a.eval").write_text("answers")
    (tmp_path / "link").symlink_to("real")
    body = "return str([files for _, _, files in os.walk('.')])"
    assert "a.eval" not in await answer_of(tmp_path / "link", body, imports="import os", hidden=(tmp_path / "real" / "logs",))


@needs_sandbox
async def test_another_interpreter_uses_its_own_environment(tmp_path: Path) -> None:
    create_environment(tmp_path / "env")
    (packages,) = (tmp_path / "env").glob("lib/python*/site-packages")
    (packages / "only_there.py").write_text("ANSWER = 7\n")
    (packages / "scope_ptz").mkdir()
    (packages / "scope_ptz" / "__init__.py").write_text("SECRET = 1\n")
    (tmp_path / "agent").mkdir()
    body = "import scope_ptz\nreturn f'{only_there.ANSWER} {hasattr(scope_ptz, \"SECRET\")}'"
    name = write_agent(tmp_path / "agent", body, imports="import only_there")
    options = AgentOptions(sandbox=True, python=tmp_path / "env" / "bin" / "python")
    reply, _ = await run_to_reply(local_agent_in(tmp_path / "agent", name, options))
    assert reply.text == "7 False"


@needs_sandbox
async def test_a_command(tmp_path: Path) -> None:
    (tmp_path / "agent.sh").write_text(
        'echo \'{"type": "hello", "protocol": 1, "name": "sh"}\'; read -r task; '
        'echo "{\\"type\\": \\"reply\\", \\"text\\": \\"$(ls /tmp /home | tr -d \'\\n\')$(pwd)\\"}"'
    )
    reply, _ = await run_to_reply(local_agent_in(tmp_path, "scope", AgentOptions(sandbox=True, command="sh agent.sh")))
    assert str(tmp_path) in reply.text


@needs_sandbox
@pytest.mark.full
@pytest.mark.parametrize(
    ("body", "kind"),
    [
        ("raise ZeroDivisionError('oops')", "agent-error"),
        ("os._exit(4)", "agent-exited"),
        ("os.setsid() if os.fork() == 0 else None; time.sleep(60)", "agent-timeout"),
        ("kept = [os.urandom(400_000_000)]; time.sleep(60)", "agent-memory"),
    ],
)
async def test_failures_in_a_sandbox(tmp_path: Path, body: str, kind: str) -> None:
    options = AgentOptions(sandbox=True, memory_mb=300, times=AgentTimeLimits(step_s=20 if "urandom" in body else 2, run_s=30))
    with pytest.raises(PlannerError) as excinfo:
        await run_to_reply(local_agent_in(tmp_path, write_agent(tmp_path, body, imports="import os, time"), options))
    assert excinfo.value.kind == kind


def test_folders_that_a_sandbox_must_not_expose(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "people" / "me"))
    (tmp_path / "people" / "me" / "agent").mkdir(parents=True)
    for folder in (Path("/"), tmp_path / "people", tmp_path / "people" / "me"):
        with pytest.raises(ConfigError, match="home folder"):
            sandbox_command(["true"], SandboxContents(folder, (), None, ()))
    with pytest.raises(ConfigError, match="hides"):
        sandbox_command(["true"], SandboxContents(tmp_path / "people" / "me" / "agent", (), None, (tmp_path / "people" / "me",)))
    assert "--unshare-all" in sandbox_command(["true"], SandboxContents(tmp_path / "people" / "me" / "agent", (), None, ()))


def test_without_bubblewrap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ConfigError, match="apt-get install bubblewrap"):
        require_sandbox()
    (tmp_path / "bwrap").write_text("#!/bin/sh\necho 'No permissions to create new namespace' >&2\nexit 1\n")
    (tmp_path / "bwrap").chmod(0o755)
    with pytest.raises(ConfigError, match="No permissions to create new namespace"):
        require_sandbox()


pytestmark = [pytest.mark.anyio, pytest.mark.skipif(sys.platform != "linux", reason="bubblewrap needs Linux")]
