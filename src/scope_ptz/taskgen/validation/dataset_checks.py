"""Checks between the tasks of a dataset: unique texts, pairs, paraphrases, and answers to similar tasks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.validation.validation_report import ValidationFault, ValidationReport

MOST_GUESSED_SHARE = 0.03
"""Largest share of the core tasks that a fixed answer may pass, where both tasks of a pair must pass to count."""

_FEWEST_FOR_SHARES = 300  # with fewer core tasks, such a share is not checked


def structure(tasks: Sequence[Task], dataset: Sequence[Task] = ()) -> list[ValidationFault]:
    """Check that no text occurs twice, that twins refer to each other, and that paraphrases expect what their task expects.

    Args:
        tasks: The tasks to check.
        dataset: The dataset that the tasks are a selection of. Twins and paraphrased tasks may be there.
    """
    faults = []
    by_id = {task.id: task for task in (*dataset, *tasks)}
    texts = Counter((task.world, task.preset, task.instruction.lower()) for task in tasks)
    for task in tasks:
        if texts[(task.world, task.preset, task.instruction.lower())] > 1:
            faults.append(ValidationFault(task.id, "text", "another task has the same instruction"))
        if task.pair is not None and (task.pair not in by_id or by_id[task.pair].pair != task.id):
            faults.append(ValidationFault(task.id, "pair", f"{task.pair} is not its twin"))
        if (
            task.paraphrase_of is not None
            and (original := by_id.get(task.paraphrase_of)) is not None
            and original.expected != task.expected
        ):
            faults.append(ValidationFault(task.id, "paraphrase", f"{task.paraphrase_of} has another expected answer"))
    return faults


def sibling_answers(tasks: Sequence[Task]) -> dict[str, str]:
    """Return, by task id, the right answer to a similar task with another answer: the twin, or the next task of its category."""
    by_id = {task.id: task for task in tasks}
    found = {}
    for at, task in enumerate(tasks):
        if isinstance(task.expected, ActionOnly):
            continue
        twin = by_id.get(task.pair or "")
        later = (*tasks[at + 1 :], *tasks[:at])
        others = [twin] if twin else [t for t in later if t.category == task.category and t.expected.kind == task.expected.kind]
        for other in others:
            text = correct_answers(other.expected)[0]
            if agrees(task.expected, parse_answer(task.expected, text)) is not True:
                found[task.id] = text
                break
    return found


def check_guesses(report: ValidationReport, tasks: Sequence[Task]) -> None:
    """Record a fault where a fixed answer passes both tasks of a pair, or too many tasks."""
    twins = {task.id: task.pair for task in tasks}
    core = report.by_stratum["core"]
    for name, ids in report.guessed.items():
        both = sorted(task for task in ids if twins[task] in ids)
        report.faults += [ValidationFault(task, name, f"also passes {twins[task]}") for task in both]
        report.pairs_passed[name] = len(both) + sum(twins[task] is None for task in ids)
        if core >= _FEWEST_FOR_SHARES and report.pairs_passed[name] > MOST_GUESSED_SHARE * core:
            report.faults.append(ValidationFault("all", name, f"passes {report.pairs_passed[name]} of {core} tasks"))
