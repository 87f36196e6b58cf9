"""``scope bench judge-gold``: resuming, repeats and counts, and how commands resolve a judge."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import anyio
import pytest
from typer.testing import CliRunner, Result

from scope_ptz.bench.program_runner import ProgramRunner
from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import Task
from scope_ptz.cli.app import app
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.factory.judges import UnnamedJudgeError, open_judge
from scope_ptz.factory.scenes import open_scene
from scope_ptz.factory.validation_perception import ground_truth_tools
from scope_ptz.taskgen.authoring.task_places import preset_position
from scope_ptz.taskgen.facts.robust import TASK_CAMERA
from scope_ptz.taskgen.gold.gold_runs import write_gold
from scope_ptz.taskgen.gold.judge_results import read_verdicts
from scope_ptz.taskgen.gold.mutations import FaultContext, mutate
from tests.bench.judging.runs import CORRECT, json_text
from tests.bench.judging.test_labels import turn_task
from tests.support import misbehaving as m

KEY = "sk-judge-0123456789"


@pytest.fixture(scope="module")
def gold(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with two tasks of a bundled scene and their gold runs, which turn the wrong way or do not turn."""
    folder = tmp_path_factory.mktemp("gold")
    scene = open_scene("highway-works")
    runner = ProgramRunner(scene, ground_truth_tools({scene.name: scene}), TASK_CAMERA)
    context = FaultContext({preset.name: preset_position(preset) for preset in scene.file.presets}, TASK_CAMERA)
    tasks = [turn_task(1, 20), turn_task(2, 30)]

    async def run(task: Task) -> Episode:
        return await runner.run(task, task.reference, "Done.")

    gold_runs = [
        mutate(task, anyio.run(run, task), mode, context, random.Random(1))
        for task in tasks
        for mode in (ErrorMode.TOOL_ARGS, ErrorMode.LACK_OF_TOOL_CALL)
    ]
    dump_tasks(tasks, folder / "tasks.jsonl")
    write_gold([one for one in gold_runs if one is not None], folder / "gold.jsonl.gz")
    return folder


def good_judge(x: m.Exchange) -> Any:
    """Reply as a judge that determines the verdict and the error mode from the calls in the request."""
    prompt = x.request.data["messages"][1]["content"]
    if "Tool calls: none." in prompt:
        return m.say(json_text({"reason": "No call.", "verdict": "incorrect", "error_mode": "lack_of_tool_call"}))(x)
    if '"pan_deg": -' in prompt:
        return m.say(json_text({"reason": "Wrong way.", "verdict": "incorrect", "error_mode": "tool_args"}))(x)
    return m.say(json_text(CORRECT))(x)


def judge_gold(gold: Path, out: Path, url: str, *options: str) -> Result:
    options_for_files = ["--gold", str(gold / "gold.jsonl.gz"), "--tasks", str(gold / "tasks.jsonl"), "--out", str(out)]
    return CliRunner().invoke(
        app, ["bench", "judge-gold", *options_for_files, "--judge-url", url, "--judge-model", "gpt-oss-120b", *options]
    )


@pytest.mark.full
def test_a_judge_of_gold_runs_from_the_command_line(gold: Path, tmp_path: Path) -> None:
    out = tmp_path / "verdicts.jsonl"
    with m.Misbehaving(then=good_judge) as server:
        result = judge_gold(gold, out, server.url)
        assert result.exit_code == 0, result.output
        assert "gpt-oss-120b (judge-1:" in result.output
        assert "6 gold runs" in result.output
        assert "false accepts: 0.0%" in result.output
        assert "false rejects: 0.0%" in result.output
        assert len(server.requests) == 6
        second = judge_gold(gold, out, server.url, "--repeats", "2", "--json")
        assert len(server.requests) == 12, "existing verdicts must not be requested again"
    (content,) = json.loads(second.stdout)
    assert (content["runs"], content["judgements"]) == (6, 12)
    with m.Misbehaving(then=good_judge) as server:
        output = judge_gold(gold, out, server.url, "--repeats", "2").output
    assert "6 gold runs, 12 judgements; rows: inserted fault" in output
    assert all(f" {head}" in output for head in ("lack", "routing", "halluc.", "unparseable"))
    assert content["modes"]["raw"] == 1.0
    comparison = CliRunner().invoke(app, ["bench", "agree", str(out)])
    assert "the known faults  against  gpt-oss-120b" in comparison.output
    assert "repeats of gpt-oss-120b" in comparison.output


def test_failed_judgements_are_repeated_and_count_once(gold: Path, tmp_path: Path) -> None:
    out = tmp_path / "verdicts.jsonl"
    with m.Misbehaving(then=m.status(401)) as server:
        failed = judge_gold(gold, out, server.url, "--json")
    assert failed.exit_code == 1
    assert "6 of 6 judgements failed because the judge's server gave no usable reply" in failed.stderr
    with m.Misbehaving(then=m.status(401)) as server:
        plain = judge_gold(gold, out, server.url)
    assert "correct or not: no run was rated by both" in plain.output and "all ratings are the same" not in plain.output
    (content,) = json.loads(failed.stdout)
    assert content["apart"] == {"unparseable": 0, "failed": 6}
    assert content["false_accept_rate"] is None
    with m.Misbehaving(then=good_judge) as server:
        retried = judge_gold(gold, out, server.url, "--json")
    (content,) = json.loads(retried.stdout)
    assert content["apart"] == {"unparseable": 0, "failed": 0}
    assert content["runs"] == 6
    assert len(read_verdicts(out)) == 18


def test_an_unavailable_judge_is_an_error_before_anything_is_written(gold: Path, tmp_path: Path) -> None:
    out = tmp_path / "verdicts.jsonl"
    options_for_files = ["--gold", str(gold / "gold.jsonl.gz"), "--tasks", str(gold / "tasks.jsonl"), "--out", str(out)]
    result = CliRunner().invoke(app, ["bench", "judge-gold", *options_for_files, "--judge-url", "http://127.0.0.1:1/v1"])
    assert result.exit_code == 1 and "nothing was judged" in result.stderr and not out.exists()


def test_a_limit_is_spread_over_error_modes(gold: Path, tmp_path: Path) -> None:
    out = tmp_path / "verdicts.jsonl"
    with m.Misbehaving(then=good_judge) as server:
        judge_gold(gold, out, server.url, "--limit", "2", "--passing", "0")
    assert {verdict.fault for verdict in read_verdicts(out)} == {ErrorMode.TOOL_ARGS, ErrorMode.LACK_OF_TOOL_CALL}


def models(*names: str) -> m.Behaviour:
    return m.body(json.dumps({"object": "list", "data": [{"id": name} for name in names]}))


async def name_of(url: str, model: str | None = None) -> str:
    port = await open_judge(url, model, None, 30.0)
    await port.close()
    return port.client.endpoint.model


@pytest.mark.parametrize(
    ("listing", "name"),
    [
        (lambda: models("tiny", "openai/gpt-oss-120b"), "openai/gpt-oss-120b"),
        (lambda: models("tiny"), "tiny"),
    ],
)
def test_the_judge_is_named_after_the_model_of_its_server(listing: Callable[[], m.Behaviour], name: str) -> None:
    with m.Misbehaving(then=listing()) as server:
        assert anyio.run(name_of, server.url) == name


@pytest.mark.parametrize("listing", [lambda: m.status(404), lambda: models()])
def test_a_judge_needs_a_name_if_its_server_lists_no_model(listing: Callable[[], m.Behaviour]) -> None:
    with m.Misbehaving(then=listing()) as server:
        with pytest.raises(UnnamedJudgeError, match=r"did not report the name of its model.*--judge-model"):
            anyio.run(name_of, server.url)
        assert anyio.run(name_of, server.url, "mine") == "mine"


def test_a_server_with_several_models_requires_a_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    with m.Misbehaving(then=models("a", "b")) as server:
        with pytest.raises(InputError, match="--judge-model: a, b"):
            anyio.run(name_of, server.url)
        assert anyio.run(name_of, server.url, "b") == "b"
        monkeypatch.setenv("SCOPE_JUDGE_MODEL", "a")
        assert anyio.run(name_of, server.url) == "a"


def test_the_judge_is_read_from_the_environment_and_its_key_is_sent_to_no_other_server(
    gold: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with m.Misbehaving(then=m.echo_key()) as server:
        monkeypatch.setenv("SCOPE_JUDGE_URL", server.url)
        monkeypatch.setenv("SCOPE_JUDGE_MODEL", "judge")
        monkeypatch.setenv("SCOPE_JUDGE_KEY", KEY)
        monkeypatch.setenv("SCOPE_PLANNER_KEY", "sk-planner-0123456789")
        out = tmp_path / "v.jsonl"
        options_for_files = ["--gold", str(gold / "gold.jsonl.gz"), "--tasks", str(gold / "tasks.jsonl"), "--out", str(out)]
        result = CliRunner().invoke(app, ["bench", "judge-gold", *options_for_files, "--limit", "1", "--passing", "0"])
        assert result.exit_code == 1 and "rejected the API key" in result.stderr, result.output
        assert {request.headers["authorization"] for request in server.requests} == {f"Bearer {KEY}"}
    assert KEY not in result.output
    assert KEY not in out.read_text()


def test_a_missing_judge_and_wrong_options_are_reported() -> None:
    with pytest.raises(ConfigError, match="SCOPE_JUDGE_URL"):
        anyio.run(open_judge, None, None, None, 30.0)
    with pytest.raises(ConfigError, match="reasoning_effort"):
        anyio.run(open_judge, "http://127.0.0.1:9/v1", "x", None, 30.0, ["reasoning_effort=huge"])
    with pytest.raises(ConfigError, match="not a valid model server URL"):
        anyio.run(open_judge, "file:///etc/passwd", "x", None, 30.0)
