"""The sections on failed trials: error modes according to the rules and the judge, and accuracy if perception never failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.paired_comparison import PairedComparison, compare
from scope_ptz.bench.reports.report_judge import select_judge, trials_judged_by
from scope_ptz.bench.reports.report_runs import ReportRun, macro, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, cell_value
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement, Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate

MODE_TITLES = {
    ErrorMode.VLM_QUERY: "VLM query", ErrorMode.VLM_COUNTING: "VLM counting", ErrorMode.REASONING: "Reasoning",
    ErrorMode.HALLUCINATION: "Hallucination", ErrorMode.LACK_OF_TOOL_CALL: "Lack of tool call", ErrorMode.TOOL_ARGS: "Tool args",
    ErrorMode.SCOPE: "Scope", ErrorMode.TOOL_ROUTING: "Tool routing",
}  # fmt: skip
"""Titles of the error modes, in the order used in the paper's table."""
RULES_TITLE = "Incorrect trials by error mode, by the rules"
PERCEPTION_MODES = frozenset({ErrorMode.VLM_QUERY, ErrorMode.VLM_COUNTING})
"""The error modes that are perception errors."""


def modes_by_rules(run: ReportRun) -> Counter[ErrorMode]:
    """Count incorrect trials by the error mode that the rules assigned. Unscored and judge-scored trials have no such mode."""
    return Counter(t.error_mode for t in run.checked_trials if t.error_mode is not None)


def modes_by_judge(run: ReportRun, judge: str) -> Counter[ErrorMode]:
    """Count the trials that a judge considered incorrect, by the error mode that the judge assigned."""
    judged = [j for _, j in trials_judged_by(run.scored_trials, judge) if j.verdict == "incorrect"]
    return Counter(j.error_mode for j in judged if j.error_mode is not None)


def error_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the error modes of runs on the main task set."""
    checked = [run for run in runs if run.checked_trials]
    rules_modes = {run.label: modes_by_rules(run) for run in checked}
    tables = [_mode_table("error_modes", RULES_TITLE, rules_modes)]
    totals = {run.label: len(run.checked_trials) for run in checked}
    charts = [drawing.mode_chart("error_modes", RULES_TITLE, checked, rules_modes, totals, MODE_TITLES, runs)] if checked else []
    judge = select_judge(runs)
    if judge is not None:
        judge_modes = {run.label: modes_by_judge(run, judge) for run in runs if trials_judged_by(run.scored_trials, judge)}
        judged = [run for run in runs if run.label in judge_modes]
        title = f"Incorrect trials by error mode, by the judge ({judge})"
        tables.append(_mode_table("error_modes_judge", title, judge_modes))
        charts.append(
            drawing.mode_chart(
                "error_modes_judge",
                title,
                judged,
                judge_modes,
                {run.label: len(_trials_with_verdict(run, judge)) for run in judged},
                MODE_TITLES,
                runs,
            )
        )
    text = (
        "Rules in a published order assign exactly one error mode to every incorrect trial. The judge assigns an error mode to "
        "each trial that it finds incorrect. Unscored trials, whose answers could not be parsed, are not correct but have no "
        "error mode." + ("" if judge else " No judge was used, so there are no error modes by a judge."),
    )
    return Section("errors", "Error modes", text, tuple(charts), tuple(tables))


def _mode_table(key: str, title: str, counts_by_run: Mapping[str, Counter[ErrorMode]]) -> ReportTable:
    columns = [Column("run", "Run"), *(Column(mode.value, words, "count") for mode, words in MODE_TITLES.items())]
    columns += [Column("failed", "All incorrect", "count"), Column("perception", "VLM query and counting (%)", "share")]
    rows = tuple(
        (
            label,
            *(counts[mode] for mode in MODE_TITLES),
            counts.total(),
            _perception_share(counts),
        )
        for label, counts in counts_by_run.items()
    )
    return ReportTable(key, title, tuple(columns), rows)


def oracle_section(ranked: Sequence[ReportRun], all_runs: Sequence[ReportRun]) -> Section:
    """Return the section on the oracle setting: accuracy if perception never failed.

    Args:
        ranked: The runs of model pairs on the same tasks.
        all_runs: All runs in the report, including those with ground-truth perception.
    """
    judge = select_judge(ranked)
    columns = (
        Column("run", "Run"), Column("macro_judge", "Macro by judge (%)", "share"),
        Column("oracle_judge", "VLM errors (by judge) counted as correct (%)", "share"),
        Column("perception_judge", "VLM share of errors, judge (%)", "share"),
        Column("macro_checks", "Macro by checks (%)", "share"),
        Column("oracle_rules", "VLM errors (by rules) counted as correct (%)", "share"),
        Column("perception_rules", "VLM share of errors, rules (%)", "share"),
        Column("macro_rerun", "Rerun with ground-truth perception (%)", "share"),
        Column("gain_rerun", "Gain, paired (points)", "points"),
    )  # fmt: skip
    text = (
        "This section estimates in three ways how accurate the pairs would be if perception never failed. As in the paper, "
        "failures that the judge attributes to VLM counting or VLM query are counted as correct. The same is done with the error "
        "modes of the rules. If the report includes a log of the planner with ground-truth perception, this rerun is compared "
        "with the pair on the tasks of both runs. Counting failures as correct cannot show whether the planner would have "
        "continued correctly; a rerun can.",
        "Estimates by the judge are compared with the judge's verdicts. Estimates by the rules and reruns are compared with the "
        "verdicts of the checks.",
    )
    names = [column.name for column in columns]
    rows = [_oracle_row(run, _rules_oracle(run), _judge_oracle(run, judge), _rerun(run, all_runs)) for run in ranked]
    table = ReportTable("oracle", "The oracle setting", columns, tuple(rows))
    charts = (drawing.oracle_chart(table),) if rows else ()
    if len(rows) > 1:
        table = replace(table, rows=(*rows, *_means(names, rows)), notes=(MEANS_NOTE,))
    return Section("oracle", "If perception never failed", text, charts, (table,))


MEANS_NOTE = (
    "A mean covers the pairs that have both the measured value and the value with perfect perception. If these are not all pairs, "
    "their number is stated. The mean of the reruns is shown with the mean by the checks of the same pairs."
)


Oracle = tuple[IntervalEstimate | None, IntervalEstimate | None, float | None]
"""Measured macro accuracy, macro accuracy with perception errors counted as correct, and the share of perception errors."""


def _rules_oracle(run: ReportRun) -> Oracle:
    corrected = [t.headline == "correct" or t.error_mode in PERCEPTION_MODES for t in run.checked_trials]
    perception_share = _perception_share(modes_by_rules(run))
    return macro(scores_of(run.checked_trials)), macro(scores_of(run.checked_trials, corrected)), perception_share


def _judge_oracle(run: ReportRun, judge: str | None) -> Oracle:
    judged = _trials_with_verdict(run, judge)
    trials = [t for t, _ in judged]
    measured = macro(scores_of(trials, [j.verdict == "correct" for _, j in judged]))
    corrected = macro(scores_of(trials, [j.verdict == "correct" or j.error_mode in PERCEPTION_MODES for _, j in judged]))
    return measured, corrected, _perception_share(modes_by_judge(run, judge) if judge else Counter())


def _trials_with_verdict(run: ReportRun, judge: str | None) -> list[tuple[Trial, Judgement]]:
    """Return the trials on which the judge gave a verdict, together with the judgements."""
    return [(t, j) for t, j in trials_judged_by(run.scored_trials, judge or "") if j.verdict in ("correct", "incorrect")]


def _perception_share(modes: Counter[ErrorMode]) -> float | None:
    """Return the fraction of perception errors among all errors; None if there are no errors."""
    return sum(modes[mode] for mode in PERCEPTION_MODES) / modes.total() if modes else None


def _rerun(run: ReportRun, all_runs: Sequence[ReportRun]) -> tuple[ReportRun, PairedComparison | None] | None:
    """Return the rerun of a run's planner with ground-truth perception, and the comparison between the two runs.

    If there are several reruns, the one with the most shared tasks is returned.
    """
    planner, _, agent, variant = run.system
    reruns = []
    for other in all_runs:
        other_planner, _, *other_setup = other.system
        is_same_system = (other_planner, *other_setup) == (planner, agent, variant)
        shares_tasks = other.task_set == run.task_set and other.tasks & run.tasks
        is_model = not other.evaluation.card.planner.deterministic
        if is_same_system and shares_tasks and other.uses_exact_ground_truth and is_model:
            reruns.append(other)
    best = max(reruns, key=lambda other: len(other.tasks & run.tasks), default=None)
    return None if best is None else (best, compare(best, run))


def _oracle_row(
    run: ReportRun, rules: Oracle, judged: Oracle, rerun: tuple[ReportRun, PairedComparison | None] | None
) -> tuple[CellValue, ...]:
    gain = rerun[1].macro if rerun and rerun[1] else None
    return run.label, judged[0], judged[1], judged[2], rules[0], rules[1], rules[2], _shared_macro(run, rerun), gain


def _shared_macro(run: ReportRun, rerun: tuple[ReportRun, PairedComparison | None] | None) -> CellValue:
    """Return the macro accuracy of a rerun on the shared tasks, with a note if the run has other tasks too."""
    if rerun is None:
        return None
    estimate = macro(scores_of([t for t in rerun[0].scored_trials if t.task.id in run.tasks]))
    shared = len(rerun[0].tasks & run.tasks)
    return estimate if shared == len(run.tasks) else MarkedCell(estimate, note=f"on {shared} of its {len(run.tasks)} tasks")


def _means(names: Sequence[str], rows: Sequence[tuple[CellValue, ...]]) -> list[tuple[CellValue, ...]]:
    """Return rows with means over pairs. The values in a comparison cover the same pairs, and other cells are blank."""
    values = [{name: _complete_value(cell) for name, cell in zip(names, row, strict=True)} for row in rows]

    def means(title: str, *groups: tuple[str, ...]) -> tuple[CellValue, ...]:
        cells: dict[str, CellValue] = {**dict.fromkeys(names, ""), "run": title}
        for group in groups:
            complete = [row for row in values if all(row[name] is not None for name in group[:2])]
            note = f"over {len(complete)} of {len(values)} pairs" if len(complete) < len(values) else ""
            for name in group:
                numbers = [value for row in complete if (value := row[name]) is not None]
                cells[name] = MarkedCell(fmean(numbers), note=note) if numbers else None
        return tuple(cells[name] for name in names)

    by_judge, by_rules = (("macro_judge", "oracle_judge", "perception_judge"), ("macro_checks", "oracle_rules", "perception_rules"))
    mean_rows = [means("Mean of the pairs", by_judge, by_rules)]
    if any(row["macro_rerun"] is not None for row in values):
        mean_rows.append(means("Mean of the pairs run again", ("macro_checks", "macro_rerun", "gain_rerun")))
    return mean_rows


def _complete_value(cell: CellValue) -> float | None:
    """Return the value of a cell; None if a note states that it does not cover all tasks of the run."""
    value = cell_value(cell)
    if isinstance(cell, MarkedCell) and cell.note:
        return None
    return value.value if isinstance(value, IntervalEstimate) else value if isinstance(value, float) else None
