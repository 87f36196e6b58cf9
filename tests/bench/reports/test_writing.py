"""Report pages on disk: complete, safe for any model output, and never written to a folder with other content."""

from __future__ import annotations

import io
import re
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from scope_ptz.agent.records import Budgets, Called, Decided, RecordedPose, RunLabels, Started
from scope_ptz.agent.timing import PerceptionReply, Timings
from scope_ptz.agent.trace import Trace
from scope_ptz.bench.reports.assemble import EvaluationReport
from scope_ptz.bench.reports.task_pages import FrameStore, file_name
from scope_ptz.bench.reports.writer import render_html, render_markdown, write_report
from scope_ptz.bench.scoring.trials import CheckRecord, Evaluation, Trial
from scope_ptz.errors import OutputError, TraceError
from scope_ptz.planner.base import CallTools, Finish, ToolCall, ToolOutcome
from scope_ptz.registry import load_registry
from tests.bench.reports.sample_evaluations import card, facts, trial

HOSTILE = '<script>alert("x")</script><img src=x onerror=alert(1)>\'"--><!--'
HOSTILE_ID = "../../../etc/passwd<script>"


class Page(HTMLParser):
    """The tags and texts of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.words.append(data)

    def attributes_of(self, tag: str) -> list[dict[str, str | None]]:
        return [attrs for name, attrs in self.tags if name == tag]


def jpeg(colour: str = "red", size: tuple[int, int] = (1280, 720)) -> bytes:
    out = io.BytesIO()
    Image.new("RGB", size, colour).save(out, "JPEG")
    return out.getvalue()


class Sample:
    """A trace and pictures of a run with malicious content."""

    def __init__(self) -> None:
        pose = RecordedPose(pan_deg=1, tilt_deg=2, zoom=1)
        call = ToolCall(id="1", name="query_answer", arguments={"question": HOSTILE, "view": "current"})
        reply = PerceptionReply(kind="query", asked=HOSTILE, result={"text": f"A sign says: {HOSTILE}"}, frame_time_s=0, wall_s=0.5)
        self.trace = Trace(
            folder=Path("/nowhere"),
            started=Started(
                version="0", python="3", started=datetime.now(UTC), instruction=HOSTILE, planner="p", perception="e", camera="c",
                simulated=True, frame_width=1280, frame_height=720, scene="s", viewpoint="v", scene_time_s=0, pose=pose,
                presets=(), budgets=Budgets(), labels=RunLabels(), frame="../../start.jpg",
            ),
            decisions=(
                Decided(step=1, decision=CallTools(calls=(call,), thought=HOSTILE), planner_s=1, view="view.jpg"),
                Decided(step=2, decision=Finish(kind="answered", text=HOSTILE), planner_s=1),
            ),
            calls=(
                Called(
                    step=1, index=0, outcome=ToolOutcome(call=call, result={"message": f"It reads {HOSTILE}"}), scene_time_s=0,
                    pose=pose, timings=Timings(), replies=(reply,), frame="/etc/passwd",
                ),
            ),
            ended=None,
        )  # fmt: skip

    def picture(self, name: str) -> bytes | None:
        return {"../../start.jpg": jpeg(), "/etc/passwd": jpeg("blue"), "view.jpg": b"GIF89a<script>"}[name]


@pytest.fixture
def hostile() -> Evaluation:
    tasks = [
        t.model_copy(
            update={"id": f"{HOSTILE_ID}{n}", "instruction": HOSTILE, "expected": HOSTILE, "scene": HOSTILE, "demands": (HOSTILE,)}
        )
        for n, t in enumerate(facts(1))
    ]
    trials = tuple(
        trial(
            t,
            "incorrect",
            answer=HOSTILE,
            reason=HOSTILE,
            outcome=HOSTILE,
            sample=HOSTILE,
            checks=(CheckRecord(name=HOSTILE, passed=False, reason=HOSTILE),),
        )
        for t in tasks
    )
    return Evaluation(
        card=card(f"planner {HOSTILE}", HOSTILE, split=f"../{HOSTILE}", variant=HOSTILE, host=HOSTILE),
        trials=trials,
        wanted=len(trials),
    )


def test_text_of_models_and_logs_is_shown_and_never_executed(hostile: Evaluation, tmp_path: Path) -> None:
    out = tmp_path / "report"
    write_report([hostile, hostile], load_registry(), out, open_sample=lambda evaluation, trial: Sample())
    files = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert all(path.is_relative_to(out) for path in files)
    pages = [path for path in files if path.suffix == ".html"]
    assert len(pages) == 1 + len(hostile.trials)
    for path in pages:
        page = Page(path.read_text("utf-8"))
        names = {name for name, _ in page.tags}
        assert not names & {"script", "iframe", "object", "link", "base", "form"}
        assert not any(key.startswith("on") for _, attrs in page.tags for key in attrs)
        for image in page.attributes_of("img"):
            assert re.fullmatch(r"\.\./frames/[0-9a-f]{24}\.jpg", image["src"] or "")
            assert (path.parent / str(image["src"])).is_file()
        assert any('alert("x")' in words for words in page.words)
    text = (out / "report.md").read_text("utf-8")
    assert "<script" not in text and "<img" not in text
    task = Page(pages[0].read_text("utf-8") if pages[0].name != "index.html" else pages[1].read_text("utf-8"))
    assert len(task.attributes_of("img")) == 2 * 2, "the invalid picture is left out, and both logs are shown"
    assert len(list((out / "frames").iterdir())) == 2, "each picture is stored once"


def test_file_names_do_not_come_from_logs() -> None:
    for task in (HOSTILE_ID, "..", "", "con", "a/b\\c", "\x00", "ü" * 400, "scope1-x-counting-001"):
        assert re.fullmatch(r"[a-z0-9-]+-[0-9a-f]{10}\.html", file_name(task)) and len(file_name(task)) < 90
    assert file_name("a.b") != file_name("a-b")
    assert file_name("scope1-x-counting-001").startswith("scope1-x-counting-001-")


def test_an_unreadable_trace_is_reported(hostile: Evaluation, tmp_path: Path) -> None:
    def raise_trace_error(evaluation: Evaluation, trial: Trial) -> Sample:
        raise TraceError("The log holds no such run.")

    write_report([hostile], load_registry(), tmp_path / "r", open_sample=raise_trace_error)
    page = next((tmp_path / "r" / "tasks").iterdir()).read_text("utf-8")
    assert "The log holds no such run." in page


@pytest.mark.parametrize("content", [None, b"", b"not a picture", jpeg()[:300], b"<svg onload='x'/>"])
def test_only_pictures_become_files(content: bytes | None, tmp_path: Path) -> None:
    assert FrameStore(tmp_path / "frames", "frames").add(content) is None
    assert not (tmp_path / "frames").exists()


def test_pictures_are_reduced(tmp_path: Path) -> None:
    store = FrameStore(tmp_path / "frames", "frames")
    stored = store.add(jpeg(size=(4000, 700)))
    assert stored is not None
    with Image.open(tmp_path / stored) as picture:
        assert picture.width == 1280


def test_the_page_is_self_contained_and_accessible(report: EvaluationReport) -> None:
    text = render_html(report)
    page = Page(text)
    assert not page.attributes_of("script") and not page.attributes_of("link") and not page.attributes_of("img")
    assert not re.search(r"""(?:src|href)=["']?(?:https?:)?//""", text) and "@import" not in text
    assert [meta["content"] for meta in page.attributes_of("meta") if meta.get("http-equiv")] == [
        "default-src 'none'; style-src 'unsafe-inline'"
    ]
    ids = [attrs["id"] for _, attrs in page.tags if "id" in attrs]
    assert len(ids) == len(set(ids))
    anchors = {a["href"][1:] for a in page.attributes_of("a") if (a["href"] or "").startswith("#")}  # type: ignore[index]
    assert anchors <= set(ids)
    assert all(th.get("scope") in ("col", "row", "rowgroup") for th in page.attributes_of("th"))
    assert len(page.attributes_of("caption")) == len(page.attributes_of("table")) == len(report.tables)
    charts = [chart for section in report.sections for chart in section.charts]
    assert len(page.attributes_of("svg")) == len(charts) >= 7
    chart_divs: list[Any] = [div for div in page.attributes_of("div") if div.get("role") == "img"]
    assert [div["aria-label"] for div in chart_divs] == [chart.alt for chart in charts]
    assert "prefers-color-scheme: dark" in text and "@media print" in text and "#010203" not in text


def test_reports_are_reproducible(report: EvaluationReport) -> None:
    assert render_html(report) == render_html(report)
    assert render_markdown(report).count("## ") >= len(report.sections)


def test_only_older_reports_are_replaced(hostile: Evaluation, tmp_path: Path) -> None:
    out = tmp_path / "report"
    write_report([hostile], load_registry(), out)
    notes = out / "notes.txt"
    notes.write_text("mine")
    valid = hostile.model_copy(update={"trials": tuple(trial(t) for t in facts(1))})
    write_report([valid], load_registry(), out)
    assert notes.read_text() == "mine" and not list((out / "tasks").iterdir())
    other = tmp_path / "other"
    other.mkdir()
    (other / "index.html").write_text("somebody's page")
    with pytest.raises(OutputError, match="contains no report"):
        write_report([valid], load_registry(), other)
    with pytest.raises(OutputError, match="is a file"):
        write_report([valid], load_registry(), notes)
    assert (other / "index.html").read_text() == "somebody's page"
