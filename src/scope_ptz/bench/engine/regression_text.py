"""A comparison of two evaluations, as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.engine.regression_gate import Comparison, Gate
from scope_ptz.bench.judging.deciding_judge import decider_of
from scope_ptz.bench.scoring.trials import Evaluation

MAX_TASKS_LISTED = 40


def judge_change_note(now: Evaluation, before: Evaluation) -> str:
    """Return a note where different judges decided in the two logs; empty if they did not."""
    one, two = decider_of(before.trials), decider_of(now.trials)
    if one is None or two is None or one == two:
        return ""
    return f"note: {one} decided in the baseline and {two} decides now, so differences may come from the judges."


def comparison_lines(found: Gate, now: Evaluation) -> Iterator[str]:
    """Return one line for each group of tasks, then the tasks that got worse."""
    yield f"{'':<22}{'tasks':>6}{'before':>10}{'now':>10}{'worse':>7}{'better':>8}{'p':>9}"
    for row in (found.overall, *found.categories):
        yield _row(row, found.alpha)
    reasons = {trial.task.id: trial for trial in now.trials if trial.headline != "correct"}
    for task in found.overall.worse[:MAX_TASKS_LISTED]:
        trial = reasons.get(task)
        yield f"worse  {task}{f': {trial.reason}' if trial is not None else ''}"
    if len(found.overall.worse) > MAX_TASKS_LISTED:
        yield f"       and {len(found.overall.worse) - MAX_TASKS_LISTED} more"
    if found.left_out:
        one = len(found.left_out) == 1
        why = f"because infrastructure broke {'it' if one else 'them'} in one of the logs, or no judge gave a verdict there"
        yield f"{'1 task is' if one else f'{len(found.left_out)} tasks are'} left out, {why}."
    where = ", ".join("over all" if c.group == "all" else c.group.replace("_", " ") for c in found.regressions)
    yield f"REGRESSION: {where} (alpha {found.alpha:g})" if where else f"no significant regression (alpha {found.alpha:g})"


def _row(row: Comparison, alpha: float) -> str:
    name = row.group.replace("_", " ")
    mark = "  regression" if row.regressed(alpha) else ""
    p = f"{row.p:.4f}" if row.p >= 0.0001 else "<0.0001"
    counts = f"{len(row.worse):>7}{len(row.better):>8}"
    return f"{name:<22}{row.tasks:>6}{100 * row.before:>8.1f} %{100 * row.now:>8.1f} %{counts}{p:>9}{mark}"
