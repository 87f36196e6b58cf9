"""Assemble a report from evaluations: select the runs of each section, and write the summary and the warnings."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from scope_ptz.bench.reports.accuracy import KIND_TITLES, accuracy_section
from scope_ptz.bench.reports.chance_section import chance_lines, chance_section
from scope_ptz.bench.reports.display_names import served_instead
from scope_ptz.bench.reports.error_analysis import MODE_TITLES, error_section, modes_by_rules, oracle_section
from scope_ptz.bench.reports.latency import latency_section
from scope_ptz.bench.reports.paired_comparison import compare, comparison_section, comparison_table
from scope_ptz.bench.reports.paper import paper_section
from scope_ptz.bench.reports.recommendations import architecture_section, design_section, scope_section, spread_section
from scope_ptz.bench.reports.report_runs import (
    CATEGORY_TITLES,
    ReportRun,
    main_task_set,
    of_main_set,
    on_the_same_tasks,
    pairs_of,
    report_runs,
)
from scope_ptz.bench.reports.review import audit_section, conduct_section, costs_section
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.sensitivity import baseline_section, reaction_section, repeats_section, sensitivity_section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable, interval
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError
from scope_ptz.registry import Registry


@dataclass(frozen=True, slots=True)
class EvaluationReport:
    """A report on evaluations.

    Attributes:
        runs: The runs in the order of the report.
        summary: The main results.
        warnings: Limitations of the results.
        sections: The sections.
    """

    runs: tuple[ReportRun, ...]
    summary: tuple[str, ...]
    warnings: tuple[str, ...]
    sections: tuple[Section, ...]

    @property
    def tables(self) -> tuple[ReportTable, ...]:
        """The tables of all sections."""
        return tuple(table for section in self.sections for table in section.tables)


def build_report(
    evaluations: Sequence[Evaluation],
    registry: Registry,
    pages: Mapping[str, str] | None = None,
    tasks: Mapping[str, Task] | None = None,
) -> EvaluationReport:
    """Build a report.

    Args:
        evaluations: The evaluations.
        registry: The registry that describes the models.
        pages: Link to the page of each failed task, by the task's id.
        tasks: The known tasks by id, for what constant answers win.

    Raises:
        InputError: The evaluations contain no trials.
    """
    runs = report_runs(evaluations, registry)
    if not any(run.evaluation.trials for run in runs):
        raise InputError("These logs contain no finished run of a task. Finish one with 'scope bench run' first.")
    main = of_main_set(runs)
    ranked = pairs_of(main)
    comparable = on_the_same_tasks(ranked)
    exact = [run for run in main if run.is_exact_reference]
    ranked_and_reference = [*ranked, *(run for run in main if run.kind == "reference")]
    links = pages or {}
    sections: list[Section | None] = [
        accuracy_section(runs),
        chance_section(runs, tasks or {}),
        comparison_section(ranked),
        repeats_section(main),
        error_section(ranked_and_reference) if ranked_and_reference else None,
        oracle_section(comparable, runs),
        spread_section(comparable),
        scope_section(ranked_and_reference),
        latency_section(runs),
        design_section(comparable, runs),
        architecture_section(comparable, runs),
        sensitivity_section(runs),
        reaction_section(runs),
        baseline_section(runs),
        audit_section(ranked, exact, links),
        costs_section(runs),
        conduct_section(runs),
        _failed_tasks(runs, links),
        _overview(runs),
        paper_section(),
    ]
    return EvaluationReport(
        runs,
        (*_summary(runs, ranked, comparable), *chance_lines(runs, tasks or {})),
        _warnings(runs, ranked, comparable),
        tuple(_without_empty_tables(s) for s in sections if s is not None),
    )


def _without_empty_tables(section: Section) -> Section:
    """Replace the empty tables of a section with a sentence that names them."""
    empty = [table.title for table in section.tables if not table.rows]
    if not empty:
        return section
    text = (*section.text, f"Not measured by these runs: {'; '.join(empty)}.")
    return replace(section, text=text, tables=tuple(table for table in section.tables if table.rows))


def _overview(runs: Sequence[ReportRun]) -> Section:
    columns = (
        Column("run", "Run"),
        Column("kind", "Kind"),
        Column("dataset", "Dataset"),
        Column("split", "Split"),
        Column("trials", "Trials", "count"),
        Column("wanted", "Planned trials", "count"),
        Column("epochs", "Repeats", "count"),
        Column("agent", "Agent"),
        Column("variant", "Variant"),
        Column("max_steps", "Step limit", "count"),
        Column("seed", "Seed"),
        Column("sampling", "Sampling", "prose"),
        Column("prompt", "Prompt"),
        Column("planner_reported", "Reported by the planner's server", "prose"),
        Column("eyes_reported", "Reported by the perception server", "prose"),
        Column("concurrency", "Concurrency", "count"),
        Column("timing", "Timing"),
        Column("package", "scope-ptz"),
        Column("engine", "Engine"),
        Column("tasks_digest", "Digest of the tasks"),
        Column("started", "Started"),
        Column("host", "Host"),
    )
    text = ("The conditions of each run, from its run card.",)
    table = ReportTable("runs", "Runs and their conditions", columns, tuple(_card_row(run) for run in runs))
    return Section("runs", "Conditions", text, (), (table,), frozenset({"runs"}))


def _card_row(run: ReportRun) -> tuple[CellValue, ...]:
    card = run.evaluation.card
    sampling = ", ".join(f"{key} {value}" for key, value in _flattened(card.sampling))
    return (
        run.label,
        KIND_TITLES[run.kind],
        card.dataset,
        run.task_set[1],
        len(run.evaluation.trials),
        run.evaluation.wanted,
        card.epochs,
        card.agent,
        card.variant or "as it is",
        card.max_steps,
        None if card.seed is None else str(card.seed),
        sampling or None,
        card.prompt_digest[:12] or None,
        _reported(card.planner.reported),
        _reported(card.perception.reported),
        card.concurrency,
        "contended" if card.contended else "alone",
        card.package_version,
        card.engine_version,
        card.dataset_digest[:12] or None,
        card.started,
        card.host or None,
    )


def _flattened(settings: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield nested settings with their full names, such as ``planner.temperature``."""
    for key, value in sorted(settings.items()):
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _reported(reported: Mapping[str, str]) -> str | None:
    return ", ".join(f"{key} {value}" for key, value in sorted(reported.items())) or None


def _warnings(runs: Sequence[ReportRun], ranked: Sequence[ReportRun], comparable: Sequence[ReportRun]) -> tuple[str, ...]:
    warnings = [
        f"{run.label} is unfinished: {len(run.evaluation.trials)} of {run.evaluation.wanted} trials."
        for run in runs
        if not run.evaluation.finished
    ]
    if left_out := [run.label for run in ranked if run not in comparable]:
        warnings.append(
            f"These pairs were run on different tasks from most pairs: {'; '.join(left_out)}. Their averages are not comparable. "
            "They are left out of the oracle setting, the spreads and the recommendation of a pair. Paired comparisons use the "
            "shared tasks."
        )
    if other_runs := [run.label for run in runs if run.other_tasks and run not in ranked]:
        warnings.append(
            "These reference runs, variants and baselines cover different tasks from the model pairs, as their labels state: "
            f"{'; '.join(other_runs)}. Their averages are not comparable with those of the pairs."
        )
    warnings += _served_models_warning(runs)
    if len({run.task_set for run in runs if run.main_trials}) > 1:
        chosen = main_task_set(runs)
        warnings.append(
            "There are several task sets. All sections except accuracy, latency, cost and sensitivity cover only "
            f"{' '.join(chosen or ())}."
        )
    if not all(run.ranked for run in runs):
        warnings.append(
            "Some runs used the grammar planner or ground-truth perception (exact or noisy), ran without perception, or were "
            "carried out by a person. They are marked and not ranked."
        )
    return tuple(warnings)


def _served_models_warning(runs: Sequence[ReportRun]) -> list[str]:
    """Return a warning if a server reported a model other than the requested one."""
    differing: dict[str, None] = {}
    for run in runs:
        card = run.evaluation.card
        for requested, registered in ((card.planner, run.planner), (card.perception, run.perception)):
            served = served_instead(requested, registered)
            if served is not None:
                differing[f"{requested.name} (served: {served})"] = None
    if not differing:
        return []
    return [
        f"Servers reported a model other than the requested one: {'; '.join(differing)}. The rows of these models state this. "
        "Size, precision and memory are those of the requested model in the registry."
    ]


def _summary(runs: Sequence[ReportRun], ranked: Sequence[ReportRun], comparable: Sequence[ReportRun]) -> tuple[str, ...]:
    trials = sum(len(run.evaluation.trials) for run in runs)
    lines = [
        f"{_number(len(runs), 'run')} with {_number(trials, 'trial')} (a trial is one run of one task); "
        f"{_number(len(comparable), 'pair')} of models on the main task set"
        + (f" ({_number(len(comparable[0].tasks), 'task')})" if comparable else "")
        + (f"; {_number(len(ranked) - len(comparable), 'more pair')} on other tasks." if len(ranked) > len(comparable) else ".")
    ]
    order = sorted((r for r in comparable if r.macro), key=lambda r: -(r.macro.value if r.macro else 0.0))
    if order and order[0].macro:
        lines.append(f"Highest macro accuracy: {order[0].label}, {_percent(order[0])}.")
    if len(order) > 1 and (comparison := compare(order[0], order[1])) is not None:
        (row,) = comparison_table("x", "x", [comparison]).rows
        result = "is significant" if row[11] == "yes" else "is not significant"
        lines.append(
            f"Second: {order[1].label}, {_percent(order[1])}. In a single test, the difference between these two {result}."
        )
    if not ranked:
        lines.append("These runs include no pair of models, so nothing is ranked.")
    modes = sum((modes_by_rules(run) for run in comparable), start=Counter[ErrorMode]())
    if modes:
        mode, number = modes.most_common(1)[0]
        unscored = sum(trial.headline == "unscored" for run in comparable for trial in run.scored_trials)
        lines.append(
            f"Most frequent error mode of model pairs: {MODE_TITLES[mode]}, {number} of "
            f"{_number(modes.total(), 'incorrect trial')}"
            + (f"; {_number(unscored, 'more is', 'more are')} unscored and have no error mode." if unscored else ".")
        )
    return tuple(lines)


def _percent(run: ReportRun) -> str:
    macro = run.macro
    if macro is None:
        return "not measured"
    bounds, limits = interval(macro, "share")
    certainty = ", ".join(filter(None, (f"95% interval {bounds}" if bounds else "", limits)))
    return f"{100 * macro.value:.1f}% ({certainty})"


def _number(count: int, singular: str, plural: str = "") -> str:
    return f"{count:,} {singular if count == 1 else plural or singular + 's'}"


def _failed_tasks(runs: Sequence[ReportRun], pages: Mapping[str, str]) -> Section:
    """Return the section on the tasks that failed in at least one run, with links to their pages."""
    columns = (
        Column("task", "Task"),
        Column("category", "Category"),
        Column("instruction", "Instruction", "prose"),
        Column("expected", "Expected", "prose"),
        Column("failed", "Failed trials", "count"),
        Column("unscored", "Of these, unscored", "count"),
        Column("trials", "All trials", "count"),
        Column("failed_by", "Failed by"),
    )
    by_task = defaultdict(list)
    for run in runs:
        for trial in run.evaluation.trials:
            by_task[trial.task.id].append((run, trial))
    rows = []
    for task, task_trials in sorted(by_task.items()):
        failed = [run.label for run, trial in task_trials if trial.headline in ("incorrect", "unscored")]
        unscored = sum(trial.headline == "unscored" for _, trial in task_trials)
        if failed:
            facts = task_trials[0][1].task
            names = "; ".join(dict.fromkeys(failed))
            rows.append(
                (
                    MarkedCell(task, link=pages.get(task, "")),
                    CATEGORY_TITLES[facts.category],
                    facts.instruction,
                    facts.expected,
                    len(failed),
                    unscored,
                    len(task_trials),
                    names,
                )
            )
    text = (
        f"{_number(len(rows), 'task')} failed at least once. Incorrect and unscored trials count as failed."
        + (" Each task has a page with its frames." if pages else ""),
    )
    table = ReportTable("failed_tasks", "Failed tasks", columns, tuple(rows))
    return Section("failed", "Failed tasks", text, (), (table,) if rows else (), frozenset({"failed_tasks"}))
