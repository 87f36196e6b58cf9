"""Agents in separate processes get what they need and nothing else."""

from __future__ import annotations

import json
import os
import shlex
import sys
from pathlib import Path

import pytest

from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.source import find_module_source
from scope_ptz.bench.engine.external_agents import AgentReply
from scope_ptz.errors import ConfigError
from tests.bench.agents.conformance import FRAME
from tests.bench.agents.programs import create_environment, local_agent_in, run_to_reply, write_agent
from tests.bench.agents.sandboxes import SANDBOX_PROBLEM


async def test_calls_that_are_awaited_together_are_one_step(tmp_path: Path) -> None:
    body = """
    one, two = await asyncio.gather(session.call("count_objects", {"description": "a"}), session.call("take_image"))
    three = await session.call("go_home")
    return f"{one['count']} {two['count']} {three['count']}"
    """
    agent = local_agent_in(tmp_path, write_agent(tmp_path, body, imports="import asyncio"))
    counts = {"count_objects": 2, "take_image": 3, "go_home": 5}
    reply, steps = await run_to_reply(agent, lambda call: {"count": counts[call.name]})
    assert [[call.name for call in step] for step in steps] == [["count_objects", "take_image"], ["go_home"]]
    assert steps[0][0].arguments == {"description": "a"} and (reply.kind, reply.text) == ("answered", "2 3 5")


async def test_session_attributes(tmp_path: Path) -> None:
    body = """
    assert session.instruction == "Zähle die Bälle 🎈", session.instruction
    assert session.presets == ("gate", "yard") and session.tools[0]["function"]["name"] == "count_objects"
    assert session.limits.max_zoom == 5.0 and not session.limits.pan_endless
    assert (session.pose.pan_deg, session.pose.tilt_deg, session.pose.zoom) == (1.5, -2.0, 3.0)
    return repr(session.view())
    """
    for sees, view in ((True, FRAME), (False, None)):
        reply, _ = await run_to_reply(local_agent_in(tmp_path, write_agent(tmp_path, body, sees=sees)))
        assert reply.text == repr(view) and reply.opened is sees


@pytest.mark.parametrize(
    "result",
    [
        "AgentReply('Which?', 'clarification')",
        "{'text': 'Which?', 'kind': 'clarification'}",
        "types.SimpleNamespace(text='Which?', kind='clarification')",
    ],
)
@pytest.mark.parametrize("module", ["scope_agent", "scope_ptz.bench.engine.external_agents"])
async def test_replies(tmp_path: Path, result: str, module: str) -> None:
    agent = local_agent_in(
        tmp_path, write_agent(tmp_path, f"return {result}", imports=f"import types\nfrom {module} import AgentReply")
    )
    reply, _ = await run_to_reply(agent)
    assert (reply.kind, reply.text) == ("clarification", "Which?")
    assert AgentReply("Which?", "clarification") == AgentReply("Which?", "clarification")


async def test_printed_text_is_not_read_as_a_message(tmp_path: Path) -> None:
    body = """
    print('{"type": "reply", "text": "printed"}', flush=True)
    sys.stdout.write("x" * 100_000)
    os.system("echo shell; cat")
    print(sys.stdin.read())
    subprocess.run(["sh", "-c", "echo process; echo error >&2"])
    return "returned"
    """
    imports = "import os, subprocess, sys\nprint('imported')"
    reply, _ = await run_to_reply(local_agent_in(tmp_path, write_agent(tmp_path, body, imports=imports)))
    assert reply.text == "returned"


async def test_the_environment_is_clean(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("SCOPE_PLANNER_KEY", "OPENAI_API_KEY", "THEIR_KEY", "LC_TIME"):
        monkeypatch.setenv(name, "value")
    name = write_agent(tmp_path, "return json.dumps(sorted(os.environ))", imports="import json, os")
    variables = set(json.loads((await run_to_reply(local_agent_in(tmp_path, name)))[0].text))
    assert "PATH" in variables and "LC_TIME" in variables and not variables & {"SCOPE_PLANNER_KEY", "OPENAI_API_KEY", "THEIR_KEY"}
    options = AgentOptions(variables=("THEIR_KEY",))
    variables = set(json.loads((await run_to_reply(local_agent_in(tmp_path, name, options)))[0].text))
    assert "THEIR_KEY" in variables and "OPENAI_API_KEY" not in variables
    with pytest.raises(ConfigError, match="NOT_SET"):
        local_agent_in(tmp_path, name, AgentOptions(variables=("NOT_SET",)))


async def test_open_files_are_not_inherited(tmp_path: Path) -> None:
    body = """
    descriptors = [f"/proc/self/fd/{number}" for number in os.listdir("/proc/self/fd")]
    return " ".join(os.readlink(path) for path in descriptors if os.path.exists(path))
    """
    secret = tmp_path / "tasks.jsonl"
    with secret.open("w") as file:
        os.set_inheritable(file.fileno(), True)
        reply, _ = await run_to_reply(local_agent_in(tmp_path, write_agent(tmp_path, body, imports="import os")))
    assert "tasks.jsonl" not in reply.text


async def test_another_interpreter_uses_its_own_environment(tmp_path: Path) -> None:
    create_environment(tmp_path / "env")
    python = tmp_path / "env" / "bin" / "python"
    (packages,) = (tmp_path / "env").glob("lib/python*/site-packages")
    (packages / "only_there.py").write_text("ANSWER = 7\n")
    body = """
    try:
        import scope_ptz
    except ImportError:
        return AgentReply(f"{only_there.ANSWER} {sys.prefix}")
    """
    name = write_agent(tmp_path, body, imports="import only_there, sys\nfrom scope_agent import AgentReply")
    reply, _ = await run_to_reply(local_agent_in(tmp_path, name, AgentOptions(python=python)))
    assert reply.text == f"7 {tmp_path / 'env'}"
    with pytest.raises(ConfigError, match="does not exist"):
        local_agent_in(tmp_path, name, AgentOptions(python=tmp_path / "nothing"))
    with pytest.raises(ConfigError, match="exit code 1"):
        await local_agent_in(tmp_path, name, AgentOptions(python=Path("/bin/false"))).check()


def test_an_environment_is_read_without_running_it(tmp_path: Path) -> None:
    create_environment(tmp_path / "env")
    (packages,) = (tmp_path / "env").glob("lib/python*/site-packages")
    (packages / "loud.pth").write_text(f"import os; open({str(tmp_path / 'it-ran')!r}, 'w')\n{tmp_path / 'linked'}\n")
    (tmp_path / "linked").mkdir()
    (tmp_path / "agent").mkdir()
    write_agent(tmp_path / "linked", "return 'x'")
    options = AgentOptions(python=tmp_path / "env" / "bin" / "python", sandbox=not SANDBOX_PROBLEM)
    assert local_agent_in(tmp_path / "agent", "their_agent:Agent", options).source
    assert not (tmp_path / "it-ran").exists()


SHELL = r"""
echo '{"type": "hello", "protocol": 1, "name": "shell"}'
read -r task
echo '{"type": "calls", "calls": [{"id": "1", "name": "count_objects", "arguments": {"description": "balls"}}]}'
read -r results
count=$(printf '%s' "$results" | sed 's/.*"count":\([0-9]*\).*/\1/')
echo "{\"type\": \"reply\", \"text\": \"There are $count $1.\"}"
"""


async def test_a_shell_script(tmp_path: Path) -> None:
    (tmp_path / "their agent.sh").write_text(SHELL)
    agent = local_agent_in(tmp_path, "scope", AgentOptions(command="sh 'their agent.sh' '$HOME; balls'"))
    assert (agent.name, agent.isolation) == ("command:their agent.sh", "isolated")
    reply, steps = await run_to_reply(agent, lambda _: {"count": 4})
    assert reply.text == "There are 4 $HOME; balls." and steps[0][0].arguments == {"description": "balls"}
    before = agent.source
    (tmp_path / "their agent.sh").write_text(SHELL + "#")
    assert local_agent_in(tmp_path, "scope", AgentOptions(command="sh 'their agent.sh' '$HOME; balls'")).source != before


@pytest.mark.parametrize("command", ["", "nothing-of-this-name", "sh 'open", "   "])
def test_invalid_commands_are_rejected(tmp_path: Path, command: str) -> None:
    with pytest.raises(ConfigError):
        local_agent_in(tmp_path, "scope", AgentOptions(command=command))


def test_contradictory_options_are_rejected(tmp_path: Path) -> None:
    for options in (
        AgentOptions(command="sh", in_process=True),
        AgentOptions(command="sh", python=Path(sys.executable)),
        AgentOptions(in_process=True, sandbox=True),
        AgentOptions(in_process=True, python=Path(sys.executable)),
    ):
        with pytest.raises(ConfigError):
            local_agent_in(tmp_path, "a:B", options)


async def test_an_agent_that_does_not_start_is_an_error_before_the_first_run(tmp_path: Path) -> None:
    write_agent(tmp_path, "return 'x'", imports="import nothing_of_this_name")
    with pytest.raises(ConfigError, match="nothing_of_this_name"):
        await local_agent_in(tmp_path, "their_agent:Agent").check()
    with pytest.raises(ConfigError, match="no attribute"):
        await local_agent_in(tmp_path, "json:Nothing").check()
    with pytest.raises(ConfigError, match="exit code 1"):
        await local_agent_in(tmp_path, "scope", AgentOptions(command=shlex.join(["sh", "-c", "exit 1"]))).check()


def test_the_source_is_found_without_running_it(tmp_path: Path) -> None:
    (tmp_path / "loud.py").write_text("raise SystemExit('it ran')")
    source = find_module_source("loud:Agent", tmp_path, ())
    assert source is not None and source.files == {"loud.py": tmp_path / "loud.py"}
    assert find_module_source("nothing_of_this_name:Agent", tmp_path, ()) is None


pytestmark = pytest.mark.anyio
