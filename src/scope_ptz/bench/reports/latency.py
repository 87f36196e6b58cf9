"""Where the time goes: by stage, by planner, by eyes, and at the current view against the panorama."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean

import numpy as np

from scope_ptz.bench.reports import drawing
from scope_ptz.bench.reports.runs import Run, primary, timed
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import Column, Table, Value
from scope_ptz.bench.trials import Trial

STAGES = ("planner_s", "perception_s", "camera_s", "render_s", "total_s")
STAGE_TITLES = {
    "planner_s": "Planner",
    "perception_s": "Perception",
    "camera_s": "Camera",
    "render_s": "Rendering",
    "total_s": "Whole trial",
}


def stage_seconds(run: Run, stage: str) -> list[float]:
    """Wall seconds of a stage by trial: of trials that were timed, and that used the stage at all."""
    seconds = [float(getattr(t.timings, stage)) for t in run.scored if t.timings.total_s > 0]
    return [value for value in seconds if value > 0]


def middle(seconds: Sequence[float]) -> float | None:
    """The median."""
    return float(np.median(seconds)) if seconds else None


def tail(seconds: Sequence[float]) -> float | None:
    """The 95th percentile, linearly interpolated."""
    return float(np.quantile(seconds, 0.95)) if seconds else None


def calls_made(trials: Sequence[Trial]) -> float | None:
    """Mean number of tool calls, failed ones included."""
    return fmean(sum(t.tool_calls.values()) for t in trials) if trials else None


def latency_section(runs: Sequence[Run]) -> Section:
    """All runs; the tables by model are of ranked ones only."""
    having = [run for run in runs if run.scored]
    sources = list(dict.fromkeys(timed(run, having) for run in primary([r for r in having if r.ranked])))
    tables = (
        _by_stage(having),
        _by_model("latency_planner", "By planner", sources, lambda r: r.evaluation.card.planner.name, "planner_s", _per_step),
        _by_model("latency_eyes", "By eyes", sources, lambda r: r.evaluation.card.perception.name, "perception_s", _per_look),
        _views(sources),
    )
    shared = [run.label for run in sources if run.evaluation.card.contended]
    text = [
        "Wall seconds. What goes on at the same time counts once. A stage's figures are of the trials that used it. Where a "
        "pair was also "
        "run without contention, its latency is taken from that run."
    ]
    if shared:
        text.append(
            f"Marked “contended”: {len(shared)} of {len(sources)} model pairs were timed only while other runs used the same "
            "machine or "
            "servers, so that their latency is not their own."
        )
    charts = (drawing.time_chart(having, STAGE_TITLES),) if any(stage_seconds(r, "total_s") for r in having) else ()
    return Section("latency", "Latency and tool calls", tuple(text), charts, tables)


def _contended(runs: Sequence[Run]) -> str:
    states = {run.evaluation.card.contended for run in runs}
    return "some contended" if len(states) > 1 else "contended" if states == {True} else "alone"


def _alone(runs: Sequence[Run]) -> Sequence[Run]:
    """The runs without contention, if there are any; else all."""
    return [run for run in runs if not run.evaluation.card.contended] or runs


def _by_stage(runs: Sequence[Run]) -> Table:
    columns = [Column("run", "Run"), Column("contended", "Measured"), Column("timed", "Timed trials", "count")]
    for stage, words in STAGE_TITLES.items():
        columns += [
            Column(f"{stage}_median", f"{words}, median (s)", "seconds"),
            Column(f"{stage}_p95", f"{words}, p95 (s)", "seconds"),
        ]
    columns += [
        Column("first_token_s_median", "Before first tokens, median (s)", "seconds"),
        Column("calls", "Tool calls, mean", "number"),
    ]
    rows = []
    for run in runs:
        cells: list[Value] = [run.label, _contended([run]), len(stage_seconds(run, "total_s"))]
        for stage in STAGES:
            seconds = stage_seconds(run, stage)
            cells += [middle(seconds), tail(seconds)]
        rows.append((*cells, middle(stage_seconds(run, "first_token_s")), calls_made(run.scored)))
    return Table("latency_stages", "By stage", tuple(columns), tuple(rows))


def _per_step(trial: Trial) -> list[float]:
    return [trial.timings.planner_s / trial.steps] if trial.steps and trial.timings.planner_s > 0 else []


def _per_look(trial: Trial) -> list[float]:
    return [seconds for looks in trial.look_s.values() for seconds in looks]


def _by_model(
    key: str, title: str, runs: Sequence[Run], name: Callable[[Run], str], stage: str, each: Callable[[Trial], list[float]]
) -> Table:
    unit = "step" if stage == "planner_s" else "look"
    columns = (
        Column("model", "Model"),
        Column("contended", "Measured"),
        Column("pairs", "Pairs", "count"),
        Column("trial_median", "Seconds a trial, median", "seconds"),
        Column("trial_p95", "Seconds a trial, p95", "seconds"),
        Column(f"{unit}_median", f"Seconds a {unit}, median", "seconds"),
        Column(f"{unit}_p95", f"Seconds a {unit}, p95", "seconds"),
        Column("calls", "Tool calls, mean", "number"),
    )
    rows = []
    for model in dict.fromkeys(name(run) for run in runs):
        own = _alone([run for run in runs if name(run) == model])
        seconds = [s for run in own for s in stage_seconds(run, stage)]
        single = [s for run in own for trial in run.scored for s in each(trial)]
        calls = calls_made([t for run in own for t in run.scored])
        rows.append((model, _contended(own), len(own), middle(seconds), tail(seconds), middle(single), tail(single), calls))
    notes = (
        f"Trials of all model pairs with this {'planner' if unit == 'step' else 'vision model'}, pooled; only those without "
        "contention where there are any. Reference runs are left out.",
    )
    return Table(key, title, columns, tuple(rows), notes)


def _views(runs: Sequence[Run]) -> Table:
    """What the sweep costs, by eyes and over all of them."""
    columns = (
        Column("model", "Eyes"),
        Column("contended", "Measured"),
        Column("current_looks", "Looks, current view", "count"),
        Column("current_median", "Current, median (s)", "seconds"),
        Column("current_p95", "Current, p95 (s)", "seconds"),
        Column("full_looks", "Looks, panorama", "count"),
        Column("full_median", "Panorama, median (s)", "seconds"),
        Column("full_p95", "Panorama, p95 (s)", "seconds"),
        Column("ratio", "Panorama to current", "ratio"),
    )
    names = list(dict.fromkeys(run.evaluation.card.perception.name for run in runs))
    groups = [(name, _alone([r for r in runs if r.evaluation.card.perception.name == name])) for name in names]
    if len(groups) > 1:
        groups.append(("all eyes", [run for _, own in groups for run in own]))
    return Table("latency_views", "Current view against panorama", columns, tuple(_view_row(*group) for group in groups))


def _view_row(name: str, runs: Sequence[Run]) -> tuple[Value, ...]:
    current = [s for run in runs for t in run.scored for s in t.look_s.get("current", ())]
    full = [s for run in runs for t in run.scored for s in t.look_s.get("full", ())]
    one, other = middle(current), middle(full)
    ratio = other / one if one and other else None
    return name, _contended(runs), len(current), one, tail(current), len(full), other, tail(full), ratio
