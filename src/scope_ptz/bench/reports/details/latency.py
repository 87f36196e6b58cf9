"""The latency section: seconds by stage, planner, perception model and view (current view or panorama).

The camera is a separate stage, because the time that the simulator takes for moves and frames depends on the views that a pair
requests. A pair's own latency is the sum of the other stages.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.report_runs import ReportRun, pairs_of, timing_run
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.stage_times import mean_tool_calls, median, p95, stage_seconds
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
"""Titles of the stages, by field of ``Timings``.

``own_s`` is the sum of the first three stages, and ``total_s`` also includes the camera.
"""
VIEWS: tuple[tuple[Scope, str], ...] = (("current", "Current view"), ("full", "Panorama"))
STAGES_NOTE = (
    "Planner: replies of its server, retries included. Perception: answers to the tools' questions. Tools and loop: the rest of a "
    "trial without the camera, such as stitching panoramas and writing pictures. Camera: moves and frames. In the simulator this "
    "is the time for rendering, including frames that only the log needs. It depends on the requested views. A pair's own latency "
    "is the sum of all stages without the camera."
)
PERCEPTION_NOTE = (
    "A perception call is a call of count_objects or query_answer that returned a result. Perception: seconds without the camera. "
    "Capture: seconds of camera moves and frames, including rendering. Concurrent calls share a frame."
)


def latency_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the latency of all runs. The tables by model cover only ranked runs."""
    scored = [run for run in runs if run.scored_trials]
    pairs = [(run, timing_run(run, scored)) for run in pairs_of(scored)]
    sources = [source for _, source in pairs]
    tables: tuple[ReportTable, ...] = (_stage_table(scored), _planner_table(pairs), _perception_table(pairs), _view_table(sources))
    tables += (
        (_hybrid_table(hybrid),) if (hybrid := [run for run in scored if any(t.planned_by for t in run.scored_trials)]) else ()
    )
    contended = [run.label for run in sources if run.evaluation.card.contended]
    text = [
        "All values are seconds of wall-clock time; concurrent work counts once. The values of a stage cover the trials that used "
        "it. If a pair was also run without contention, its latency is taken from that run.",
        STAGES_NOTE,
    ]
    if contended:
        text.append(
            f"“Contended” marks {len(contended)} of {len(sources)} model pairs. They were timed only while other runs used the "
            "same machine or servers, so their latencies are too high."
        )
    charts = (drawing.time_chart(scored, STAGE_TITLES),) if any(stage_seconds(r, "total_s") for r in scored) else ()
    return Section("latency", "Latency and tool calls", tuple(text), charts, tables)


def _contention_text(runs: Sequence[ReportRun]) -> str:
    states = {run.evaluation.card.contended for run in runs}
    return "some contended" if len(states) > 1 else "contended" if states == {True} else "alone"


def _runs_without_contention(runs: Sequence[ReportRun]) -> Sequence[ReportRun]:
    """Return the runs without contention or, if there are none, all runs."""
    return [run for run in runs if not run.evaluation.card.contended] or runs


def _stage_table(runs: Sequence[ReportRun]) -> ReportTable:
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
        cells: list[CellValue] = [run.label, _contention_text([run]), len(stage_seconds(run, "total_s"))]
        for stage in STAGE_TITLES:
            seconds = stage_seconds(run, stage)
            cells += [median(seconds), p95(seconds)]
        rows.append((*cells, median(stage_seconds(run, "first_token_s")), mean_tool_calls(run.scored_trials)))
    return ReportTable("latency_stages", "By stage (seconds per trial)", tuple(columns), tuple(rows))


def _hybrid_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with the number and duration of the steps by each part of a hybrid planner."""
    columns = (
        Column("run", "Run"),
        Column("grammar_steps", "Steps by the grammar", "count"),
        Column("model_steps", "Steps by the model", "count"),
        Column("without_model", "Trials without the model", "share"),
        Column("grammar_step_median", "Seconds per step without the model, median", "seconds"),
        Column("model_step_median", "Seconds per step with the model, median", "seconds"),
    )
    rows = []
    for run in runs:
        trials = [trial for trial in run.scored_trials if trial.planned_by]
        with_model = [trial for trial in trials if trial.planned_by.get("model")]
        without = [trial for trial in trials if not trial.planned_by.get("model")]
        steps = [sum(trial.planned_by.get(part, 0) for trial in trials) for part in ("grammar", "model")]
        seconds = [median([t.timings.planner_s / t.steps for t in group if t.steps]) for group in (without, with_model)]
        rows.append((run.label, *steps, len(without) / len(trials), *seconds))
    notes = ("The grammar plans the instructions that it understands; the model plans only the others.",)
    return ReportTable("latency_hybrid", "Hybrid planners", columns, tuple(rows), notes)


TimedPair = tuple[ReportRun, ReportRun]
"""A pair's run with the most scored trials, and the run from which its latency is taken. They may be the same."""


def _planner_table(pairs: Sequence[TimedPair]) -> ReportTable:
    steps = (Column("step_median", "Seconds per step, median", "seconds"), Column("step_p95", "Seconds per step, p95", "seconds"))

    def cells(runs: Sequence[ReportRun]) -> tuple[CellValue, ...]:
        timed_trials = [t for run in runs for t in run.scored_trials if t.steps and t.timings.planner_s > 0]
        seconds = [t.timings.planner_s / t.steps for t in timed_trials]
        return median(seconds), p95(seconds)

    notes = (f"Seconds of the planner. {_pooling_note('planner')}",)
    return _model_table("latency_planner", "By planner", pairs, lambda r: r.planner_name, "planner_s", steps, cells, notes)


def _perception_table(pairs: Sequence[TimedPair]) -> ReportTable:
    call_columns = (
        Column("look_median", "Perception, seconds per call, median", "seconds"),
        Column("look_p95", "Perception, seconds per call, p95", "seconds"),
        Column("capture_median", "Capture, seconds per call, median", "seconds"),
        Column("capture_p95", "Capture, seconds per call, p95", "seconds"),
    )

    def cells(runs: Sequence[ReportRun]) -> tuple[CellValue, ...]:
        calls = _perception_calls(runs)
        perception, capture = [call.eyes_s for call in calls], [call.capture_s for call in calls]
        return median(perception), p95(perception), median(capture), p95(capture)

    notes = (f"Seconds per trial: all perception in a trial. {PERCEPTION_NOTE} {_pooling_note('perception model')}",)
    return _model_table(
        "latency_eyes", "By perception model", pairs, lambda r: r.perception_name, "perception_s", call_columns, cells, notes
    )


def _pooling_note(role: str) -> str:
    return (
        f"Seconds are pooled over the trials of all model pairs with this {role}. If some pairs were timed without contention, "
        f"only these are used. Tool calls are the unweighted mean over all pairs with this {role}. Reference runs and variants of "
        "a pair are left out."
    )


def _model_table(
    key: str, title: str, pairs: Sequence[TimedPair], name: Callable[[ReportRun], str], stage: str,
    detail_columns: tuple[Column, ...], cells: Callable[[Sequence[ReportRun]], tuple[CellValue, ...]], notes: tuple[str, ...],
) -> ReportTable:  # fmt: skip
    """Return a table with one row per model.

    Args:
        key: Key of the table.
        title: Title of the table.
        pairs: The runs of the model pairs, with the runs from which their latencies are taken.
        name: Function that returns the name of the model in a run.
        stage: The stage to which the model belongs.
        detail_columns: The columns for individual steps or calls.
        cells: Function that returns the cells in these columns.
        notes: The notes below the table.
    """
    columns = (
        Column("model", "Model"),
        Column("contended", "Measured"),
        Column("pairs", "Pairs timed", "count"),
        Column("pairs_all", "All pairs", "count"),
        Column("trial_median", "Seconds per trial, median", "seconds"),
        Column("trial_p95", "Seconds per trial, p95", "seconds"),
        *detail_columns,
        Column("calls", "Tool calls, mean over all pairs", "number"),
    )
    rows = []
    for model in dict.fromkeys(name(run) for run, _ in pairs):
        all_runs = [run for run, _ in pairs if name(run) == model]
        timed = _runs_without_contention([source for run, source in pairs if name(run) == model])
        seconds = [s for run in timed for s in stage_seconds(run, stage)]
        calls = fmean(count for run in all_runs if (count := mean_tool_calls(run.scored_trials)) is not None)
        rows.append(
            (model, _contention_text(timed), len(timed), len(all_runs), median(seconds), p95(seconds), *cells(timed), calls)
        )
    return ReportTable(key, title, columns, tuple(rows), notes)


def _perception_calls(runs: Sequence[ReportRun], view: Scope | None = None) -> list[ObservationTime]:
    return [call for run in runs for t in run.scored_trials for call in t.looks if view in (None, call.view)]


def _view_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table with the seconds for perception and camera by view, for each perception model and for all models."""
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
    parts = [(name, _runs_without_contention([r for r in runs if r.perception_name == name])) for name in names]
    if len(parts) > 1:
        parts.append(("all eyes", [run for _, timed in parts for run in timed]))
    rows = [_view_row(view, title, timed) for _, timed in parts for view, title in VIEWS]
    groups = {len(VIEWS) * number: name for number, (name, _) in enumerate(parts)}
    notes = (f"{PERCEPTION_NOTE} Whole call: perception, capture and the tool's own work.",)
    return ReportTable("latency_views", "Current view against panorama", columns, tuple(rows), notes, groups)


def _view_row(view: Scope, title: str, runs: Sequence[ReportRun]) -> tuple[CellValue, ...]:
    calls = _perception_calls(runs, view)
    perception, capture, whole = ([getattr(call, field) for call in calls] for field in ("eyes_s", "capture_s", "call_s"))
    baseline = median([call.eyes_s for call in _perception_calls(runs, "current")])
    typical = median(perception)
    ratio = typical / baseline if baseline and typical else None
    return title, _contention_text(runs), len(calls), typical, p95(perception), ratio, median(capture), p95(capture), median(whole)
