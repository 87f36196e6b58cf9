"""Format a comparison of two evaluations as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.engine.regression.gate import Comparison, GateResult
from scope_ptz.bench.judging.deciding_judge import reported_judge
from scope_ptz.bench.scoring.trials import Evaluation

MAX_TASKS_LISTED = 40
"""Maximum number of worse tasks to list."""


def judge_change_note(now: Evaluation, before: Evaluation) -> str:
    """Return a note if the deciding judges of the two logs differ; otherwise an empty string."""
    old_judge, new_judge = reported_judge(before.trials), reported_judge(now.trials)
    if old_judge is None or new_judge is None or old_judge == new_judge:
        return ""
    return (
        f"note: the deciding judge is {old_judge} in the baseline and {new_judge} in the log, so the judges may cause differences."
    )


def comparison_lines(result: GateResult, now: Evaluation) -> Iterator[str]:
    """Yield the lines of a table with task groups, the tasks that became worse, and the result of the gate."""
    yield f"{'':<22}{'tasks':>6}{'before':>10}{'now':>10}{'worse':>7}{'better':>8}{'p':>9}"
    for row in (result.overall, *result.categories):
        yield _row(row, result.alpha)
    failed_trials = {trial.task.id: trial for trial in now.trials if trial.headline != "correct"}
    for task in result.overall.worse[:MAX_TASKS_LISTED]:
        trial = failed_trials.get(task)
        yield f"worse  {task}{f': {trial.reason}' if trial is not None else ''}"
    if len(result.overall.worse) > MAX_TASKS_LISTED:
        yield f"       and {len(result.overall.worse) - MAX_TASKS_LISTED} more"
    if result.unscored_tasks:
        tasks = "1 task is" if len(result.unscored_tasks) == 1 else f"{len(result.unscored_tasks)} tasks are"
        yield f"{tasks} left out, because in one of the logs infrastructure broke the runs or no judge gave a verdict."
    groups = ", ".join("over all" if c.group == "all" else c.group.replace("_", " ") for c in result.regressions)
    yield f"REGRESSION: {groups} (alpha {result.alpha:g})" if groups else f"no significant regression (alpha {result.alpha:g})"


def _row(row: Comparison, alpha: float) -> str:
    name = row.group.replace("_", " ")
    mark = "  regression" if row.regressed(alpha) else ""
    p = f"{row.p:.4f}" if row.p >= 0.0001 else "<0.0001"
    counts = f"{len(row.worse):>7}{len(row.better):>8}"
    return f"{name:<22}{row.tasks:>6}{100 * row.before:>8.1f} %{100 * row.now:>8.1f} %{counts}{p:>9}{mark}"
