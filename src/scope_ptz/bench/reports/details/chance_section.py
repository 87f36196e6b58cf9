"""The section on chance: the scores of constant answers on the tasks of the runs, and chance-corrected accuracy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from scope_ptz.bench.reports.report_runs import MAIN_STRATA, ReportRun, runs_of_main_set, scores_of
from scope_ptz.bench.reports.sections import Section
from scope_ptz.bench.reports.tables import CellValue, Column, ReportTable, interval_texts
from scope_ptz.bench.scoring.constant_agents import chance_level
from scope_ptz.bench.scoring.trials import Trial
from scope_ptz.bench.statistics.chance import ChanceCorrected, ChanceLevel, ConstantAgentScore, chance_corrected, pair_consistent
from scope_ptz.bench.tasks.task import Task

_ABOUT = (
    "A constant answer is the same text for every task. It is scored by the checks on synthetic runs. “Without a call” makes no "
    "tool call, so the coverage check rejects almost all of its answers; “accepted” ignores all checks except the answer check. "
    "“Move, look once” makes the moves of the reference program and one perception call with the whole instruction. Its later "
    "moves are also those of the reference program, so its scores are upper bounds. “By category” uses the best answer of each "
    "category. Shares are fractions of the tasks that expect an answer, a clarifying question or a refusal.",
    "In a contrast pair, two tasks have similar wording; the thing in question is present in one and absent in the other. In "
    "pair-consistent shares, a task of a pair counts only if both tasks of the pair are correct (contrast consistency, Gardner et "
    "al. 2020). Tasks without a pair, or whose twin was not run, are counted individually.",
    "Chance-corrected accuracy is the mean over the categories of (p - c) / (1 - c), where p is the pair-consistent accuracy in "
    "the category and c is that of the best constant answer after moving and looking once (Abbott 1925). It is 0% for the best "
    "constant answers, 100% if every trial is correct, and negative below chance.",
)


@dataclass(frozen=True, slots=True)
class RunChance:
    """A run and the chance level of its tasks.

    Attributes:
        run: The run.
        level: The scores of constant answers on all tasks of the run.
        corrected: The chance-corrected accuracy; None without scored core tasks.
    """

    run: ReportRun
    level: ChanceLevel
    corrected: ChanceCorrected | None


def run_chance(run: ReportRun, tasks: Mapping[str, Task]) -> RunChance | None:
    """Compute the chance level of a run's tasks.

    Args:
        run: The run.
        tasks: The known tasks by id.

    Returns:
        The run with its chance level; None if the run has no tasks, or one of them is unknown.
    """
    ids = list(dict.fromkeys(trial.task.id for trial in run.evaluation.trials))
    if not ids or any(name not in tasks for name in ids):
        return None
    rows = [tasks[name] for name in sorted(ids)]
    main = [task for task in rows if task.stratum in MAIN_STRATA]
    corrected = None
    if main and run.scored_trials:
        scores = scores_of(run.scored_trials, consistent_outcomes(run.scored_trials))
        corrected = chance_corrected(scores, chance_level(main).by_category)
    return RunChance(run, chance_level(rows), corrected)


def consistent_outcomes(trials: Sequence[Trial]) -> list[bool]:
    """Return the pair-consistent outcome of each trial. Pairs are formed within each repeat."""
    outcomes = [False] * len(trials)
    for epoch in dict.fromkeys(trial.epoch for trial in trials):
        positions = [i for i, trial in enumerate(trials) if trial.epoch == epoch]
        rows = [trials[i] for i in positions]
        consistent = pair_consistent(
            [t.headline == "correct" for t in rows], [t.task.id for t in rows], [t.task.pair for t in rows]
        )
        for position, value in zip(positions, consistent, strict=True):
            outcomes[position] = value
    return outcomes


def chance_section(runs: Sequence[ReportRun], tasks: Mapping[str, Task]) -> Section | None:
    """Return the section on chance; None if the tasks are unknown for every run."""
    known = [entry for run in runs if (entry := run_chance(run, tasks)) is not None]
    if not known:
        return None
    text = list(_ABOUT)
    if excluded := [run.label for run in runs if run not in [entry.run for entry in known] and run.evaluation.trials]:
        text.append(f"These runs are excluded because their tasks are unknown: {'; '.join(excluded)}.")
    return Section("chance", "Chance", tuple(text), (), (_corrected_table(known), _constant_table(known)))


def chance_lines(runs: Sequence[ReportRun], tasks: Mapping[str, Task]) -> Iterator[str]:
    """Yield summary lines: the chance-corrected accuracy of the best run, and the best constant answers on the main tasks."""
    known = [
        entry for run in runs_of_main_set(runs) if (entry := run_chance(run, tasks)) is not None and entry.corrected is not None
    ]
    if not known:
        return
    ranked = [entry for entry in known if entry.run.ranked] or known
    best = max(ranked, key=lambda entry: entry.run.macro.value if entry.run.macro else 0.0)
    if best.corrected is not None:
        bounds, _ = interval_texts(best.corrected.corrected, "share")
        yield (
            f"Chance-corrected macro accuracy of {best.run.label}: {100 * best.corrected.corrected.value:.1f}%"
            + (f" (95% interval {bounds})." if bounds else ".")
        )
    level = best.level
    yield (
        f"On these tasks, the best constant answer scores {_percent(level.without_calls)} without a tool call, and "
        f"{_percent(level.looking)} after moving and observing once ({100 * level.looking.consistent_share:.1f}% pair-consistent)."
    )


def _percent(score: ConstantAgentScore) -> str:
    answer = f" (“{score.answer}”)" if score.correct else ""
    return f"{100 * score.share:.1f}%{answer}"


def _corrected_table(known: Sequence[RunChance]) -> ReportTable:
    columns = (
        Column("run", "Run"), Column("macro", "Macro average", "share"),
        Column("consistent", "Pair-consistent (%)", "share"), Column("chance", "Chance level (%)", "share"),
        Column("corrected", "Chance-corrected (%)", "share"),
    )  # fmt: skip
    rows: list[tuple[CellValue, ...]] = [
        (entry.run.label, entry.run.macro, entry.corrected.consistent, entry.corrected.chance, entry.corrected.corrected)
        for entry in known
        if entry.corrected is not None
    ]
    notes = ("All values are macro averages over the categories. The chance level is the mean of the values c of the categories.",)
    return ReportTable("chance_corrected", "Accuracy corrected for chance (%)", columns, tuple(rows), notes)


def _constant_table(known: Sequence[RunChance]) -> ReportTable:
    columns = (
        Column("split", "Split"), Column("tasks", "Tasks", "count"), Column("asked", "Tasks with a reply", "count"),
        Column("agent", "Agent"), Column("answer", "Best constant answer"), Column("correct", "Tasks won", "count"),
        Column("share", "Share (%)", "share"), Column("consistent", "Pair-consistent share (%)", "share"),
    )  # fmt: skip
    rows: dict[tuple[CellValue, ...], None] = {}
    for entry in known:
        level, split = entry.level, entry.run.task_set[1]
        agents = {
            "accepted as an answer": level.accepted, "without a call": level.without_calls,
            "move, look once": level.looking, "move, look once, by category": level.adaptive,
        }  # fmt: skip
        for name, score in agents.items():
            answer = score.answer if score.correct else None
            rows[(split, level.tasks, score.tasks, name, answer, score.correct, score.share, score.consistent_share)] = None
    return ReportTable("constant_answers", "Scores of constant answers", columns, tuple(rows))
