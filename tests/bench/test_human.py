"""``scope bench human``: the same tools and checks as for agents, and no loss of results on interruption."""

from __future__ import annotations

import io
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from scope_ptz.agent.trace import read_trace
from scope_ptz.bench.human_agent import TaskLeftError, parse
from scope_ptz.bench.human_runs import open_run, read_result
from scope_ptz.bench.human_viewer import Viewer, inline_sequence
from scope_ptz.bench.tasks.expected import ActionOnly, Number
from scope_ptz.bench.tasks.files import dump_tasks
from scope_ptz.bench.tasks.task import Aim, Behaviour, EvidenceView, FinalPose, Task
from scope_ptz.camera.base import Frame
from scope_ptz.errors import InputError, TraceError
from scope_ptz.geometry import AXIS_M5075_G, Perspective, Pose
from scope_ptz.planner.base import Finish, ToolCall
from tests.cli.conftest import Scope, scenes, scope

__all__ = ["scenes", "scope"]

BOARD = Aim(viewpoint="mast", pan_deg=-16.0, tilt_deg=-2.0, zoom=4.0)
THREE = Number(value=3, unit=("drum",))


def task(number: int, expected: ActionOnly | Number) -> Task:
    has_question = isinstance(expected, Number)
    view = EvidenceView(aim=BOARD, hfov_deg=AXIS_M5075_G.hfov_deg(4.0), whole=True, shows=THREE)
    return Task(
        id=f"scope1-analytic-yard-counting-{number:03d}",
        dataset="scope1",
        scene="analytic-yard",
        preset="yard",
        instruction="Go to the board and count the drums." if has_question else "Go to the board.",
        category="counting",
        scope="current",
        difficulty="easy",
        expected=expected,
        behaviour=Behaviour(final=FinalPose(**BOARD.model_dump())),
        evidence=(view,) if has_question else (),
        needs=("preset",),
    )


@pytest.fixture
def tasks(tmp_path: Path) -> Path:
    path = tmp_path / "tasks.jsonl"
    dump_tasks([task(1, ActionOnly()), task(2, THREE), task(3, THREE)], path)
    return path


def type_in(monkeypatch: pytest.MonkeyPatch, *lines: str) -> None:
    monkeypatch.setattr("sys.stdin", io.StringIO("".join(f"{line}\n" for line in lines)))


def test_a_human_run_is_scored_by_the_checks_and_can_be_resumed(
    scope: Scope, tasks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "human"
    type_in(monkeypatch, "preset board", "answer Done.", "preset board", "quit")
    first = scope("bench", "human", "--split", str(tasks), "--out", str(out), "--by", "ann")
    assert first.code == 0, first.err
    assert "1 of 3 tasks done, 1 correct" in first.out
    assert not (out / "scope1-analytic-yard-counting-002").exists()

    type_in(monkeypatch, "preset board", "count drums", "three", "3", "answer There are 3 drums.", "answer There are 3 drums.")
    second = scope("bench", "human", "--split", str(tasks), "--out", str(out), "--by", "ann")
    assert "2 of 3 tasks to do" in second.out and "Enter a whole number below 1000 in digits." in second.out
    result = read_result(out / "evaluation.json")
    assert [(t.task.id[-3:], t.headline) for t in result.trials] == [("001", "correct"), ("002", "correct"), ("003", "incorrect")]
    assert result.trials[1].tool_calls == {"go_to_preset": 1, "count_objects": 1}
    assert result.card.planner.name == "ann" and result.wanted == 3 and result.finished
    trace = read_trace(out / "scope1-analytic-yard-counting-002")
    assert trace.ended is not None and trace.ended.outcome == "answered" and trace.started.perception == "ann"
    pictures = sorted((out / "scope1-analytic-yard-counting-002" / "shown").iterdir())
    assert len(pictures) == 4 and np.asarray(cv2.imread(str(pictures[0]))).shape == (720, 1280, 3)


@pytest.mark.full
def test_a_report_shows_the_pictures_of_a_failed_task(
    scope: Scope, tasks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, report = tmp_path / "human", tmp_path / "report"
    type_in(monkeypatch, "answer Done.", "preset board", "answer There are 5 drums.", "quit")
    scope("bench", "human", "--split", str(tasks), "--out", str(out))
    run_result = scope("bench", "report", str(out / "evaluation.json"), "--tasks", str(tasks), "--out", str(report))
    assert run_result.code == 0, run_result.err
    (page,) = ((path.read_text("utf-8")) for path in (report / "tasks").glob("scope1-analytic-yard-counting-002*.html"))
    frames = re.findall(r'src="\.\./(frames/[^"]+)"', page)
    assert frames and all((report / frame).is_file() for frame in frames)


@pytest.mark.parametrize("name", ["../other", "/etc", "a/b", ".."])
def test_a_result_cannot_refer_to_a_run_outside_its_folder(tmp_path: Path, name: str) -> None:
    with pytest.raises(TraceError, match="outside"):
        open_run(tmp_path / "evaluation.json", name)


def test_the_end_of_the_input_loses_nothing(scope: Scope, tasks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    type_in(monkeypatch, "preset nowhere", "ask what is there", "a yard", "skip", "preset board", "count drums")
    run_result = scope("bench", "human", "--split", str(tasks), "--out", str(tmp_path / "human"))
    assert run_result.code == 0
    assert "There is no preset 'nowhere'" in run_result.out and "a yard (seen by a person)" in run_result.out
    assert "No runs were recorded." in run_result.out
    assert list((tmp_path / "human").iterdir()) == []


def test_a_human_can_frame_an_object(scope: Scope, tasks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    box = "40 40 60 60"
    type_in(monkeypatch, "zoomto the board", "9 9", box, "30 30 70 70", "", "answer Done.")
    run_result = scope("bench", "human", "--split", str(tasks), "--out", str(tmp_path / "human"), "--limit", "1")
    assert run_result.code == 0, run_result.err
    assert "Enter four numbers from 0 to 100" in run_result.out
    (call,) = read_trace(tmp_path / "human" / "scope1-analytic-yard-counting-001").calls
    assert call.outcome.result is not None and call.outcome.result["found"] is True


def test_unknown_splits_and_categories_are_reported(scope: Scope, tasks: Path) -> None:
    assert "There is no split or task file 'little'" in scope("bench", "human", "--split", "little").err
    assert "no category 'sums'" in scope("bench", "human", "--split", str(tasks), "--category", "sums").err


@pytest.mark.parametrize(
    ("line", "name", "arguments"),
    [
        ("pan 20 tilt -5 zoom 2", "adjust_ptz", {"pan_deg": 20.0, "tilt_deg": -5.0, "zoom_factor": 2.0}),
        ("zoom out", "adjust_ptz", {"zoom_limit": "out"}),
        ("PAN -7.5°", "adjust_ptz", {"pan_deg": -7.5}),
        ("preset north-gate", "go_to_preset", {"name": "north-gate"}),
        ("home", "go_home", {}),
        ("presets", "get_presets", {}),
        ("picture", "take_image", {}),
        ("count all red cars", "count_objects", {"description": "red cars", "view": "full"}),
        ("ask what does the sign say?", "query_answer", {"question": "what does the sign say?", "view": "current"}),
        ("zoomto the white van", "zoom_to_object", {"description": "the white van"}),
        ("track the white van 15", "track_object", {"description": "the white van", "duration_s": 15.0}),
        ('call adjust_ptz {"zoom_percent": 50}', "adjust_ptz", {"zoom_percent": 50}),
    ],
)
def test_every_tool_can_be_typed(line: str, name: str, arguments: dict[str, object]) -> None:
    decision = parse(line)
    assert isinstance(decision, ToolCall)
    assert (decision.name, decision.arguments) == (name, arguments)


def test_finishing_can_be_typed() -> None:
    assert parse("refuse I may not.") == Finish(kind="refused", text="I may not.")
    assert parse("question Which one?") == Finish(kind="clarification", text="Which one?")
    assert parse("help") is None
    with pytest.raises(TaskLeftError) as excinfo:
        parse("quit")
    assert excinfo.value.ends_session


@pytest.mark.parametrize(
    "line", ["answer", "pan", "pan x", "pan 3 roll 4", "fly", "home now", "call x 3", "call x {", "count", "track van"]
)
def test_unknown_commands_are_reported(line: str) -> None:
    with pytest.raises(InputError):
        parse(line)


def test_terminals_that_support_pictures_get_them(tmp_path: Path) -> None:
    image = np.full((72, 128, 3), 90, np.uint8)
    frame = Frame(image=image, pose=Pose(), hfov_deg=60.0, time_s=0.0, projection=Perspective(0, 0, 60.0, 128, 72))
    iterm, kitty = inline_sequence(frame, "iterm"), inline_sequence(frame, "kitty")
    assert iterm.startswith("\x1b]1337;File=inline=1") and iterm.endswith("\x07\n")
    assert kitty.startswith("\x1b_Gf=100,a=T,m=0;") and kitty.endswith("\x1b\\\n")
    terminal = io.StringIO()
    viewer = Viewer(tmp_path, terminal, "kitty")
    plain, gridded = viewer.show(frame), viewer.show(frame, grid=True)
    assert terminal.getvalue().count("\x1b_G") >= 2
    first, second = (np.asarray(cv2.imread(str(path))) for path in (plain, gridded))
    assert first.shape == second.shape == image.shape
    assert first.std() < 3 < second.std()
