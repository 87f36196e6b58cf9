"""Show how a dataset is distributed over categories, scenes, viewpoints, difficulty, needs and answers, as tables and charts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence

from scope_ptz.bench.tasks.expected import ActionOnly, NoneThere, Number, Text
from scope_ptz.bench.tasks.task import Task
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers

BAR_CHARS = 30  # length of the longest bar in a chart
MAX_ANSWERS = 6  # maximum number of answers listed per category, the most frequent first

Key = Callable[[Task], str]
_ORDER = {"easy": 1, "medium": 2, "hard": 3}


def cross_table(tasks: Sequence[Task], rows: Key, columns: Key) -> tuple[list[str], list[list[str | int]]]:
    """Return the header and the rows of a table that counts tasks by two keys. The last column and row contain totals."""
    counts = Counter((rows(task), columns(task)) for task in tasks)
    column_names = sorted({column for _, column in counts}, key=lambda name: (_ORDER.get(name, 0), name))
    row_names = list(dict.fromkeys(rows(task) for task in tasks))
    body: list[list[str | int]] = [
        [row, *(counts[row, c] for c in column_names), sum(counts[row, c] for c in column_names)] for row in row_names
    ]
    body.append(["all", *(sum(counts[row, c] for row in row_names) for c in column_names), len(tasks)])
    return ["", *column_names, "all"], body


def value_counts(tasks: Iterable[Task], values_of: Callable[[Task], Iterable[str]]) -> list[tuple[str, int]]:
    """Return the number of tasks with each value, the most frequent value first."""
    return Counter(value for task in tasks for value in values_of(task)).most_common()


def viewpoint(task: Task) -> str:
    """Return the scene and viewpoint of a task's evidence, or of its final pose if it has no evidence.

    The viewpoint is "several" if there is more than one, and "any" if there is none.
    """
    viewpoints = [view.aim.viewpoint for view in task.evidence] or (
        [task.behaviour.final.viewpoint] if task.behaviour.final else []
    )
    names = sorted(set(viewpoints))
    return f"{task.scene} {names[0]}" if len(names) == 1 else f"{task.scene} several" if names else f"{task.scene} any"


def short_answer(task: Task) -> str:
    """Return the correct answer in short form. All actions have the same one, and so do all absences."""
    match task.expected:
        case ActionOnly():
            return "(an action)"
        case NoneThere():
            return "(there is none)"
        case Number():
            return f"{task.expected.value:g}"
        case Text():
            return f"“{task.expected.accepted[0]}”"
    return correct_answers(task.expected)[0].strip(".").lower()


def answer_statistics(tasks: Sequence[Task]) -> Iterator[tuple[str, int, int, list[tuple[str, int]]]]:
    """Yield each category with the number of tasks, the number of different answers, and the most frequent answers."""
    for category in dict.fromkeys(task.category for task in tasks):
        counts = Counter(short_answer(task) for task in tasks if task.category == category)
        yield category, counts.total(), len(counts), counts.most_common(MAX_ANSWERS)


def number_counts(tasks: Iterable[Task]) -> list[tuple[str, int]]:
    """Return the number of tasks with each number as the correct answer. "There is none" counts as 0."""
    counts = Counter(
        round(task.expected.value) if isinstance(task.expected, Number) else 0
        for task in tasks
        if isinstance(task.expected, Number | NoneThere)
    )
    return [(str(number), counts[number]) for number in sorted(counts)]


def pair_count(tasks: Iterable[Task]) -> int:
    """Return the number of tasks with the answer "there is none" that have a twin about a present object."""
    return sum(isinstance(task.expected, NoneThere) and task.pair is not None for task in tasks)


def start_view_count(tasks: Iterable[Task]) -> int:
    """Return the number of tasks that can be answered from the start view."""
    return sum(not task.needs for task in tasks)


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str | int]]) -> str:
    """Return a Markdown table with numbers aligned to the right."""
    body = [list(row) for row in rows]
    right_aligned = [all(isinstance(row[n], int) for row in body) for n in range(len(head))]
    lines = [head, ["--:" if is_right else "---" for is_right in right_aligned], *body]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


def chart(values: Sequence[tuple[str, int]]) -> str:
    """Return a bar chart of the values as text in a code block."""
    maximum, width = max((n for _, n in values), default=0), max((len(name) for name, _ in values), default=0)
    lines = [f"{name:>{width}} {'█' * max(1, round(BAR_CHARS * n / maximum)) if n else ''} {n}" for name, n in values]
    return "\n".join(["```text", *lines, "```"])
