"""The sections on tasks that nearly all pairs fail, on costs, and on side effects and incidents."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from statistics import fmean

from scope_ptz.bench.reports.error_analysis import MODE_TITLES
from scope_ptz.bench.reports.report_runs import CATEGORY_TITLES, ReportRun
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, MarkedCell, ReportTable
from scope_ptz.bench.scoring.trials import Trial

MAX_SUCCESS = 0.25
"""Tasks with at most this success rate are listed in the audit."""
MAX_LISTED = 60
"""Maximum number of tasks in the audit."""


def audit_section(ranked: Sequence[ReportRun], reference: Sequence[ReportRun], pages: Mapping[str, str]) -> Section:
    """Return the section that lists the tasks with a low success rate over all pairs.

    Args:
        ranked: The runs of model pairs.
        reference: Runs of the grammar planner with exact ground-truth perception.
        pages: The page of each failed task, by the task's id.
    """
    text = [
        f"The tasks on which all pairs together succeed in at most {MAX_SUCCESS:.0%} of their trials. Such a task is hard or "
        "wrong, so an audit of the benchmark starts here. The last column is the result of the grammar planner with ground-truth "
        "perception. A task that they pass can be done as it is worded. They understand only a limited language, so their failure "
        "alone proves nothing."
    ]
    if len(ranked) < 2:
        text.append("There are fewer than two model pairs, so this is not measured.")
        return Section("audit", "Tasks that nearly every pair fails", tuple(text))
    by_task = _by_task(ranked)
    low = sorted((fmean(t.headline == "correct" for _, t in runs), task) for task, runs in by_task.items())
    chosen = [(value, task) for value, task in low if value <= MAX_SUCCESS]
    exact = _by_task(reference)
    columns = (
        Column("task", "Task"),
        Column("category", "Category"),
        Column("scope", "Scope"),
        Column("instruction", "Instruction", "prose"),
        Column("expected", "Expected", "prose"),
        Column("success", "Success (%)", "share"),
        Column("trials", "Trials", "count"),
        Column("passed_by", "Passed by"),
        Column("modes", "Error modes (rules)"),
        Column("reference", "Grammar planner, ground-truth perception (%)", "share"),
    )
    rows = tuple(_audit_row(task, value, by_task[task], exact.get(task, []), pages) for value, task in chosen[:MAX_LISTED])
    text.append(
        f"{len(chosen)} of {len(by_task)} tasks." + (f" The first {MAX_LISTED} are listed." if len(chosen) > MAX_LISTED else "")
    )
    return Section(
        "audit", "Tasks that nearly every pair fails", tuple(text), (), (ReportTable("audit", "Tasks to audit", columns, rows),)
    )


def _by_task(runs: Sequence[ReportRun]) -> dict[str, list[tuple[ReportRun, Trial]]]:
    found: dict[str, list[tuple[ReportRun, Trial]]] = defaultdict(list)
    for run in runs:
        for trial in run.scored_trials:
            found[trial.task.id].append((run, trial))
    return found


def _audit_row(
    task: str,
    success: float,
    own: Sequence[tuple[ReportRun, Trial]],
    exact: Sequence[tuple[ReportRun, Trial]],
    pages: Mapping[str, str],
) -> tuple[CellValue, ...]:
    facts = own[0][1].task
    passed = list(dict.fromkeys(run.label for run, trial in own if trial.headline == "correct"))
    modes = Counter(trial.error_mode for _, trial in own if trial.error_mode)
    named = ", ".join(f"{MODE_TITLES[mode]} {number}" for mode, number in modes.most_common())
    reference = fmean(trial.headline == "correct" for _, trial in exact) if exact else None
    return (
        MarkedCell(task, link=pages.get(task, "")),
        CATEGORY_TITLES[facts.category],
        facts.scope,
        facts.instruction,
        facts.expected,
        success,
        len(own),
        "; ".join(passed) or "nobody",
        named or "none",
        reference,
    )


def costs_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on the tokens and the cost of each run."""
    columns = (
        Column("run", "Run"),
        Column("trials", "Trials", "count"),
        Column("input_tokens", "Input tokens", "count"),
        Column("output_tokens", "Output tokens", "count"),
        Column("tokens_a_trial", "Tokens per trial, mean", "count"),
        Column("priced", "Priced trials", "count"),
        Column("cost_usd", "Cost of priced trials (USD)", "usd"),
        Column("cost_a_trial", "USD per trial", "usd"),
        Column("cost_a_success", "USD per correct trial", "usd"),
        Column("judge_tokens", "Tokens of judges", "count"),
    )
    notes = (
        "Tokens are those of the planner, as its server reports them. Tokens of the perception model are not counted. The cost is "
        "that of the planner's tokens and is given only if the log contains it.",
    )
    return Section(
        "costs", "Cost", (), (), (ReportTable("costs", "Tokens and cost", columns, tuple(_cost_row(r) for r in runs), notes),)
    )


def _cost_row(run: ReportRun) -> tuple[CellValue, ...]:
    trials = run.evaluation.trials
    sent, received = sum(t.input_tokens for t in trials), sum(t.output_tokens for t in trials)
    counted = sent + received > 0
    priced = [t for t in trials if t.cost_usd is not None]
    cost = sum(t.cost_usd or 0.0 for t in priced) if priced else None
    right = sum(t.headline == "correct" for t in priced)
    judge = sum(j.input_tokens + j.output_tokens for t in trials for j in t.judgements)
    return (
        run.label,
        len(trials),
        sent if counted else None,
        received if counted else None,
        (sent + received) / len(trials) if counted else None,
        len(priced),
        cost,
        cost / len(priced) if cost is not None else None,
        cost / right if cost is not None and right else None,
        judge or None,
    )


def conduct_section(runs: Sequence[ReportRun]) -> Section:
    """Return the section on collateral changes, wrong calls, failures of perception and failures of servers."""
    columns = (
        Column("run", "Run"),
        Column("collateral", "Collateral change (%)", "share"),
        Column("bad_calls", "Wrong calls per trial", "number"),
        Column("perception_failures", "Failed perception calls per trial", "number"),
        Column("steps", "Steps per trial", "number"),
        Column("limit", "At the step or time limit (%)", "share"),
        Column("server_events", "Server failures, including recovered ones"),
    )
    notes = (
        "Collateral change: the camera ended elsewhere although neither the instruction nor finding the answer required a move. "
        "It does not affect accuracy.",
    )
    having = [run for run in runs if run.evaluation.trials]
    rows = tuple(_conduct_row(run) for run in having)
    return Section(
        "conduct",
        "Side effects and incidents",
        (),
        (),
        (ReportTable("conduct", "Side effects and incidents", columns, rows, notes),),
    )


def _conduct_row(run: ReportRun) -> tuple[CellValue, ...]:
    trials = [t for t in run.evaluation.trials if t.headline != "infrastructure"]
    events = sum((Counter(t.server_events) for t in run.evaluation.trials), Counter[str]())
    failures = ", ".join(f"{kind} {number}" for kind, number in sorted(events.items())) or "none"
    if not trials:
        return run.label, None, None, None, None, None, failures
    return (
        run.label,
        fmean(t.collateral for t in trials),
        fmean(t.bad_calls for t in trials),
        fmean(t.perception_failures for t in trials),
        fmean(t.steps for t in trials),
        fmean(t.outcome in ("step_limit", "budget") for t in trials),
        failures,
    )
