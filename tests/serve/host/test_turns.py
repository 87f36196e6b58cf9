"""Turns: each task is attempted once, one after the other, regardless of what an agent sends."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.serve.bench_host.journal import JOURNAL_FILE
from scope_ptz.serve.bench_host.wire import EvaluationSettings
from tests.serve.host.hosting import HELLO, Agent, call, hosting, reply
from tests.serve.host.scripted_worker import ScriptedWorker

pytestmark = pytest.mark.anyio
SETTINGS = EvaluationSettings(tasks="core")


async def attempt(agent: Agent) -> str:
    """Carry out one task, and return its instruction."""
    task = await agent.say(HELLO)
    assert (await agent.say(call("go_home")))["type"] == "results"
    assert (await agent.say(reply("none")))["type"] == "end"
    return str(task["instruction"])


async def test_each_task_is_attempted_once_in_turn(tmp_path: Path) -> None:
    fake = ScriptedWorker(3)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert [await attempt(agent) for _ in range(3)] == ["instruction 0", "instruction 1", "instruction 2"]
        assert (await agent.say(HELLO))["type"] == "end"
        assert (await agent.progress())["phase"] == "finished"
    assert list(fake.log.values()) == [["hello", "calls", "reply"]] * 3


async def test_a_second_connection_sees_the_same_task_and_cannot_begin_it_again(tmp_path: Path) -> None:
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as one, hosted.agent() as other:
        first = await one.say(HELLO)
        assert await other.say(HELLO) == first
        assert await other.say({**HELLO, "sees": True}) == first
        await one.say(reply("7"))
        refused = await other.post(reply("8"))
        assert refused.status_code in (409, 503)
        assert (await other.say(HELLO))["instruction"] == "instruction 1"
    assert fake.log["anna-0"] == ["hello", "reply"]


async def test_messages_after_the_answer_are_refused(tmp_path: Path) -> None:
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.post(call("go_home"))).status_code == 409
        await attempt(agent)
        for late in (call("go_home"), reply("another answer"), {"type": "view"}):
            assert (await agent.post(late)).status_code == 409
    assert fake.log["anna-0"] == ["hello", "calls", "reply"]


@pytest.mark.parametrize(
    "garbage",
    [b"", b"\x00\xff", b"[]", b'{"type": "reply"}', b'{"type": "answers"}', b'{"type": "calls", "calls": []}', b"[" * 9000,
     b'{"type": "reply", "text": "7", "headline": "correct"}',
     b'{"type": "calls", "calls": [{"id": "1", "name": "go_home", "arguments": {"n": NaN}}]}'],
)  # fmt: skip
async def test_garbage_ends_the_attempt_and_the_host_continues(tmp_path: Path, garbage: bytes) -> None:
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.post(garbage)).status_code == 409, "garbage begins no task"
        await agent.say(HELLO)
        assert (await agent.post(garbage)).json()["type"] == "error"
        assert await attempt(agent) == "instruction 1"
    assert fake.log["anna-0"] == ["hello", "agent-protocol"]


async def test_a_large_message_is_refused_and_the_host_continues(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        await agent.say(HELLO)
        assert (await agent.post(reply("7" * 10_000_000))).status_code == 413
        assert (await agent.say(reply("7")))["type"] == "end"


async def test_an_agent_that_never_answers_fails_the_task_and_gets_the_next_one(tmp_path: Path) -> None:
    fake = ScriptedWorker(2, step_s=0.2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        await agent.say(HELLO)
        await agent.until("ready")
        late = await agent.post(reply("too late"))
        assert late.status_code == 409
        assert (await agent.say(HELLO))["instruction"] == "instruction 1"
    assert fake.log["anna-0"] == ["hello", "agent-timeout"]


async def test_parallel_messages_count_once(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        tasks = await asyncio.gather(*(agent.say(HELLO) for _ in range(5)))
        assert len({task["task"] for task in tasks}) == 1
        answers = await asyncio.gather(*(agent.post(reply(f"{number}")) for number in range(5)))
        assert sorted(answer.status_code for answer in answers)[0] == 200
        assert [answer.status_code for answer in answers].count(200) == 1
    assert fake.log["anna-0"] == ["hello", "reply"]


async def test_a_wrong_version_begins_no_task(tmp_path: Path) -> None:
    fake = ScriptedWorker(1)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.say({**HELLO, "protocol": 99}))["type"] == "error"
        assert (await agent.progress())["begun"] == 0


async def test_a_restarted_host_resumes_the_attempt(tmp_path: Path) -> None:
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        await attempt(agent)
        await agent.say(HELLO)
        await agent.say(call("go_home"))
    resumed = ScriptedWorker(2)
    async with hosting(tmp_path / "host", resumed.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.say(HELLO))["instruction"] == "instruction 1"
        assert (await agent.progress())["last"]["type"] == "results"
        await agent.say(reply("none"))
        assert (await agent.say(HELLO))["type"] == "end"
    assert resumed.log == {"anna-0": ["hello", "calls", "reply"], "anna-1": ["hello", "calls", "reply"]}


async def test_a_journal_with_a_torn_line_is_repaired(tmp_path: Path) -> None:
    async with hosting(tmp_path / "host", ScriptedWorker(2).worker, SETTINGS) as hosted, hosted.agent() as agent:
        await attempt(agent)
        journal = hosted.host.evaluation("anna").journal.path
    assert journal.name == JOURNAL_FILE
    with journal.open("ab") as file:
        file.write(b'{"type": "received", "run": "anna-1", "li')
    async with hosting(tmp_path / "host", ScriptedWorker(2).worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.say(HELLO))["instruction"] == "instruction 1"


async def test_a_worker_that_crashes_is_started_again_and_loses_nothing(tmp_path: Path) -> None:
    crashes = ["anna-0/2"]

    def crash(place: str) -> bool:
        if place not in crashes:
            return False
        crashes.remove(place)
        return True

    fake = ScriptedWorker(1, crash_in=crash)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert await attempt(agent) == "instruction 0"
    assert not crashes
    assert fake.log["anna-0"] == ["hello", "calls", "reply"]


async def test_a_worker_that_keeps_crashing_stops_only_its_participant(tmp_path: Path) -> None:
    fake = ScriptedWorker(1, crash_in=lambda place: place.startswith("anna-0/2"))
    both = ("anna", "ben")
    async with (
        hosting(tmp_path / "host", fake.worker, SETTINGS, both) as hosted,
        hosted.agent("anna") as anna,
        hosted.agent("ben") as ben,
    ):
        await anna.say(HELLO)
        assert (await anna.post(call("go_home"))).status_code == 503
        assert (await anna.post(HELLO)).status_code == 503
        assert await attempt(ben) == "instruction 0"


async def test_closing_counts_tasks_that_were_not_attempted(tmp_path: Path) -> None:
    async with hosting(tmp_path / "host", ScriptedWorker(3).worker, SETTINGS) as hosted, hosted.agent() as agent:
        await attempt(agent)
        await agent.say(HELLO)
    fake = ScriptedWorker(3)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS, fail_unfinished=True) as hosted:
        await hosted.host.wait_until_finished(start=True)
    assert fake.log == {
        "anna-0": ["hello", "calls", "reply"], "anna-1": ["hello", "agent-exited"], "anna-2": ["agent-exited"],
    }  # fmt: skip


async def test_a_run_that_ended_is_not_offered_again(tmp_path: Path) -> None:
    """If the engine lost the run of an agent that took too long, it fails again, and the agent gets no second attempt."""
    async with hosting(tmp_path / "host", ScriptedWorker(2, step_s=0.2).worker, SETTINGS) as hosted, hosted.agent() as agent:
        await agent.say(HELLO)
        await agent.until("ready")
    fake = ScriptedWorker(2)
    async with hosting(tmp_path / "host", fake.worker, SETTINGS) as hosted, hosted.agent() as agent:
        assert (await agent.say(HELLO))["instruction"] == "instruction 1"
    assert fake.log["anna-0"] == ["hello", "agent-exited"]


def test_names_of_folders_differ() -> None:
    from scope_ptz.serve.bench_host.host import folder_name

    names: list[Any] = ["anna", "Anna", "an na", "an_na", "a..", "a.@-"]
    folders = [folder_name(name) for name in names]
    assert len({folder.lower() for folder in folders}) == len(names)
    assert all(folder.replace("-", "").replace("_", "").isalnum() for folder in folders)
