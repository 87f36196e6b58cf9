"""Assemble a report from evaluations: select the runs of each section, and write the summary and the warnings."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from scope_ptz.bench.reports.choice.problems import describe_problems
from scope_ptz.bench.reports.choice.section import choice_section
from scope_ptz.bench.reports.choice.ties import compare_all, find_leaders, join_names
from scope_ptz.bench.reports.details.accuracy import accuracy_section
from scope_ptz.bench.reports.details.chance_section import chance_lines, chance_section, run_chance
from scope_ptz.bench.reports.details.conditions import conditions_section
from scope_ptz.bench.reports.details.difficulty import difficulty_section
from scope_ptz.bench.reports.details.error_analysis import MODE_TITLES, error_section, modes_by_rules, oracle_section
from scope_ptz.bench.reports.details.latency import latency_section
from scope_ptz.bench.reports.details.paper import paper_section
from scope_ptz.bench.reports.details.recommendations import architecture_section, design_section, scope_section, spread_section
from scope_ptz.bench.reports.details.review import audit_section, costs_section, incidents_section
from scope_ptz.bench.reports.details.sensitivity import baseline_section, reaction_section, repeats_section, sensitivity_section
from scope_ptz.bench.reports.display_names import unexpected_model
from scope_ptz.bench.reports.log_findings import finding_lines, stored_verdict_lines
from scope_ptz.bench.reports.paired_comparison import comparison_section
from scope_ptz.bench.reports.report_runs import (
    CATEGORY_TITLES,
    ReportRun,
    main_task_set,
    pairs_of,
    report_runs,
    runs_of_main_set,
    runs_on_same_tasks,
)
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import Column, MarkedCell, ReportTable
from scope_ptz.bench.scoring.error_modes import ErrorMode
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.bench.statistics.clustered import IntervalEstimate
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError
from scope_ptz.registry import Registry


@dataclass(frozen=True, slots=True)
class EvaluationReport:
    """A report on evaluations.

    Attributes:
        runs: The runs in report order.
        contradictions: Descriptions of logs that contradict their traces.
        problems: Descriptions of evaluations that ended in an error, are unfinished, or lost many trials to infrastructure
            failures, with bounds on their accuracy.
        notice: A notice about the whole report, for example that its runs are simulated; empty if there is none.
        summary: The main results.
        warnings: Limitations of the results.
        sections: The sections. The first section shows which pair to choose.
    """

    runs: tuple[ReportRun, ...]
    contradictions: tuple[str, ...]
    problems: tuple[str, ...]
    notice: str
    summary: tuple[str, ...]
    warnings: tuple[str, ...]
    sections: tuple[Section, ...]

    @property
    def tables(self) -> tuple[ReportTable, ...]:
        """The tables in all sections."""
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
        registry: The model registry.
        pages: Links to the pages about failed tasks, by task id.
        tasks: The known tasks by id, for the scores of constant answers.

    Raises:
        InputError: The evaluations contain no trials.
    """
    runs = report_runs(evaluations, registry)
    if not any(run.evaluation.trials for run in runs):
        raise InputError("These logs contain no finished run of a task. Finish one with 'scope bench run' first.")
    main = runs_of_main_set(runs)
    ranked = pairs_of(main)
    comparable = runs_on_same_tasks(ranked)
    exact = [run for run in main if run.is_exact_reference]
    ranked_and_reference = [*ranked, *(run for run in main if run.kind == "reference")]
    links = pages or {}
    distinctions = compare_all(ranked)
    best = find_leaders(comparable, distinctions)
    baselines = [run for run in main if not run.ranked]
    sections: list[Section | None] = [
        choice_section(
            comparable,
            [run for run in ranked if run not in comparable],
            baselines,
            runs,
            best,
            partial(_corrected_accuracy, tasks or {}),
        ),
        accuracy_section(runs, best),
        chance_section(runs, tasks or {}),
        comparison_section(ranked, distinctions.comparisons),
        repeats_section(main),
        error_section(ranked_and_reference) if ranked_and_reference else None,
        oracle_section(comparable, runs),
        spread_section(comparable, distinctions),
        scope_section(ranked_and_reference),
        latency_section(runs),
        design_section(comparable, runs, distinctions),
        architecture_section(comparable, runs),
        sensitivity_section(runs),
        reaction_section(runs),
        baseline_section(runs),
        audit_section(ranked, exact, links),
        difficulty_section(comparable),
        costs_section(runs),
        incidents_section(runs),
        _failed_tasks(runs, links),
        conditions_section(runs),
        paper_section(),
    ]
    return EvaluationReport(
        runs,
        tuple(line for run in runs for line in finding_lines(run.evaluation)),
        describe_problems(runs),
        _notice(runs),
        (*_summary(runs, ranked, comparable), *chance_lines(runs, tasks or {})),
        _warnings(runs, ranked, comparable),
        tuple(_omit_empty_tables(s) for s in sections if s is not None),
    )


def _omit_empty_tables(section: Section) -> Section:
    """Remove the empty tables from a section, and add a sentence that names them."""
    empty = [table.title for table in section.tables if not table.rows]
    if not empty:
        return section
    text = (*section.text, f"Not measured by these runs: {'; '.join(empty)}.")
    return replace(section, text=text, tables=tuple(table for table in section.tables if table.rows))


def _warnings(runs: Sequence[ReportRun], ranked: Sequence[ReportRun], comparable: Sequence[ReportRun]) -> tuple[str, ...]:
    warnings = stored_verdict_lines([run.evaluation for run in runs])
    if excluded := [run.label for run in ranked if run not in comparable]:
        warnings.append(
            f"These pairs were run on different tasks from most pairs: {'; '.join(excluded)}. Their averages are not comparable. "
            "They are left out of the oracle setting, the spreads and the recommendation of a pair. Paired comparisons use the "
            "shared tasks."
        )
    if other_runs := [run.label for run in runs if run.task_difference and run not in ranked]:
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
            served = unexpected_model(requested, registered)
            if served is not None:
                differing[f"{requested.name} (served: {served})"] = None
    if not differing:
        return []
    return [
        f"Servers reported a model other than the requested one: {'; '.join(differing)}. The rows of these models state this. "
        "Size, precision and memory are those of the requested model in the registry."
    ]


def _corrected_accuracy(tasks: Mapping[str, Task], run: ReportRun) -> IntervalEstimate | None:
    """Return the chance-corrected accuracy of a run; None if its tasks are unknown."""
    chance = run_chance(run, tasks)
    return chance.corrected.corrected if chance is not None and chance.corrected is not None else None


def _notice(runs: Sequence[ReportRun]) -> str:
    """Return the notice that runs are simulated, or an empty string if no run is."""
    simulated = sum(run.simulated for run in runs)
    if not simulated:
        return ""
    number = "All runs of this report are" if simulated == len(runs) else f"{simulated} of the {len(runs)} runs of this report are"
    return f"{number} simulated: no model was run. The results of simulated runs say nothing about any model."


def _summary(runs: Sequence[ReportRun], ranked: Sequence[ReportRun], comparable: Sequence[ReportRun]) -> tuple[str, ...]:
    trials = sum(len(run.evaluation.trials) for run in runs)
    lines = [
        f"{_count_text(len(runs), 'run')} with {_count_text(trials, 'trial')} (a trial is one run of one task); "
        f"{_count_text(len(comparable), 'pair')} of models on the main task set"
        + (f" ({_count_text(len(comparable[0].tasks), 'task')})" if comparable else "")
        + (f"; {_count_text(len(ranked) - len(comparable), 'more pair')} on other tasks." if len(ranked) > len(comparable) else ".")
    ]
    modes = sum((modes_by_rules(run) for run in comparable), start=Counter[ErrorMode]())
    if modes:
        number = max(modes.values())
        most = [MODE_TITLES[mode] for mode in MODE_TITLES if modes[mode] == number]
        unscored = sum(trial.headline == "unscored" for run in comparable for trial in run.scored_trials)
        lines.append(
            f"Most frequent error mode{'s' if len(most) > 1 else ''} of model pairs: {join_names(most)}, {number}"
            f"{' each' if len(most) > 1 else ''} of {_count_text(modes.total(), 'incorrect trial')}"
            + (f"; {_count_text(unscored, 'more is', 'more are')} unscored and have no error mode." if unscored else ".")
        )
    return tuple(lines)


def _count_text(count: int, singular: str, plural: str = "") -> str:
    return f"{count:,} {singular if count == 1 else plural or singular + 's'}"


def _failed_tasks(runs: Sequence[ReportRun], pages: Mapping[str, str]) -> Section:
    """Return the section about the tasks that failed in at least one run, with links to their pages."""
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
        f"{_count_text(len(rows), 'task')} failed at least once. Incorrect and unscored trials count as failed."
        + (" Each task has a page with its frames." if pages else ""),
    )
    table = ReportTable("failed_tasks", "Failed tasks", columns, tuple(rows))
    return Section("failed", "Failed tasks", text, (), (table,) if rows else (), frozenset({"failed_tasks"}))
