"""Select the tasks that an environment uses."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.splits import SPLITS, load_split
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError, UnknownNameError

TaskChoice = str | Task | Sequence[str | Task]
"""A task, a task id, the name of a split, or a sequence of these."""


@cache
def _split(name: str) -> tuple[Task, ...]:
    return load_split(name)


def select_tasks(choice: TaskChoice) -> tuple[Task, ...]:
    """Return the selected tasks.

    Raises:
        InputError: The choice is empty, or a name is neither a task id nor a split.
    """
    parts = [choice] if isinstance(choice, str | Task) else list(choice)
    tasks = tuple(task for part in parts for task in _tasks_of(part))
    if not tasks:
        raise InputError("No task was given. Give the id of a task, or a split such as 'core'.")
    return tasks


def _tasks_of(part: str | Task) -> tuple[Task, ...]:
    if isinstance(part, Task):
        return (part,)
    if not isinstance(part, str):
        raise InputError(f"A task must be an id, the name of a split, or a Task; got {type(part).__name__}.")
    if part in SPLITS:
        return _split(part)
    for split in ("core", "paraphrase", "reaction", "unseen"):
        for task in _split(split):
            if task.id == part:
                return (task,)
    known = [task.id for task in _split("core")]
    message = UnknownNameError("task", part, known)
    close = message.args[0].partition(" Known: ")[0]
    raise InputError(f"{close} scope_ptz.load_tasks() lists the tasks. Splits: {', '.join(SPLITS)}.")


def movement_tasks(choice: TaskChoice = "core") -> tuple[Task, ...]:
    """Return the tasks that can be completed with pan, tilt and zoom alone.

    They require no answer in words, no picture, no other tool and no change of viewpoint.
    """
    return tuple(task for task in select_tasks(choice) if other_requirement(task) is None)


def other_requirement(task: Task) -> str | None:
    """Return the first requirement of a task other than pan, tilt and zoom; None if there is none."""
    behaviour = task.behaviour
    if not isinstance(task.expected, ActionOnly):
        return "an answer in words"
    if "answered" not in behaviour.outcomes:
        return f"the outcome {behaviour.outcomes[0]}"
    if tools := sorted({call.tool for call in behaviour.calls} - {"adjust_ptz"}):
        return f"the tool {tools[0]}"
    if behaviour.pictures:
        return "the tool take_image"
    if "preset" in task.needs or any(call.tool in ("go_to_preset", "go_home") for call in task.reference):
        return "the tool go_to_preset or go_home"
    return None
