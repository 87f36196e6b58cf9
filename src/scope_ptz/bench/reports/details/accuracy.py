"""The accuracy section: accuracy by category as in the paper's table, bounds, and a comparison of the judge with the checks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.choice.ties import ROUNDING, Leaders
from scope_ptz.bench.reports.report_judge import select_judge, trials_judged_by
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun, macro, runs_of_main_set, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, cell_value
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate, proportion

KIND_TITLES = {
    "models": "models",
    "reference": "reference",
    "blind": "blind baseline",
    "person": "person",
}
INTERVALS_NOTE = (
    "Each value has a 95% interval, clustered by viewpoint (linearised variance by cluster, Student's t with one degree of freedom "
    "fewer than there are viewpoints, Wilson's form at the effective sample size). Repeats of a task count as one observation. "
    "With only one viewpoint the interval is unknown. “Without” lists categories with only one viewpoint. They are included in "
    "the macro average but do not widen its interval, which is therefore too narrow."
)
MARKS_NOTE = (
    "Bold: the highest value with this perception model. Underlined: the highest value on these tasks. Equal values are marked "
    "alike, and values that are all equal have no mark. A mark does not mean that the value differs from the others: macro "
    "averages that the paired comparisons do not distinguish from the highest have a note, and values by category are not tested."
)


def accuracy_section(runs: Sequence[ReportRun], best: Leaders | None = None) -> Section:
    """Return the section on the accuracy of all runs with core tasks. Model pairs and other runs have separate tables.

    Args:
        runs: The runs in the report.
        best: The model pairs with the highest macro accuracy on the main task set, and the pairs not distinguishable from them.
    """
    scored_runs = [run for run in runs if run.scored_trials]
    ranked, others = [r for r in scored_runs if r.ranked], [r for r in scored_runs if not r.ranked]
    tables = [category_table("accuracy", "Accuracy by category (%): model pairs", ranked, mark_best=True, best=best)]
    if others:
        tables.append(category_table("accuracy_not_ranked", "Accuracy by category (%): not ranked", others, mark_best=False))
    tables.append(_outcome_table(scored_runs))
    if any(t.judgements for run in scored_runs for t in run.scored_trials):
        tables.append(_judge_table(scored_runs))
    text = [
        "The macro average is the unweighted mean over categories; the paper calls it the average. The micro average is the share "
        "of all trials; a trial is one run of one task. Both count correct trials among those without an infrastructure failure. "
        "An unscored trial does not count as correct. Trials that only a judge can score are left out until a judge has given a "
        "verdict."
    ]
    if len({(run.task_set, run.tasks) for run in scored_runs}) > 1:
        text.append(
            "Not all runs cover the same tasks. The best values are marked among runs on exactly the same tasks. The chart shows "
            "the main task set."
            + (
                " Runs on a different selection of its tasks have hollow markers and are below the others. Their labels state "
                "the number of shared tasks."
                if any(run.task_difference for run in scored_runs)
                else ""
            )
        )
    if others:
        text.append(
            "The grammar planner and ground-truth perception are not models. Ground-truth perception is exact about what is "
            "visible, except in its noisy variant. Both understand a limited language and may misunderstand an instruction or a "
            "question. Runs with either of them, blind baselines and human baselines are in a separate table and are not ranked."
        )
    main = runs_of_main_set(runs)
    charts = (drawing.accuracy_chart(main),) if main else ()
    return Section("accuracy", "Accuracy", tuple(text), charts, tuple(tables))


def category_table(key: str, title: str, runs: Sequence[ReportRun], *, mark_best: bool, best: Leaders | None = None) -> ReportTable:
    """Return a table with one row per run, grouped by perception model.

    With ``mark_best``, the highest value for each perception model is bold, and the highest value on the same tasks is underlined.
    Values that are all equal have no marks. Macro averages that are not distinguishable from the highest have a note.
    """
    columns = [Column("run", "Run"), Column("macro", "Macro average", "share"), Column("micro", "Micro average", "share")]
    columns += [Column(name, words, "share") for name, words in CATEGORY_TITLES.items()]
    columns.append(Column("tasks", "Tasks", "count"))
    values_by_run = [(run, [run.macro, run.micro, *(_category_share(run, name) for name in CATEGORY_TITLES)]) for run in runs]
    rows, groups = [], {}
    previous = None
    for number, (run, values) in enumerate(values_by_run):
        group = f"{run.perception_name} ({' '.join(run.task_set)})"
        if group != previous:
            groups[number], previous = group, group
        cells = [_mark_best(value, index, run, values_by_run) if mark_best else value for index, value in enumerate(values)]
        cells[0] = _note_partial_macro(cells[0], run)
        if best is not None and run in best.close:
            cells[0] = _add_note(cells[0], "not distinguishable from the highest")
        rows.append((run.label, *cells, len(run.tasks)))
    notes = (INTERVALS_NOTE, MARKS_NOTE)
    return ReportTable(key, title, tuple(columns), tuple(rows), notes if mark_best else (INTERVALS_NOTE,), groups)


def _category_share(run: ReportRun, name: str) -> IntervalEstimate | None:
    return proportion(scores_of([t for t in run.scored_trials if t.task.category == name]))


def _mark_best(
    value: IntervalEstimate | None,
    index: int,
    run: ReportRun,
    values_by_run: Sequence[tuple[ReportRun, list[IntervalEstimate | None]]],
) -> CellValue:
    if value is None:
        return None
    same_tasks = [(r, v[index]) for r, v in values_by_run if r.task_set == run.task_set and r.tasks == run.tasks]
    same_perception = [v.value for r, v in same_tasks if v and r.perception_name == run.perception_name]
    all_values = [v.value for _, v in same_tasks if v]
    return MarkedCell(value, _is_best(value.value, same_perception), _is_best(value.value, all_values))


def _is_best(value: float, values: Sequence[float]) -> bool:
    """Return whether a value is the maximum of values that are not all equal."""
    return max(values) - min(values) > ROUNDING and value > max(values) - ROUNDING


def _note_partial_macro(value: CellValue, run: ReportRun) -> CellValue:
    """Add a note to a macro average that does not cover all categories."""
    number = len({t.task.category for t in run.scored_trials})
    if number == len(CATEGORY_TITLES):
        return value
    return _add_note(value, f"over {number} of {len(CATEGORY_TITLES)} categories")


def _add_note(value: CellValue, note: str) -> MarkedCell:
    marks = value if isinstance(value, MarkedCell) else MarkedCell(cell_value(value))
    return replace(marks, note="; ".join(filter(None, (marks.note, note))))


def _outcome_table(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("run", "Run"), Column("trials", "Trials", "count"), Column("correct", "Correct", "count"),
        Column("incorrect", "Incorrect", "count"), Column("unscored", "Unscored", "count"),
        Column("infrastructure", "Infrastructure", "count"), Column("share", "Correct (%)", "share"),
        Column("at_least", "At least (%)", "share"), Column("at_most", "At most (%)", "share"),
    )  # fmt: skip
    notes = (
        "Unscored: no check failed, but the answer could not be parsed. Infrastructure: a server or the camera failed, so "
        "the trial cannot be used to score the agent. At least and at most: the fraction of correct trials if all unscored and "
        "infrastructure trials were incorrect, or if all of them were correct.",
    )
    return ReportTable("outcomes", "Outcomes of the trials, with bounds", columns, tuple(_outcome_row(run) for run in runs), notes)


def _outcome_row(run: ReportRun) -> tuple[CellValue, ...]:
    counts = Counter(t.headline for t in run.main_trials)
    total = len(run.main_trials)
    scored = len(run.scored_trials)
    return (
        run.label, total, counts["correct"], counts["incorrect"], counts["unscored"], counts["infrastructure"],
        counts["correct"] / scored if scored else None, counts["correct"] / total, 1 - counts["incorrect"] / total,
    )  # fmt: skip


def _judge_table(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("run", "Run"), Column("judge", "Judge"), Column("judged", "Judged", "count"),
        Column("unparseable", "Unparseable", "count"), Column("failed", "Judge failed", "count"),
        Column("macro_judge", "Macro by judge (%)", "share"), Column("macro_checks", "Macro by checks (%)", "share"),
        Column("agreement", "Same verdict (%)", "share"),
    )  # fmt: skip
    notes = (
        "The paper reports accuracy by a judge. Both macro averages cover the trials with a verdict of the judge, without "
        "unparseable and failed judgements. Trials that only a judge can score are excluded from the macro average by checks and "
        "from the fraction of same verdicts.",
    )
    return ReportTable("judge", "Verdicts of the judge and of the checks", columns, tuple(_judge_row(run) for run in runs), notes)


def _judge_row(run: ReportRun) -> tuple[CellValue, ...]:
    name = select_judge([run])
    if name is None:
        return run.label, None, 0, 0, 0, None, None, None
    judged = trials_judged_by(run.scored_trials, name)
    counts = Counter(judgement.verdict for _, judgement in judged)
    decided = [(t, j.verdict == "correct") for t, j in judged if j.verdict in ("correct", "incorrect")]
    trials = [t for t, _ in decided]
    checked = [t for t in trials if t.scored_by == "checks"]
    both = [(t, correct) for t, correct in decided if t.scored_by == "checks" and t.headline != "unscored"]
    agreement = sum((t.headline == "correct") == correct for t, correct in both) / len(both) if both else None
    by_judge = macro(scores_of(trials, [correct for _, correct in decided]))
    return run.label, name, len(judged), counts["unparseable"], counts["failed"], by_judge, macro(scores_of(checked)), agreement


def fraction_correct(trials: Sequence[Trial]) -> float | None:
    """Return the fraction of correct trials; None if there are no trials."""
    return sum(t.headline == "correct" for t in trials) / len(trials) if trials else None
