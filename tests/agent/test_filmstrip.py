"""Filmstrips: the text of the panels, and the drawing of runs of any length and content."""

from __future__ import annotations

from pathlib import Path

import anyio
import numpy as np
import pytest
from PIL import Image

from scope_ptz.agent.contact_sheet import contact_sheet
from scope_ptz.agent.drawing import shorten, to_printable, width_of, wrap
from scope_ptz.agent.filmstrip import WIDTH, draw_filmstrip, write_filmstrip
from scope_ptz.agent.panels import panels_of
from scope_ptz.agent.records import Budgets
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import Trace, TraceWriter, read_trace
from scope_ptz.errors import TraceError
from scope_ptz.planner.base import Finish
from tests.agent.scripted import Step, answer, calls, make_agent

PRESET = ("go_to_preset", {"name": "highway"})
MOVE = ("adjust_ptz", {"pan_deg": 15.0, "tilt_deg": -2.5})
COUNT = ("count_objects", {"description": "cones"})


def record(root: Path, *script: Step, counts: tuple[int, ...] = (3,), max_steps: int = 60) -> Trace:
    folder = RunFolder.create(root, "x")

    async def work() -> None:
        agent = make_agent(*script, counts=counts, images=folder, budgets=Budgets(max_steps=max_steps))
        with TraceWriter(folder.trace) as trace:
            await agent.run("count the cones", listener=trace)

    anyio.run(work)
    return read_trace(folder.path)


def captions(trace: Trace) -> list[tuple[int, str, str]]:
    return [(p.number, p.action, p.finding) for p in panels_of(trace)]


def test_a_move_and_the_next_perception_call_share_a_panel(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(PRESET), calls(COUNT), calls(MOVE), calls(COUNT), answer(), counts=(1, 4))
    assert captions(trace) == [(1, "go to highway", "1 cone"), (2, "pan right 15°, tilt down 2.5°", "4 cones")]
    panels = panels_of(trace)
    assert [len(p.boxes) for p in panels] == [1, 4]
    assert [p.badge for p in panels] == ["1 cone", "4 cones"]
    assert [p.pose.pan_deg for p in panels] == [20.0, 35.0]


def test_other_steps_have_their_own_panels(tmp_path: Path) -> None:
    trace = record(
        tmp_path,
        calls(("get_presets", {}), MOVE, ("query_answer", {"question": "what is that?"})),
        calls(("count_objects", {"description": "cars", "view": "full"}), ("zoom_to_object", {"description": "van"})),
        calls(("go_to_preset", {"name": "nowhere"})),
        calls(("adjust_ptz", {"pan_deg": 999.0})),
        answer(),
    )
    texts = captions(trace)
    assert texts[0] == (1, "pan right 15°, tilt down 2.5°, what is that?", "3")
    assert texts[1] == (2, "sweep, count cars", "3 cars")
    assert texts[2][1] == "zoom to van"
    assert texts[3][1:] == ("go to nowhere", "There is no preset 'nowhere'. Known: gate, highway.")
    assert texts[4][1:] == ("pan right 999°", "at the pan limit")
    panels = panels_of(trace)
    assert [p.is_panorama for p in panels] == [False, True, False, False, False]
    assert [p.failed for p in panels] == [False, False, False, True, False]
    assert panels[3].file == panels[2].file  # Nothing happened, so the earlier view is still current.


def test_a_run_without_steps_shows_the_camera_view(tmp_path: Path) -> None:
    trace = record(tmp_path, Finish(kind="clarification", text="What do you mean?"))
    assert captions(trace) == [(0, "start", "")]
    assert write_filmstrip(trace) == trace.folder / "filmstrip.png"


@pytest.mark.parametrize("steps", [1, 2, 5, 7, 13, 30])
def test_runs_of_any_length_can_be_drawn(tmp_path: Path, steps: int) -> None:
    trace = record(tmp_path, calls(COUNT, MOVE), max_steps=steps)
    image = draw_filmstrip(trace)
    assert image is not None
    assert image.width == WIDTH
    assert 300 < image.height < 2400


def test_counted_objects_are_marked(tmp_path: Path) -> None:
    plain, marked = (
        draw_filmstrip(record(tmp_path, calls(("query_answer", {"question": "x"})), answer(), counts=(1,))),
        draw_filmstrip(record(tmp_path, calls(COUNT), answer(), counts=(6,))),
    )
    assert plain is not None
    assert marked is not None
    amber = [np.all(np.abs(np.asarray(i, int) - (255, 201, 74)) < 12, axis=-1).sum() for i in (plain, marked)]
    assert amber[1] > amber[0] + 1000


def test_untrusted_text_cannot_break_the_picture(tmp_path: Path) -> None:
    untrusted = "\x1b[31m看 " + "very" * 200 + " long\n\n" + "words " * 300
    trace = record(tmp_path, calls(("query_answer", {"question": "x" * 400})), answer(untrusted))
    assert draw_filmstrip(trace) is not None


def test_a_trace_cannot_refer_to_pictures_outside_its_folder(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(MOVE), answer())
    outside = tmp_path / "secret.jpg"
    Image.new("RGB", (8, 8)).save(outside)
    path = trace.folder / "trace.jsonl"
    path.write_text(path.read_text().replace("frames/002-view.jpg", "../secret.jpg"))
    with pytest.raises(TraceError, match="outside"):
        draw_filmstrip(read_trace(trace.folder))


def test_a_missing_picture_is_reported(tmp_path: Path) -> None:
    trace = record(tmp_path, calls(MOVE), answer())
    (trace.folder / "frames/002-view.jpg").unlink()
    with pytest.raises(TraceError, match="missing"):
        draw_filmstrip(trace)


def test_drawable_text() -> None:
    assert to_printable("caf\u00e9 \u2013 15° \u00d7 2\n\tend \u770b") == "cafe - 15° x 2 end ?"
    assert width_of(shorten("a long line of words", 20, 100), 20) <= 100
    assert shorten("short", 20, 100) == "short"
    lines = wrap("one two three four five six seven eight nine ten", 20, 120, 2)
    assert len(lines) == 2
    assert lines[1].endswith("…")


def test_contact_sheets_have_rows_of_three() -> None:
    picture = Image.new("RGB", (160, 90))
    heights = [contact_sheet("title", [(str(i), picture) for i in range(n)]).height for n in (1, 3, 4)]
    assert heights[0] == heights[1] < heights[2]
