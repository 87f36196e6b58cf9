"""Accuracy by category as in the paper's table, with bounds, and the judge's beside the checks'."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.report_judge import judge_name, verdicts
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun, macro, of_main_set, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, unmarked
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate, share

KIND_WORDS = {
    "models": "models",
    "reference": "reference",
    "blind": "blind baseline",
    "person": "person",
}
ROUNDING = 1e-9
INTERVALS = (
    "With each share stands its 95% interval, clustered by viewpoint (linearised variance by cluster, Student's t with one degree "
    "of freedom fewer than there are viewpoints, Wilson's form at the effective sample size). Repeats of a task are one "
    "observation of it. With one viewpoint it is not known. "
    "“Without”: categories with one viewpoint, which are in the macro average but add nothing to its interval: it is too narrow."
)


def accuracy_section(runs: Sequence[ReportRun]) -> Section:
    """Accuracy of every run that has core tasks, model pairs apart from what is no model pair."""
    having = [run for run in runs if run.scored_trials]
    ranked, others = [r for r in having if r.ranked], [r for r in having if not r.ranked]
    tables = [category_table("accuracy", "Accuracy by category (%): model pairs", ranked, rank=True)]
    if others:
        tables.append(category_table("accuracy_not_ranked", "Accuracy by category (%): not ranked", others, rank=False))
    tables.append(_bounds(having))
    if any(t.judgements for run in having for t in run.scored_trials):
        tables.append(_by_judge(having))
    text = [
        "Macro is the unweighted mean over categories, which is what the paper calls average; micro is the share of all "
        "trials (a trial is "
        "one run of one task). Both count correct trials among those that infrastructure did not break; an unscored trial is "
        "not correct. Trials that only a judge can score are left out until one has given a verdict."
    ]
    if len({(run.task_set, run.tasks) for run in having}) > 1:
        text.append(
            "Not all runs did the same tasks: the best values are marked among runs of exactly the same tasks, and the chart "
            "shows the main task set."
            + (
                " Runs over other tasks of it are hollow and stand below; their labels say how many tasks they share with the rest."
                if any(run.other_tasks for run in having)
                else ""
            )
        )
    if others:
        text.append(
            "The grammar planner and ground-truth eyes are no models. Ground-truth eyes are exact about what shows, unless they "
            "are the noisy ones; both understand a language of their own only and may misunderstand a question or an "
            "instruction. Runs with either, blind baselines and people stand in a table of their own and take no part in any "
            "ranking."
        )
    main = of_main_set(runs)
    charts = (drawing.accuracy_chart(main),) if main else ()
    return Section("accuracy", "Accuracy", tuple(text), charts, tuple(tables))


def category_table(key: str, title: str, runs: Sequence[ReportRun], *, rank: bool) -> ReportTable:
    """A row a run, grouped by eyes. Best of its eyes: bold; best of its task set: underlined too."""
    columns = [Column("run", "Run"), Column("macro", "Macro average", "share"), Column("micro", "Micro average", "share")]
    columns += [Column(name, words, "share") for name, words in CATEGORY_TITLES.items()]
    columns.append(Column("tasks", "Tasks", "count"))
    raw = [(run, [run.macro, run.micro, *(_category(run, name) for name in CATEGORY_TITLES)]) for run in runs]
    rows, groups = [], {}
    previous = None
    for number, (run, values) in enumerate(raw):
        group = f"{run.perception_name} ({' '.join(run.task_set)})"
        if group != previous:
            groups[number], previous = group, group
        cells = [_marked(value, index, run, raw) if rank else value for index, value in enumerate(values)]
        cells[0] = _partial_macro(cells[0], run)
        rows.append((run.label, *cells, len(run.tasks)))
    notes = (INTERVALS, "Bold: the best with these eyes; underlined: the best of all on these tasks; only where there is another.")
    return ReportTable(key, title, tuple(columns), tuple(rows), notes if rank else (INTERVALS,), groups)


def _category(run: ReportRun, name: str) -> IntervalEstimate | None:
    return share(scores_of([t for t in run.scored_trials if t.task.category == name]))


def _marked(
    value: IntervalEstimate | None, index: int, run: ReportRun, raw: Sequence[tuple[ReportRun, list[IntervalEstimate | None]]]
) -> CellValue:
    if value is None:
        return None
    same_tasks = [(r, v[index]) for r, v in raw if r.task_set == run.task_set and r.tasks == run.tasks]
    alike = [v.value for r, v in same_tasks if v and r.perception_name == run.perception_name]
    every = [v.value for _, v in same_tasks if v]
    return MarkedCell(value, _is_best(value.value, alike), _is_best(value.value, every))


def _is_best(value: float, among: Sequence[float]) -> bool:
    """Whether none of several is better; what differs by rounding only is alike."""
    return len(among) > 1 and value > max(among) - ROUNDING


def _partial_macro(value: CellValue, run: ReportRun) -> CellValue:
    """A macro average that lacks categories says so."""
    number = len({t.task.category for t in run.scored_trials})
    if number == len(CATEGORY_TITLES):
        return value
    marks = value if isinstance(value, MarkedCell) else MarkedCell(unmarked(value))
    return replace(marks, note=f"over {number} of {len(CATEGORY_TITLES)} categories")


def _bounds(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("run", "Run"), Column("trials", "Trials", "count"), Column("correct", "Correct", "count"),
        Column("incorrect", "Incorrect", "count"), Column("unscored", "Unscored", "count"),
        Column("infrastructure", "Infrastructure", "count"), Column("share", "Correct (%)", "share"),
        Column("at_least", "At least (%)", "share"), Column("at_most", "At most (%)", "share"),
    )  # fmt: skip
    notes = (
        "Unscored: no check failed, but the answer could not be read. Infrastructure: servers or the camera failed, which "
        "says nothing "
        "about the agent. At least and at most: all of these wrong, or all of them right.",
    )
    return ReportTable("outcomes", "What came of the trials, with bounds", columns, tuple(_counted(run) for run in runs), notes)


def _counted(run: ReportRun) -> tuple[CellValue, ...]:
    found = Counter(t.headline for t in run.main_trials)
    total = len(run.main_trials)
    ran = len(run.scored_trials)
    return (
        run.label, total, found["correct"], found["incorrect"], found["unscored"], found["infrastructure"],
        found["correct"] / ran if ran else None, found["correct"] / total, 1 - found["incorrect"] / total,
    )  # fmt: skip


def _by_judge(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("run", "Run"), Column("judge", "Judge"), Column("judged", "Judged", "count"),
        Column("unparseable", "Unparseable", "count"), Column("failed", "Judge failed", "count"),
        Column("macro_judge", "Macro by judge (%)", "share"), Column("macro_checks", "Macro by checks (%)", "share"),
        Column("agreement", "Verdicts alike (%)", "share"),
    )  # fmt: skip
    notes = (
        "The paper's accuracy is the judge's. Both macros are of trials that have a verdict of the judge; unparseable and failed "
        "judgements are in neither. Trials that a judge scored, for want of a check of the answer, are not in the macro by checks "
        "and not in the agreement.",
    )
    return ReportTable("judge", "The judge's verdicts beside the checks'", columns, tuple(_judged_row(run) for run in runs), notes)


def _judged_row(run: ReportRun) -> tuple[CellValue, ...]:
    name = judge_name([run])
    if name is None:
        return run.label, None, 0, 0, 0, None, None, None
    said = verdicts(run.scored_trials, name)
    states = Counter(judgement.verdict for _, judgement in said)
    clear = [(t, j.verdict == "correct") for t, j in said if j.verdict in ("correct", "incorrect")]
    trials = [t for t, _ in clear]
    checked = [t for t in trials if t.scored_by == "checks"]
    own = [(t, right) for t, right in clear if t.scored_by == "checks" and t.headline != "unscored"]
    alike = sum((t.headline == "correct") == right for t, right in own) / len(own) if own else None
    by_judge = macro(scores_of(trials, [right for _, right in clear]))
    return run.label, name, len(said), states["unparseable"], states["failed"], by_judge, macro(scores_of(checked)), alike


def share_correct(trials: Sequence[Trial]) -> float | None:
    """Share of correct runs among those given; None without any."""
    return sum(t.headline == "correct" for t in trials) / len(trials) if trials else None
