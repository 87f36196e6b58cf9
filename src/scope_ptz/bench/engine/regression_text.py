"""Format the comparison of two evaluations as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.engine.regression_gate import Comparison, Gate
from scope_ptz.bench.judging.deciding_judge import decider_of
from scope_ptz.bench.scoring.trials import Evaluation

MAX_TASKS_LISTED = 40


def judge_change_note(now: Evaluation, before: Evaluation) -> str:
    """Return a note if different judges decided in the two logs; otherwise an empty string."""
    one, two = decider_of(before.trials), decider_of(now.trials)
    if one is None or two is None or one == two:
        return ""
    return f"note: {one} decided in the baseline and {two} decides now, so differences may come from the judges."


def comparison_lines(result: Gate, now: Evaluation) -> Iterator[str]:
    """Yield a table with one line per group of tasks, the tasks that became worse, and the result of the gate."""
    yield f"{'':<22}{'tasks':>6}{'before':>10}{'now':>10}{'worse':>7}{'better':>8}{'p':>9}"
    for row in (result.overall, *result.categories):
        yield _row(row, result.alpha)
    reasons = {trial.task.id: trial for trial in now.trials if trial.headline != "correct"}
    for task in result.overall.worse[:MAX_TASKS_LISTED]:
        trial = reasons.get(task)
        yield f"worse  {task}{f': {trial.reason}' if trial is not None else ''}"
    if len(result.overall.worse) > MAX_TASKS_LISTED:
        yield f"       and {len(result.overall.worse) - MAX_TASKS_LISTED} more"
    if result.left_out:
        one = len(result.left_out) == 1
        why = f"because infrastructure broke {'it' if one else 'them'} in one of the logs, or no judge gave a verdict there"
        yield f"{'1 task is' if one else f'{len(result.left_out)} tasks are'} left out, {why}."
    where = ", ".join("over all" if c.group == "all" else c.group.replace("_", " ") for c in result.regressions)
    yield f"REGRESSION: {where} (alpha {result.alpha:g})" if where else f"no significant regression (alpha {result.alpha:g})"


def _row(row: Comparison, alpha: float) -> str:
    name = row.group.replace("_", " ")
    mark = "  regression" if row.regressed(alpha) else ""
    p = f"{row.p:.4f}" if row.p >= 0.0001 else "<0.0001"
    counts = f"{len(row.worse):>7}{len(row.better):>8}"
    return f"{name:<22}{row.tasks:>6}{100 * row.before:>8.1f} %{100 * row.now:>8.1f} %{counts}{p:>9}{mark}"
