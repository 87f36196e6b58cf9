"""How a dataset is spread: over categories, scenes, viewpoints, difficulty, needs, and over the answers that are right."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence

from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number, Text
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import right_answers

BAR = 30
MOST_ANSWERS = 6

Key = Callable[[Task], str]
_ORDER = {"easy": 1, "medium": 2, "hard": 3}


def crossed(tasks: Sequence[Task], rows: Key, columns: Key) -> tuple[list[str], list[list[str | int]]]:
    """A table of counts with sums: its head, and its rows, the last of which is the sum."""
    counts = Counter((rows(task), columns(task)) for task in tasks)
    across = sorted({column for _, column in counts}, key=lambda name: (_ORDER.get(name, 0), name))
    down = list(dict.fromkeys(rows(task) for task in tasks))
    body: list[list[str | int]] = [[row, *(counts[row, c] for c in across), sum(counts[row, c] for c in across)] for row in down]
    body.append(["all", *(sum(counts[row, c] for row in down) for c in across), len(tasks)])
    return ["", *across, "all"], body


def spread(tasks: Iterable[Task], of: Callable[[Task], Iterable[str]]) -> list[tuple[str, int]]:
    """How many tasks have each of some values, most first."""
    return Counter(value for task in tasks for value in of(task)).most_common()


def viewpoint(task: Task) -> str:
    """The optical centre that the answer rests on, "several" when there is more than one; where the camera ends else."""
    aims = [view.aim.viewpoint for view in task.evidence] or ([task.behaviour.final.viewpoint] if task.behaviour.final else [])
    names = sorted(set(aims))
    return f"{task.scene} {names[0]}" if len(names) == 1 else f"{task.scene} several" if names else f"{task.scene} any"


def answer(task: Task) -> str:
    """The right answer, short; the same for all that want none, or say that there is none."""
    match task.expected:
        case ActionOnly():
            return "(an action)"
        case NoneThere():
            return "(there is none)"
        case Number():
            return f"{task.expected.value:g}"
        case Text():
            return f"“{task.expected.accepted[0]}”"
    return right_answers(task.expected)[0].strip(".").lower()


def answers(tasks: Sequence[Task]) -> Iterator[tuple[str, int, int, list[tuple[str, int]]]]:
    """Of each category its name, its size, how many different answers it has, and the most frequent ones."""
    for category in dict.fromkeys(task.category for task in tasks):
        counts = Counter(answer(task) for task in tasks if task.category == category)
        yield category, counts.total(), len(counts), counts.most_common(MOST_ANSWERS)


def numbers(tasks: Iterable[Task]) -> list[tuple[str, int]]:
    """How often each number is the right answer; "there is none" counts as 0."""
    counts = Counter(
        round(task.expected.value) if isinstance(task.expected, Number) else 0
        for task in tasks
        if isinstance(task.expected, Number | NoneThere)
    )
    return [(str(number), counts[number]) for number in sorted(counts)]


def pairs(tasks: Iterable[Task]) -> int:
    """How many tasks say that there is none and stand beside one of like wording that says that there is."""
    return sum(isinstance(task.expected, NoneThere) and task.pair is not None for task in tasks)


def from_start(tasks: Iterable[Task]) -> int:
    """How many tasks need neither a move nor a zoom nor a sweep."""
    return sum(not task.needs for task in tasks)


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str | int]]) -> str:
    """A Markdown table; numbers stand to the right."""
    body = [list(row) for row in rows]
    right = [all(isinstance(row[n], int) for row in body) for n in range(len(head))]
    lines = [head, ["--:" if r else "---" for r in right], *body]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


def chart(values: Sequence[tuple[str, int]]) -> str:
    """Values as bars of text, in a code block."""
    most, width = max((n for _, n in values), default=0), max((len(name) for name, _ in values), default=0)
    lines = [f"{name:>{width}} {'█' * max(1, round(BAR * n / most)) if n else ''} {n}" for name, n in values]
    return "\n".join(["```text", *lines, "```"])
