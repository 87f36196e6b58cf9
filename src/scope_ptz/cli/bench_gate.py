"""``scope bench gate``: a non-zero exit code when an evaluation is significantly worse than an earlier one."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import FAILED, complain, ending, put, put_json

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scope_ptz.bench.engine.gate import Comparison, Gate
    from scope_ptz.bench.scoring.trials import Evaluation

MOST_TOLD = 40


def gate(
    log: Annotated[Path, typer.Argument(help="The log of now.")],
    baseline: Annotated[Path, typer.Option("--baseline", help="The log to hold it against.")],
    alpha: Annotated[float, typer.Option(min=1e-6, max=0.5, help="Below which p value a loss counts as one.")] = 0.05,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
) -> None:
    """Compare two logs task by task. Exit code 1 on a significant loss, over all or in a category; 2 if they are not comparable."""
    with ending(as_json=as_json):
        from scope_ptz.bench.engine.gate import gate as hold
        from scope_ptz.bench.engine.logs import read_evaluation
        from scope_ptz.cli.bench_evaluate import need_engine

        need_engine()
        now, before = read_evaluation(log), read_evaluation(baseline)
        found = hold(now, before, alpha)
        if as_json:
            rows = [asdict(found.overall), *(asdict(c) for c in found.categories)]
            put_json({"passed": found.passed, "alpha": alpha, "groups": rows, "left_out": found.left_out}, indent=2)
        else:
            for line in lines(found, now):
                put(line)
        if told := other_judges(now, before):
            complain(told)
        if not found.passed:
            sys.exit(FAILED)


def other_judges(now: Evaluation, before: Evaluation) -> str:
    """What is to be said where different judges decided in the two logs; empty where not."""
    from scope_ptz.bench.judging.deciding_judge import decider_of

    one, two = decider_of(before.trials), decider_of(now.trials)
    if one is None or two is None or one == two:
        return ""
    return f"note: {one} decided in the baseline and {two} does now: what differs may be the judges'."


def lines(found: Gate, now: Evaluation) -> Iterator[str]:
    """The comparison as text: a line a group, then what got worse."""
    yield f"{'':<22}{'tasks':>6}{'before':>10}{'now':>10}{'worse':>7}{'better':>8}{'p':>9}"
    for row in (found.overall, *found.categories):
        yield _row(row, found.alpha)
    reasons = {trial.task.id: trial for trial in now.trials if trial.headline != "correct"}
    for task in found.overall.worse[:MOST_TOLD]:
        trial = reasons.get(task)
        yield f"worse  {task}{f': {trial.reason}' if trial is not None else ''}"
    if len(found.overall.worse) > MOST_TOLD:
        yield f"       and {len(found.overall.worse) - MOST_TOLD} more"
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
