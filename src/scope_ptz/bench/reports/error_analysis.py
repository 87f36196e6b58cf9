"""The sections about failed trials: error modes by the rules and by the judge, and accuracy if perception never failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.paired_comparison import PairedComparison, compare
from scope_ptz.bench.reports.report_judge import judge_name, verdicts
from scope_ptz.bench.reports.report_runs import ReportRun, macro, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, unmarked
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Judgement, Trial
from scope_ptz.bench.statistics.clustered import IntervalEstimate

MODE_TITLES = {
    ErrorMode.VLM_QUERY: "VLM query", ErrorMode.VLM_COUNTING: "VLM counting", ErrorMode.REASONING: "Reasoning",
    ErrorMode.HALLUCINATION: "Hallucination", ErrorMode.LACK_OF_TOOL_CALL: "Lack of tool call", ErrorMode.TOOL_ARGS: "Tool args",
    ErrorMode.SCOPE: "Scope", ErrorMode.TOOL_ROUTING: "Tool routing",
}  # fmt: skip
"""Titles of the error modes, in the order of the paper's table."""
BY_RULES = "Incorrect trials by error mode, by the rules"
PERCEPTION = frozenset({ErrorMode.VLM_QUERY, ErrorMode.VLM_COUNTING})


def by_rules(run: ReportRun) -> Counter[ErrorMode]:
    """Count incorrect trials by the error mode that the rules assign. Unscored trials and trials scored by a judge have none."""
    return Counter(t.error_mode for t in run.checked_trials if t.error_mode is not None)


def by_judge(run: ReportRun, judge: str) -> Counter[ErrorMode]:
    """Count the trials that a judge found incorrect, by the error mode that it named."""
    judged = [j for _, j in verdicts(run.scored_trials, judge) if j.verdict == "incorrect"]
    return Counter(j.error_mode for j in judged if j.error_mode is not None)


def error_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the error modes of runs of the main task set."""
    checked = [run for run in runs if run.checked_trials]
    rules = {run.label: by_rules(run) for run in checked}
    tables = [_mode_table("error_modes", BY_RULES, rules)]
    totals = {run.label: len(run.checked_trials) for run in checked}
    charts = [drawing.mode_chart("error_modes", BY_RULES, checked, rules, totals, MODE_TITLES, runs)] if checked else []
    judge = judge_name(runs)
    if judge is not None:
        judge_modes = {run.label: by_judge(run, judge) for run in runs if verdicts(run.scored_trials, judge)}
        judged = [run for run in runs if run.label in judge_modes]
        title = f"Incorrect trials by error mode, by the judge ({judge})"
        tables.append(_mode_table("error_modes_judge", title, judge_modes))
        charts.append(
            drawing.mode_chart(
                "error_modes_judge",
                title,
                judged,
                judge_modes,
                {run.label: len(_clear(run, judge)) for run in judged},
                MODE_TITLES,
                runs,
            )
        )
    text = (
        "Rules in a published order assign exactly one error mode to every incorrect trial. The judge names an error mode for each "
        "trial that it finds incorrect. Unscored trials, whose answers could not be parsed, are not correct but have no error mode."
        + ("" if judge else " No judge took part, so its error modes are not measured."),
    )
    return Section("errors", "Error modes", text, tuple(charts), tuple(tables))


def _mode_table(key: str, title: str, counted: Mapping[str, Counter[ErrorMode]]) -> ReportTable:
    columns = [Column("run", "Run"), *(Column(mode.value, words, "count") for mode, words in MODE_TITLES.items())]
    columns += [Column("failed", "All incorrect", "count"), Column("perception", "VLM query and counting (%)", "share")]
    rows = tuple(
        (
            label,
            *(found[mode] for mode in MODE_TITLES),
            found.total(),
            sum(found[m] for m in PERCEPTION) / found.total() if found else None,
        )
        for label, found in counted.items()
    )
    return ReportTable(key, title, tuple(columns), rows)


def oracle_section(ranked: Sequence[ReportRun], every: Sequence[ReportRun]) -> Section:
    """Return the section on the oracle setting: accuracy if perception never failed.

    Args:
        ranked: The runs of model pairs over the same tasks.
        every: All runs, among which runs with ground-truth perception are looked up.
    """
    judge = judge_name(ranked)
    columns = (
        Column("run", "Run"), Column("macro_judge", "Macro by judge (%)", "share"),
        Column("oracle_judge", "Judge's VLM errors counted as correct (%)", "share"),
        Column("perception_judge", "VLM share of errors, judge (%)", "share"),
        Column("macro_checks", "Macro by checks (%)", "share"),
        Column("oracle_rules", "Rules' VLM errors counted as correct (%)", "share"),
        Column("perception_rules", "VLM share of errors, rules (%)", "share"),
        Column("macro_rerun", "Rerun with ground-truth perception (%)", "share"),
        Column("gain_rerun", "Gain, paired (points)", "points"),
    )  # fmt: skip
    text = (
        "How accurate the pairs would be if perception never failed, measured in three ways. As in the paper, failures that the "
        "judge attributes to VLM counting or VLM query are counted as correct. The same is done with the error modes of the "
        "rules. If a log with ground-truth perception was given, the planner was actually run again, and the tasks of both runs "
        "are compared. Relabelling cannot show whether the planner would have continued correctly; a rerun can.",
        "Each is compared with a baseline of its kind: the judge's oracle with the judge's verdicts, the rules' oracle and the "
        "rerun with the verdicts of the checks.",
    )
    names = [column.name for column in columns]
    rows = [_oracle_row(run, _by_rules_oracle(run), _judge_oracle(run, judge), _rerun(run, every)) for run in ranked]
    table = ReportTable("oracle", "The oracle setting", columns, tuple(rows))
    charts = (drawing.oracle_chart(table),) if rows else ()
    if len(rows) > 1:
        table = replace(table, rows=(*rows, *_means(names, rows)), notes=(MEANS,))
    return Section("oracle", "If perception never failed", text, charts, (table,))


MEANS = (
    "A mean covers the pairs that have both the measured value and the value with perfect perception. If these are not all pairs, "
    "their number is given. The mean of the reruns is next to the mean of the same pairs by the checks."
)


Oracle = tuple[IntervalEstimate | None, IntervalEstimate | None, float | None]
"""Measured macro accuracy, macro accuracy with errors of perception counted as correct, and their share of all errors."""


def _by_rules_oracle(run: ReportRun) -> Oracle:
    right = [t.headline == "correct" or t.error_mode in PERCEPTION for t in run.checked_trials]
    return macro(scores_of(run.checked_trials)), macro(scores_of(run.checked_trials, right)), _perception_share(by_rules(run))


def _judge_oracle(run: ReportRun, judge: str | None) -> Oracle:
    judged = _clear(run, judge)
    trials = [t for t, _ in judged]
    plain = macro(scores_of(trials, [j.verdict == "correct" for _, j in judged]))
    lifted = macro(scores_of(trials, [j.verdict == "correct" or j.error_mode in PERCEPTION for _, j in judged]))
    return plain, lifted, _perception_share(by_judge(run, judge) if judge else Counter())


def _clear(run: ReportRun, judge: str | None) -> list[tuple[Trial, Judgement]]:
    """Return the trials on which the judge gave a verdict."""
    return [(t, j) for t, j in verdicts(run.scored_trials, judge or "") if j.verdict in ("correct", "incorrect")]


def _perception_share(failed: Counter[ErrorMode]) -> float | None:
    return sum(failed[mode] for mode in PERCEPTION) / failed.total() if failed else None


def _rerun(run: ReportRun, every: Sequence[ReportRun]) -> tuple[ReportRun, PairedComparison | None] | None:
    """Return the run of the same planner with ground-truth perception that shares most tasks with a run, and their comparison."""
    planner, _, agent, variant = run.system
    found = []
    for other in every:
        own, _, *further = other.system
        same = (own, *further) == (planner, agent, variant) and other.task_set == run.task_set and other.tasks & run.tasks
        if same and other.uses_exact_ground_truth and not other.evaluation.card.planner.deterministic:
            found.append(other)
    best = max(found, key=lambda other: len(other.tasks & run.tasks), default=None)
    return None if best is None else (best, compare(best, run))


def _oracle_row(
    run: ReportRun, rules: Oracle, judged: Oracle, again: tuple[ReportRun, PairedComparison | None] | None
) -> tuple[CellValue, ...]:
    gain = again[1].macro if again and again[1] else None
    return run.label, judged[0], judged[1], judged[2], rules[0], rules[1], rules[2], _shared_macro(run, again), gain


def _shared_macro(run: ReportRun, again: tuple[ReportRun, PairedComparison | None] | None) -> CellValue:
    """Return the macro accuracy of a rerun on the shared tasks, with a note if these are not all tasks."""
    if again is None:
        return None
    found = macro(scores_of([t for t in again[0].scored_trials if t.task.id in run.tasks]))
    shared = len(again[0].tasks & run.tasks)
    return found if shared == len(run.tasks) else MarkedCell(found, note=f"on {shared} of its {len(run.tasks)} tasks")


def _means(names: Sequence[str], rows: Sequence[tuple[CellValue, ...]]) -> list[tuple[CellValue, ...]]:
    """Return rows of means over pairs. Both sides of a comparison cover the same pairs; other cells are blank."""
    values = [{name: _complete(cell) for name, cell in zip(names, row, strict=True)} for row in rows]

    def means(title: str, *groups: tuple[str, ...]) -> tuple[CellValue, ...]:
        cells: dict[str, CellValue] = {**dict.fromkeys(names, ""), "run": title}
        for group in groups:
            having = [row for row in values if all(row[name] is not None for name in group[:2])]
            note = f"of {len(having)} of {len(values)} pairs" if len(having) < len(values) else ""
            for name in group:
                known = [value for row in having if (value := row[name]) is not None]
                cells[name] = MarkedCell(fmean(known), note=note) if known else None
        return tuple(cells[name] for name in names)

    by_judge, by_rules = (("macro_judge", "oracle_judge", "perception_judge"), ("macro_checks", "oracle_rules", "perception_rules"))
    found = [means("Mean of the pairs", by_judge, by_rules)]
    if any(row["macro_rerun"] is not None for row in values):
        found.append(means("Mean of the pairs run again", ("macro_checks", "macro_rerun", "gain_rerun")))
    return found


def _complete(cell: CellValue) -> float | None:
    """Return a value that covers all tasks of its run; None for one with a note that it covers only some."""
    plain = unmarked(cell)
    if isinstance(cell, MarkedCell) and cell.note:
        return None
    return plain.value if isinstance(plain, IntervalEstimate) else plain if isinstance(plain, float) else None
