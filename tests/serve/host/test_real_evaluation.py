"""Real tasks, the real engine and both channels: the log, the signed submission, and what a participant learns."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import pytest
from mcp_types import ImageContent

from scope_ptz.bench.engine.logs import read_evaluation
from scope_ptz.bench.signatures.keys import public_path, read_trusted_keys
from scope_ptz.bench.signatures.provenance import provenance_of
from scope_ptz.bench.tasks.expected import Number
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import CANARY, Task
from scope_ptz.serve.bench_host.wire import EvaluationSettings
from scope_ptz.serve.bench_host.worker import run_worker
from tests.bench.engine.yard_tasks import SCENE, TASKS
from tests.serve.host.hosting import HELLO, Agent, Hosted, call, hosting, reply
from tests.serve.mcp.agents import text_of

pytestmark = [pytest.mark.anyio, pytest.mark.usefixtures("scenes")]
PRIVATE_WORDS = (
    CANARY, "scope1", "evidence", "expected", "reference", "stratum", "difficulty", "category", "headline", "verdict", "checks",
    "dataset", "epoch", "private-tasks", "tolerance", "paraphrase", "elapsed", "seed", "instance", "truth.json", "submission",
)  # fmt: skip
"""Words that stand only in tasks, logs and files of the host."""


@pytest.fixture
def settings(tmp_path: Path) -> EvaluationSettings:
    path = tmp_path / "private-tasks.jsonl"
    dump_tasks(TASKS, path)
    return EvaluationSettings(tasks=str(path))


def instructions() -> dict[str, Task]:
    return {task.instruction: task for task in TASKS}


async def solve(agent: Agent) -> str | None:
    """Carry out a task as its instruction says. Return the instruction; None when all tasks have been attempted."""
    task = await agent.say(HELLO)
    if task["type"] == "end":
        return None
    instruction = str(task["instruction"])
    if counted := re.fullmatch(r"how many (\w+) are visible\?", instruction):
        answer = await agent.say(call("count_objects", description=counted[1], view="current"))
        text = f"I count {answer['results'][0]['result']['count']}."
    else:
        (angle,) = re.findall(r"[\d.]+", instruction)
        await agent.say(call("adjust_ptz", pan_deg=float(angle)))
        text = "Done."
    assert (await agent.say(reply(text)))["type"] == "end"
    return instruction


def check_secrecy(received: list[bytes], *, also: tuple[str, ...] = ()) -> None:
    """Check that no message to a participant contains an answer before it was asked for, or anything about the tasks."""
    assert received
    for text in received:
        decoded = text.decode("utf-8", "replace")
        without_schemas = re.sub(r'"tools":\[.*?\],"presets"', '"presets"', decoded, flags=re.DOTALL)
        for word in (*PRIVATE_WORDS, *also):
            assert word.lower() not in without_schemas.lower(), (word, without_schemas[:500])
        for task in TASKS:
            assert task.id not in decoded
        shown = [task for task in TASKS if task.instruction in decoded]
        assert len(shown) <= 1, "a message contains the instruction of one task at most"
    for text in received:
        body = text.partition(b"\n\n")[2]
        if not body.startswith(b'{"type":"task"'):
            continue
        task = json.loads(body)
        assert set(task) == {"type", "protocol", "task", "instruction", "tools", "presets", "limits", "pose"}
        assert re.fullmatch(r"[0-9a-f]{16}", task["task"])


def check_log(host: Hosted, right: int) -> None:
    """Check the log and the signed submission of anna."""
    folder = host.host.evaluation("anna").settings.folder
    (log,) = folder.glob("*.eval")
    evaluation = read_evaluation(log)
    assert evaluation.finished
    assert sum(trial.headline == "correct" for trial in evaluation.trials) == right
    assert evaluation.card.isolation == "hosted"
    assert evaluation.card.agent == "anna"
    submission = folder / "submission.jsonl"
    provenance = provenance_of(submission, read_trusted_keys([public_path(host.host.key)]))
    assert (provenance.evaluated, provenance.faults) == ("hosted", ())
    assert json.loads(submission.read_text("utf-8").splitlines()[0])["kind"] == "header"


async def test_an_evaluation_over_http(tmp_path: Path, settings: EvaluationSettings) -> None:
    async with hosting(tmp_path / "host", run_worker, settings) as hosted, hosted.agent() as agent:
        assert await hosted.host.check() == len(TASKS)
        done = [await solve(agent) for _ in TASKS]
        assert sorted(filter(None, done)) == sorted(instructions())
        assert await solve(agent) is None
        check_log(hosted, right=3)
        check_secrecy(hosted.received, also=(SCENE, hosted.tokens["anna"]))


@pytest.mark.full
async def test_an_evaluation_over_mcp(tmp_path: Path, settings: EvaluationSettings) -> None:
    async with hosting(tmp_path / "host", run_worker, settings) as hosted, hosted.mcp() as client:
        frames: list[bytes] = []
        for _ in TASKS:
            instruction = text_of(await client.call_tool("begin_task", {"frames": True}))
            seen = await client.call_tool("view", {})
            frames += [base64.b64decode(part.data) for part in seen.content if isinstance(part, ImageContent)]
            if counted := re.fullmatch(r"how many (\w+) are visible\?", instruction):
                result: Any = (await client.call_tool("count_objects", {"description": counted[1]})).structured_content
                await client.call_tool("answer", {"text": f"I count {result['result']['count']}."})
            else:
                await client.call_tool("adjust_ptz", {"pan_deg": float(re.findall(r"[\d.]+", instruction)[0])})
                await client.call_tool("answer", {"text": "Done."})
        assert "finished" in text_of(await client.call_tool("begin_task", {}))
        check_log(hosted, right=3)
        assert len(frames) == len(TASKS)
        for frame in frames:
            assert segments(frame) <= {0xC0, 0xC4, 0xDA, 0xDB, 0xE0}, "a frame has no metadata"
        check_secrecy(hosted.received)


@pytest.mark.full
async def test_an_agent_that_gives_up_fails_and_counts(tmp_path: Path, settings: EvaluationSettings) -> None:
    short = settings.model_copy(update={"step_s": 1.0})
    async with hosting(tmp_path / "host", run_worker, short) as hosted, hosted.agent() as agent:
        await agent.say(HELLO)  # and then nothing
        assert (await agent.say(HELLO))["type"] in ("task", "end")
        await agent.until("ready")
        await agent.say(HELLO)
        assert (await agent.post(b"garbage")).json()["type"] == "error"
        await agent.say(HELLO)
        await agent.say(reply("nonsense"))
        assert await solve(agent) is not None
        assert await solve(agent) is None
        (log,) = hosted.host.evaluation("anna").settings.folder.glob("*.eval")
        trials = read_evaluation(log).trials
        assert len(trials) == len(TASKS)
        assert not any(trial.headline == "infrastructure" for trial in trials)


@pytest.mark.full
async def test_a_restarted_host_resumes_the_attempt(tmp_path: Path, settings: EvaluationSettings) -> None:
    async with hosting(tmp_path / "host", run_worker, settings) as hosted, hosted.agent() as agent:
        done = [await solve(agent)]
        second = (await agent.say(HELLO))["instruction"]
        before = await agent.say(call("adjust_ptz", pan_deg=1.0))
    async with hosting(tmp_path / "host", run_worker, settings) as hosted, hosted.agent() as agent:
        while (task := await agent.say(HELLO))["instruction"] != second:  # the engine may run other tasks first
            done.append(await solve(agent))
        assert task["instruction"] == second
        assert (await agent.progress())["last"] == before
        await agent.say(reply("nothing"))
        done.append(second)
        while (instruction := await solve(agent)) is not None:
            done.append(instruction)
        assert sorted(filter(None, done)) == sorted(instructions())
        assert await solve(agent) is None
        assert (await agent.progress())["begun"] == len(TASKS)
        (log,) = hosted.host.evaluation("anna").settings.folder.glob("*.eval")
        assert len(read_evaluation(log).trials) == len(TASKS)


@pytest.mark.full
async def test_the_order_differs_between_participants_and_not_between_restarts(
    tmp_path: Path, settings: EvaluationSettings
) -> None:
    from scope_ptz.bench.engine.entries import Entry
    from scope_ptz.serve.bench_host.host import Host
    from scope_ptz.serve.bench_host.worker import Worker
    from tests.bench.engine.yard_tasks import turning_tasks

    facts = [Entry.model_construct(facts=task) for task in turning_tasks(30)]

    def order(name: str) -> list[str]:
        host = Host(tmp_path / "order", settings, tmp_path / "key")
        worker = Worker.__new__(Worker)
        worker._settings = host.evaluation(name).settings
        return [entry.facts.id for entry in worker._order(facts)]

    assert order("anna") == order("anna") != order("ben") != sorted(order("ben"))
    assert sorted(order("anna")) == sorted(order("ben"))


async def test_the_host_receives_nothing_about_answers_from_a_worker(
    tmp_path: Path, settings: EvaluationSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process on the network holds only what it passes on."""
    from scope_ptz.serve.bench_host.links import LocalLink

    events: list[str] = []
    receive = LocalLink.receive

    async def recorded(link: LocalLink) -> Any:
        event = await receive(link)
        if event is not None:
            events.append(event.model_dump_json(exclude={"submission"}))
        return event

    monkeypatch.setattr(LocalLink, "receive", recorded)
    async with hosting(tmp_path / "host", run_worker, settings) as hosted, hosted.agent() as agent:
        while await solve(agent) is not None:
            pass
    check_secrecy([b"\n\n" + event.encode() for event in events if '"finished"' not in event], also=(SCENE,))
    values = [task.expected.value for task in TASKS if isinstance(task.expected, Number)]
    assert values


def segments(jpeg: bytes) -> set[int]:
    """Return the markers of the segments of a JPEG up to its first scan."""
    assert jpeg[:2] == b"\xff\xd8"
    found, at = set[int](), 2
    while True:
        assert jpeg[at] == 0xFF
        found.add(jpeg[at + 1])
        if jpeg[at + 1] == 0xDA:
            return found
        at += 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big")
