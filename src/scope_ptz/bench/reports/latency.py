"""The latency section: seconds by stage, by planner, by perception model, and by view (current view or panorama).

The camera is a separate stage. Its moves and frames cost time in the simulator and depend on the views that a pair requests. A
pair's own latency is the sum of the other stages.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.report_runs import ReportRun, pairs_of, timing_run
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.stage_times import calls_made, median, p95, stage_seconds
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.bench.scoring.trials import ObservationTime
from scope_ptz.bench.tasks.task import Scope

STAGE_TITLES = {
    "planner_s": "Planner",
    "perception_s": "Perception",
    "tools_s": "Tools and loop",
    "own_s": "All without camera",
    "capture_s": "Camera",
    "total_s": "Whole trial",
}
"""Titles of the stages by their fields in ``Timings``.

The first three add up to ``own_s``; with the camera they are the whole trial.
"""
VIEWS: tuple[tuple[Scope, str], ...] = (("current", "Current view"), ("full", "Panorama"))
STAGES_NOTE = (
    "Planner: replies of its server, retries included. Perception: answers to the tools' questions. Tools and loop: the rest of a "
    "trial without the camera, such as stitching panoramas and writing pictures. Camera: moves and frames. In the simulator this "
    "is rendering, including frames that are only kept for the log; it depends on the views that were asked for. A pair's own "
    "latency is all stages without the camera."
)
PERCEPTION_NOTE = (
    "A perception call is a call of count_objects or query_answer that returned a result. Perception: seconds without the camera. "
    "Capture: seconds of camera moves and frames, rendering included; concurrent calls share a frame."
)


def latency_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the latency of all runs. The tables by model cover only ranked runs."""
    scored = [run for run in runs if run.scored_trials]
    pairs = [(run, timing_run(run, scored)) for run in pairs_of(scored)]
    sources = [source for _, source in pairs]
    tables = (_by_stage(scored), _by_planner(pairs), _by_perception(pairs), _views(sources))
    shared = [run.label for run in sources if run.evaluation.card.contended]
    text = [
        "All values are wall-clock seconds; concurrent work counts once. The values of a stage cover the trials that used it. If a "
        "pair was also run without contention, its latency is taken from that run.",
        STAGES_NOTE,
    ]
    if shared:
        text.append(
            f"“Contended” marks {len(shared)} of {len(sources)} model pairs. They were timed only while other runs used the same "
            "machine or servers, which increases their latency."
        )
    charts = (drawing.time_chart(scored, STAGE_TITLES),) if any(stage_seconds(r, "total_s") for r in scored) else ()
    return Section("latency", "Latency and tool calls", tuple(text), charts, tables)


def _contended(runs: Sequence[ReportRun]) -> str:
    states = {run.evaluation.card.contended for run in runs}
    return "some contended" if len(states) > 1 else "contended" if states == {True} else "alone"


def _uncontended(runs: Sequence[ReportRun]) -> Sequence[ReportRun]:
    """Return the runs without contention; if there are none, all runs."""
    return [run for run in runs if not run.evaluation.card.contended] or runs


def _by_stage(runs: Sequence[ReportRun]) -> ReportTable:
    columns = [Column("run", "Run"), Column("contended", "Measured"), Column("timed", "Timed trials", "count")]
    for stage, words in STAGE_TITLES.items():
        columns += [
            Column(f"{stage}_median", f"{words}, median", "seconds"),
            Column(f"{stage}_p95", f"{words}, p95", "seconds"),
        ]
    columns += [
        Column("first_token_s_median", "Time to first token, median", "seconds"),
        Column("calls", "Tool calls, mean", "number"),
    ]
    rows = []
    for run in runs:
        cells: list[CellValue] = [run.label, _contended([run]), len(stage_seconds(run, "total_s"))]
        for stage in STAGE_TITLES:
            seconds = stage_seconds(run, stage)
            cells += [median(seconds), p95(seconds)]
        rows.append((*cells, median(stage_seconds(run, "first_token_s")), calls_made(run.scored_trials)))
    return ReportTable("latency_stages", "By stage (seconds per trial)", tuple(columns), tuple(rows))


Timed = tuple[ReportRun, ReportRun]
"""A pair's run with the most tasks, and the run from which its latency is taken. They may be the same run."""


def _by_planner(pairs: Sequence[Timed]) -> ReportTable:
    steps = (Column("step_median", "Seconds per step, median", "seconds"), Column("step_p95", "Seconds per step, p95", "seconds"))

    def cells(own: Sequence[ReportRun]) -> tuple[CellValue, ...]:
        timed_trials = [t for run in own for t in run.scored_trials if t.steps and t.timings.planner_s > 0]
        seconds = [t.timings.planner_s / t.steps for t in timed_trials]
        return median(seconds), p95(seconds)

    notes = (f"Seconds of the planner. {_pooled('planner')}",)
    return _by_model("latency_planner", "By planner", pairs, lambda r: r.planner_name, "planner_s", steps, cells, notes)


def _by_perception(pairs: Sequence[Timed]) -> ReportTable:
    looks = (
        Column("look_median", "Perception, seconds per call, median", "seconds"),
        Column("look_p95", "Perception, seconds per call, p95", "seconds"),
        Column("capture_median", "Capture, seconds per call, median", "seconds"),
        Column("capture_p95", "Capture, seconds per call, p95", "seconds"),
    )

    def cells(own: Sequence[ReportRun]) -> tuple[CellValue, ...]:
        made = _perception_calls(own)
        perception, capture = [look.eyes_s for look in made], [look.capture_s for look in made]
        return median(perception), p95(perception), median(capture), p95(capture)

    notes = (f"Seconds per trial: all perception in a trial. {PERCEPTION_NOTE} {_pooled('perception model')}",)
    return _by_model("latency_eyes", "By perception model", pairs, lambda r: r.perception_name, "perception_s", looks, cells, notes)


def _pooled(what: str) -> str:
    return (
        f"Seconds are pooled over the trials of all model pairs with this {what}. If some pairs were timed without contention, "
        f"only these count. Tool calls are the unweighted mean over all pairs with this {what}. Reference runs and variants of a "
        "pair are left out."
    )


def _by_model(
    key: str, title: str, pairs: Sequence[Timed], name: Callable[[ReportRun], str], stage: str,
    single: tuple[Column, ...], cells: Callable[[Sequence[ReportRun]], tuple[CellValue, ...]], notes: tuple[str, ...],
) -> ReportTable:  # fmt: skip
    """Return a table with one row per model. ``single`` are columns for individual steps or calls, filled by ``cells``."""
    columns = (
        Column("model", "Model"),
        Column("contended", "Measured"),
        Column("pairs", "Pairs timed", "count"),
        Column("pairs_all", "All pairs", "count"),
        Column("trial_median", "Seconds per trial, median", "seconds"),
        Column("trial_p95", "Seconds per trial, p95", "seconds"),
        *single,
        Column("calls", "Tool calls, mean over all pairs", "number"),
    )
    rows = []
    for model in dict.fromkeys(name(run) for run, _ in pairs):
        whole = [run for run, _ in pairs if name(run) == model]
        own = _uncontended([source for run, source in pairs if name(run) == model])
        seconds = [s for run in own for s in stage_seconds(run, stage)]
        calls = fmean(made for run in whole if (made := calls_made(run.scored_trials)) is not None)
        rows.append((model, _contended(own), len(own), len(whole), median(seconds), p95(seconds), *cells(own), calls))
    return ReportTable(key, title, columns, tuple(rows), notes)


def _perception_calls(runs: Sequence[ReportRun], view: Scope | None = None) -> list[ObservationTime]:
    return [look for run in runs for t in run.scored_trials for look in t.looks if view in (None, look.view)]


def _views(runs: Sequence[ReportRun]) -> ReportTable:
    """Return the seconds of perception and camera for both views, by perception model and over all of them."""
    columns = (
        Column("view", "View"),
        Column("contended", "Measured"),
        Column("looks", "Perception calls", "count"),
        Column("eyes_median", "Perception, median (s)", "seconds"),
        Column("eyes_p95", "Perception, p95 (s)", "seconds"),
        Column("ratio", "Perception, relative to the current view", "ratio"),
        Column("capture_median", "Capture, median (s)", "seconds"),
        Column("capture_p95", "Capture, p95 (s)", "seconds"),
        Column("call_median", "Whole call, median (s)", "seconds"),
    )
    names = list(dict.fromkeys(run.perception_name for run in runs))
    parts = [(name, _uncontended([r for r in runs if r.perception_name == name])) for name in names]
    if len(parts) > 1:
        parts.append(("all eyes", [run for _, own in parts for run in own]))
    rows = [_view_row(view, words, own) for _, own in parts for view, words in VIEWS]
    groups = {len(VIEWS) * number: name for number, (name, _) in enumerate(parts)}
    notes = (f"{PERCEPTION_NOTE} Whole call: both of them and the tool's own work.",)
    return ReportTable("latency_views", "Current view against panorama", columns, tuple(rows), notes, groups)


def _view_row(view: Scope, words: str, runs: Sequence[ReportRun]) -> tuple[CellValue, ...]:
    made = _perception_calls(runs, view)
    perception, capture, whole = ([getattr(look, part) for look in made] for part in ("eyes_s", "capture_s", "call_s"))
    base, own = median([look.eyes_s for look in _perception_calls(runs, "current")]), median(perception)
    ratio = own / base if base and own else None
    return words, _contended(runs), len(made), own, p95(perception), ratio, median(capture), p95(capture), median(whole)
