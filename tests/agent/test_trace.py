"""Traces and run folders: written data can be read back, damage is reported, and names never collide."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import anyio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from scope_ptz.agent.records import Called, Ended
from scope_ptz.agent.store import RunFolder, slug
from scope_ptz.agent.trace import TraceWriter, read_trace
from scope_ptz.errors import OutputError, TraceError
from tests.agent.scripted import ScriptedCamera, Step, answer, calls, make_agent

MOVE = ("adjust_ptz", {"pan_deg": 15.0})
COUNT = ("count_objects", {"description": "cones"})


def record_run(root: Path, *script: Step, counts: tuple[int, ...] = (2,), instruction: str = "count the cones") -> RunFolder:
    folder = RunFolder.create(root, instruction)

    async def work() -> None:
        with TraceWriter(folder.trace) as trace:
            await make_agent(*script, counts=counts, images=folder).run(instruction, listener=trace)

    anyio.run(work)
    return folder


def test_a_run_survives_writing_and_reading(tmp_path: Path) -> None:
    folder = record_run(tmp_path, calls(MOVE), calls(COUNT, ("take_image", {})), answer("Two."))
    trace = read_trace(folder.path)
    assert trace == read_trace(folder.trace)
    assert trace.started.instruction == "count the cones"
    assert (trace.started.planner, trace.started.perception) == ("scripted", "scripted-perception")
    assert trace.started.labels.perception_note
    assert [d.decision.kind for d in trace.decisions] == ["call", "call", "answered"]
    assert [c.outcome.call.name for c in trace.calls] == ["adjust_ptz", "count_objects", "take_image"]
    assert trace.ended is not None
    assert (trace.ended.outcome, trace.ended.text) == ("answered", "Two.")


def test_an_instruction_that_is_not_valid_unicode_can_be_stored(tmp_path: Path) -> None:
    folder = record_run(tmp_path, answer(), instruction="count the cones \udcff")
    assert read_trace(folder.path).started.instruction == "count the cones ?"


def test_every_picture_in_the_trace_exists(tmp_path: Path) -> None:
    folder = record_run(tmp_path, calls(MOVE), calls(COUNT, ("take_image", {})), answer())
    trace = read_trace(folder.path)
    names = [trace.started.frame, trace.calls[0].frame]
    for call in trace.calls[1:]:
        result = call.outcome.result or {}
        names += [*result.get("frames", ()), *([result["file"]] if "file" in result else [])]
    assert names == ["frames/001-view.jpg", "frames/002-view.jpg", "frames/003-view.jpg", "pictures/001.png"]
    for name in names:
        with Image.open(folder.path / str(name)) as image:
            assert image.size == (64, 36)
    with Image.open(folder.path / "pictures/001.png") as image:
        assert np.unique(np.asarray(image)).tolist() == [15]


def test_scene_time_is_recorded_with_each_call(tmp_path: Path) -> None:
    trace = read_trace(record_run(tmp_path, calls(MOVE, MOVE), calls(MOVE), answer()).path)
    assert [c.scene_time_s for c in trace.calls] == [0.0, 0.5, 1.0]


def test_the_trace_is_written_during_the_run(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path, "x")
    lines: list[int] = []

    async def work() -> None:
        with TraceWriter(folder.trace) as trace:

            def listen(record: object) -> None:
                trace(record)  # type: ignore[arg-type]
                lines.append(folder.trace.read_text().count("\n"))

            await make_agent(calls(MOVE), answer()).run("x", listener=listen)

    anyio.run(work)
    assert lines == [1, 2, 3, 4, 5]


def test_an_incomplete_last_line_is_ignored(tmp_path: Path) -> None:
    folder = record_run(tmp_path, calls(MOVE), answer())
    data = folder.trace.read_bytes()
    folder.trace.write_bytes(data[:-20])
    trace = read_trace(folder.path)
    assert trace.ended is None
    assert len(trace.calls) == 1


Change = Callable[[list[str]], list[str]]
DAMAGES: dict[str, Change] = {
    "garbage in the middle": lambda lines: [lines[0], "{...", *lines[2:]],
    "no header": lambda lines: lines[1:],
    "two headers": lambda lines: [lines[0], *lines],
    "records after the end": lambda lines: [*lines, lines[1]],
    "an unknown field": lambda lines: [lines[0][:-1] + ', "mood": 1}', *lines[1:]],
    "a newer format": lambda lines: [lines[0].replace('"format":1', '"format":2'), *lines[1:]],
    "an unknown record": lambda lines: [lines[0], '{"event":"nap"}'],
    "not an object": lambda lines: [lines[0], "[]"],
    "empty": lambda _: [],
    "binary": lambda _: [bytes(range(256)).decode("latin-1")],
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_reported(tmp_path: Path, damage: str) -> None:
    folder = record_run(tmp_path, calls(MOVE), answer())
    lines = DAMAGES[damage](folder.trace.read_text().splitlines())
    folder.trace.write_text("".join(f"{line}\n" for line in lines), encoding="latin-1")
    with pytest.raises(TraceError, match="trace"):
        read_trace(folder.path)


def test_missing_traces_are_reported(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(TraceError, match="no trace"):
            read_trace(path)


def test_folders_of_the_same_second_never_collide(tmp_path: Path) -> None:
    folders = {RunFolder.create(tmp_path / "runs", "the same words").path for _ in range(50)}
    assert len(folders) == 50
    assert all(path.is_dir() for path in folders)


def test_a_trace_never_overwrites_another(tmp_path: Path) -> None:
    folder = record_run(tmp_path, answer())
    with pytest.raises(OutputError):
        TraceWriter(folder.trace)


def test_a_folder_that_is_not_writable_is_reported(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError, match="runs-dir"):
        RunFolder.create(tmp_path / "file" / "runs", "x")


@given(st.text(max_size=200))
def test_slugs_are_safe_file_names(text: str) -> None:
    name = slug(text)
    assert name
    assert len(name) <= 40
    assert set(name) <= set("abcdefghijklmnopqrstuvwxyz0123456789-")


def test_slugs_keep_the_first_words() -> None:
    assert slug("Go to the highway preset, then pan right in 15 degree steps") == "go-to-the-highway-preset-then-pan-right"
    assert slug("../../etc/passwd") == "etc-passwd"
    assert slug("看看") == "run"


def test_pictures_never_overwrite(tmp_path: Path) -> None:
    folder = RunFolder.create(tmp_path, "x")
    frame = anyio.run(ScriptedCamera().frame)
    assert {anyio.run(folder.save_picture, frame) for _ in range(3)} == {f"pictures/00{i}.png" for i in (1, 2, 3)}
    (folder.path / "pictures" / "004.png").write_bytes(b"someone else's file")
    with pytest.raises(OutputError):
        anyio.run(folder.save_picture, frame)


def test_a_record_is_one_line_of_json(tmp_path: Path) -> None:
    folder = record_run(tmp_path, calls(("count_objects", {"description": "two\nlines"})), answer("a\nb"))
    events = [json.loads(line)["event"] for line in folder.trace.read_text().splitlines()]
    assert events == ["start", "decision", "call", "decision", "end"]
    assert isinstance(read_trace(folder.path).calls[0], Called)
    assert isinstance(read_trace(folder.path).ended, Ended)
