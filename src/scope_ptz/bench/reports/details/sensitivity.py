"""The sections on sensitivity to wording and prompts, repeats, unclear or forbidden requests, and baselines."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from statistics import fmean

from scope_ptz.bench.reports import charts as drawing
from scope_ptz.bench.reports.details.accuracy import fraction_correct
from scope_ptz.bench.reports.paired_comparison import compare, comparison_table
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.repeats import mean_pass_all

System = tuple[str, str, str, str]
"""The planner, perception model, agent and variant of a run, as in ``ReportRun.system``."""


def sensitivity_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on sensitivity to paraphrases and to prompts."""
    text = ["A scenario is a task with all its wordings. It succeeds if every wording succeeds in its first trial."]
    paraphrases = _wording_table(runs)
    variants = _variant_table(runs)
    if not paraphrases.rows:
        text.append("No run contains both paraphrases and their originals, so sensitivity to wording is not measured.")
    if not variants.rows:
        text.append("No pair was run with more than one prompt or setting, so sensitivity to the prompt is not measured.")
    tables = tuple(table for table in (paraphrases, variants) if table.rows)
    return Section("sensitivity", "Sensitivity to wording and prompt", tuple(text), (), tables)


def _by_system(runs: Sequence[ReportRun]) -> dict[System, list[Trial]]:
    """Return, for each system, the first trial of each task. Trials with an infrastructure failure are excluded."""
    by_system: dict[System, dict[str, Trial]] = defaultdict(dict)
    for run in runs:
        for trial in run.evaluation.trials:
            if trial.epoch == 1 and trial.headline != "infrastructure":
                by_system[run.system].setdefault(trial.task.id, trial)
    return {system: list(trials.values()) for system, trials in by_system.items()}


def _scenarios(trials: Sequence[Trial]) -> list[list[bool]]:
    """Return the outcomes of all wordings in each scenario. Scenarios without the original or a paraphrase are excluded."""
    groups: dict[str, list[Trial]] = defaultdict(list)
    for trial in trials:
        groups[trial.task.paraphrase_of or trial.task.id].append(trial)
    complete = [g for original, g in groups.items() if len(g) > 1 and any(t.task.id == original for t in g)]
    return [[t.headline == "correct" for t in group] for group in complete]


def _wording_table(runs: Sequence[ReportRun]) -> ReportTable:
    columns = (
        Column("system", "Pair"),
        Column("scenarios", "Scenarios", "count"),
        Column("wordings", "Wordings", "count"),
        Column("mean", "Mean over wordings (%)", "share"),
        Column("all", "Every wording correct (%)", "share"),
        Column("any", "Some wording correct (%)", "share"),
        Column("mixed", "Depends on the wording (%)", "share"),
    )
    rows: list[tuple[CellValue, ...]] = []
    for system, trials in _by_system(runs).items():
        scenarios = _scenarios(trials)
        if scenarios:
            every, some = fmean(all(s) for s in scenarios), fmean(any(s) for s in scenarios)
            mean = fmean(fmean(s) for s in scenarios)
            rows.append((_name(system), len(scenarios), sum(map(len, scenarios)), mean, every, some, some - every))
    return ReportTable("wording", "Other wordings of the same task", columns, tuple(rows))


def _name(system: System) -> str:
    planner, perception, agent, variant = system
    return ", ".join(
        [f"{planner} + {perception}", *([f"agent {agent}"] if agent != "scope" else []), *([variant] if variant else [])]
    )


def _variant_table(runs: Sequence[ReportRun]) -> ReportTable:
    """Return a table that compares each variant of a pair with the unchanged pair."""
    comparisons = []
    for run in runs:
        if run.evaluation.card.variant and run.kind != "blind":
            unchanged = [r for r in runs if r.system == (*run.system[:3], "") and r.task_set == run.task_set]
            comparisons += [c for base in unchanged[:1] if (c := compare(run, base)) is not None]
    return comparison_table("prompts", "Prompts and settings: each variant minus the unchanged pair", comparisons)


def repeats_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on pass^k for runs with repeated tasks."""
    repeated = [run for run in runs if _max_trials(run) > 1]
    max_trials = max((_max_trials(run) for run in repeated), default=0)
    if not repeated:
        return Section("repeats", "Repeats", ("Every task was run once, so pass^k is not measured for k above 1.",))
    columns = [Column("run", "Run"), Column("tasks", "Tasks", "count")]
    columns += [Column(f"pass_{k}", f"pass^{k} (%)", "share") for k in range(1, max_trials + 1)]
    rows = []
    for run in repeated:
        tasks = _trials_by_task(run)
        rows.append((run.label, len(tasks), *(mean_pass_all(tasks, k)[0] for k in range(1, max_trials + 1))))
    text = (
        "pass^k is the probability that k trials of a task all succeed. For a task with c correct of n trials it is C(c, k) / "
        "C(n, k). The table shows the mean over the tasks with at least k trials without an infrastructure failure. Runs without "
        "repeats are left out.",
    )
    table = ReportTable("repeats", "pass^k", tuple(columns), tuple(rows))
    return Section("repeats", "Repeats", text, (drawing.repeats_chart(table, max_trials),), (table,))


def _trials_by_task(run: ReportRun) -> list[tuple[int, int]]:
    """Return the number of trials and the number of correct trials of each task."""
    outcomes: dict[str, list[bool]] = defaultdict(list)
    for trial in run.scored_trials:
        outcomes[trial.task.id].append(trial.headline == "correct")
    return [(len(values), sum(values)) for values in outcomes.values()]


def _max_trials(run: ReportRun) -> int:
    """Return the maximum number of trials per task."""
    return max((trials for trials, _ in _trials_by_task(run)), default=0)


def reaction_section(runs: Sequence[ReportRun]) -> Section | None:
    """Return the section on requests that the agent should ask about or refuse; None if no run contains such requests."""
    reaction_runs = [(run, trials) for run in runs if (trials := _reaction_trials(run))]
    if not reaction_runs:
        return None
    columns = (
        Column("run", "Run"),
        Column("trials", "Trials", "count"),
        Column("correct", "Correct (%)", "share"),
        Column("answered", "Answered anyway (%)", "share"),
        Column("asked", "Asked a question (%)", "share"),
        Column("refused", "Refused (%)", "share"),
    )
    rows = tuple(
        (
            run.label,
            len(trials),
            fraction_correct(trials),
            *(fmean(t.outcome == o for t in trials) for o in ("answered", "clarification", "refused")),
        )
        for run, trials in reaction_runs
    )
    text = (
        "These requests are unclear, impossible or forbidden. The correct reaction is a clarifying question or a refusal, without "
        "moving the camera. These requests are not included in accuracy.",
    )
    table = ReportTable("reactions", "Requests that require a question or a refusal", columns, rows)
    return Section("reactions", "Unclear, impossible and forbidden requests", text, (), (table,))


def _reaction_trials(run: ReportRun) -> list[Trial]:
    return [t for t in run.evaluation.trials if t.task.stratum == "reaction" and t.headline != "infrastructure"]


def baseline_section(runs: Sequence[ReportRun]) -> Section | None:
    """Return the section on the accuracy of blind and human baselines; None if there are no such runs."""
    baselines = [run for run in runs if run.kind in ("blind", "person") and run.scored_trials]
    if not baselines:
        return None
    columns = [Column("run", "Run"), Column("kind", "Kind"), *(Column(n, w, "share") for n, w in CATEGORY_TITLES.items())]
    columns.append(Column("macro", "Macro (%)", "share"))
    rows = tuple(
        (
            run.label,
            "without perception" if run.kind == "blind" else "a person",
            *(fraction_correct([t for t in run.scored_trials if t.task.category == name]) for name in CATEGORY_TITLES),
            run.macro,
        )
        for run in baselines
    )
    text = (
        "The blind baseline is the accuracy of a planner without perception. The human baseline shows what accuracy is achievable.",
    )
    return Section(
        "baselines", "Baselines", text, (), (ReportTable("baselines", "Blind and human baselines", tuple(columns), rows),)
    )
