"""Checks across a whole dataset: unique texts, pairs, paraphrases, and fixed answers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers
from scope_ptz.taskgen.validation.validation_report import ValidationFault, ValidationReport

MAX_GUESSED_SHARE = 0.03
"""Maximum fraction of the core tasks that a fixed answer may pass. A task in a pair counts only if both tasks in the pair pass."""

MAX_ADAPTIVE_SHARE = 0.05
"""Maximum fraction of the core tasks that an adaptive agent (see ``adaptive``) may pass."""

MEASURED_ADAPTIVE_SHARES = {"scope1": 0.08}
"""Limits for datasets published before ``MAX_ADAPTIVE_SHARE`` was introduced: their measured fractions, rounded up.

In scope1, the agents that give the first or the last offered option pass 7%, because many questions offer two to four options.
"""

_MIN_TASKS_FOR_SHARE = 300  # the fractions are checked only if there are at least this many core tasks


def structural_faults(tasks: Sequence[Task], dataset: Sequence[Task] = ()) -> list[ValidationFault]:
    """Check that instructions are unique, that twins refer to each other, and that paraphrases have the same expected answer.

    Args:
        tasks: The tasks to check.
        dataset: The whole dataset, if ``tasks`` is a selection from it. It may contain twins and paraphrased tasks.
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
            faults.append(ValidationFault(task.id, "paraphrase", f"{task.paraphrase_of} has a different expected answer"))
    return faults


def sibling_answers(tasks: Sequence[Task]) -> dict[str, str]:
    """Return, by task id, the correct answer to a similar task: the twin, or the next task in the category.

    Only answers that are wrong for the task itself are included.
    """
    by_id = {task.id: task for task in tasks}
    answers = {}
    for index, task in enumerate(tasks):
        if isinstance(task.expected, ActionOnly):
            continue
        twin = by_id.get(task.pair or "")
        later = (*tasks[index + 1 :], *tasks[:index])
        others = [twin] if twin else [t for t in later if t.category == task.category and t.expected.kind == task.expected.kind]
        for other in others:
            text = correct_answers(other.expected)[0]
            if agrees(task.expected, parse_answer(task.expected, text)) is not True:
                answers[task.id] = text
                break
    return answers


def check_guesses(report: ValidationReport, tasks: Sequence[Task]) -> None:
    """Record a fault for each fixed answer that passes both tasks of a pair, or more tasks than ``MAX_GUESSED_SHARE`` allows."""
    twins = {task.id: task.pair for task in tasks}
    core = report.by_stratum["core"]
    for name, ids in report.guessed.items():
        both = sorted(task for task in ids if twins[task] in ids)
        report.faults += [ValidationFault(task, name, f"also passes {twins[task]}") for task in both]
        report.pairs_passed[name] = len(both) + sum(twins[task] is None for task in ids)
        if core >= _MIN_TASKS_FOR_SHARE and report.pairs_passed[name] > MAX_GUESSED_SHARE * core:
            report.faults.append(ValidationFault("all", name, f"passes {report.pairs_passed[name]} of {core} tasks"))


def check_adaptive(report: ValidationReport, tasks: Sequence[Task]) -> None:
    """Record a fault for each adaptive agent that passes both tasks of a pair, or more tasks than ``MAX_ADAPTIVE_SHARE`` allows."""
    twins = {task.id: task.pair for task in tasks}
    core = report.by_stratum["core"]
    limit = max((MEASURED_ADAPTIVE_SHARES.get(task.dataset, MAX_ADAPTIVE_SHARE) for task in tasks), default=MAX_ADAPTIVE_SHARE)
    for name, ids in report.adaptive.items():
        both = sorted(task for task in ids if twins[task] in ids)
        report.faults += [ValidationFault(task, name, f"also passes {twins[task]}") for task in both]
        unpaired = sorted(task for task in ids if twins[task] is None)
        report.adaptive_pairs[name] = len(both) + len(unpaired)
        if core >= _MIN_TASKS_FOR_SHARE and report.adaptive_pairs[name] > limit * core:
            names = ", ".join([*both, *unpaired])
            report.faults.append(ValidationFault("all", name, f"passes {report.adaptive_pairs[name]} of {core} tasks: {names}"))
