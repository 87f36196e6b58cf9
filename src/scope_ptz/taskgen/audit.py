"""An audit by readers who see pictures only: which tasks they are asked, what they are given, and how often they agree.

Readers get the frames that the reference program looks at and the words of the task, under numbers that say nothing. What they
answer is read by the deterministic reader and held against the expected value.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.answers import agrees, parse_answer
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.files import digest_of
from scope_ptz.bench.tasks.stratified import stratified_sample
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import InputError
from scope_ptz.taskgen.facts.phrasing import right_answers

QUESTIONS, ANSWERS, FINDINGS, DRAW = "questions.jsonl", "answers.jsonl", "findings.jsonl", "draw.json"
Outcome = Literal["agrees", "disagrees", "not readable", "not answered"]


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


Row = TypeVar("Row", bound=_Row)


class Draw(_Row):
    """How questions were drawn, without what they are: who has the same tasks can draw them again."""

    number: int = Field(ge=1)
    seed: int
    tasks: str
    """SHA-256 of all tasks that were drawn from."""


class Answer(_Row):
    """One reader's answer to one question."""

    q: Annotated[str, Field(pattern=r"^q\d{3,}$")]
    answer: str
    reader: str = "reader"


class Finding(_Row):
    """What looking into a disagreement showed."""

    q: str
    finding: str


class Held(_Row):
    """An answer held against its task. ``digest``: of words and expected value, which tells whether the task was mended since."""

    q: str
    task: str
    digest: str
    category: str
    scene: str
    instruction: str
    expected: str
    reader: str
    answer: str
    outcome: Outcome
    finding: str = ""


class Audit(_Row):
    """The result, as it is published."""

    draw: Draw
    rows: tuple[Held, ...]

    def share(self, rows: Iterable[Held] | None = None) -> tuple[int, int]:
        """How many answers agree, of how many. What nobody answered is neither for a task nor against it."""
        counted = [row for row in (self.rows if rows is None else rows) if row.outcome != "not answered"]
        return sum(row.outcome == "agrees" for row in counted), len(counted)

    def as_dict(self) -> dict[str, Any]:
        right, of = self.share()
        categories = sorted({row.category for row in self.rows})
        by_category = {name: self.share(r for r in self.rows if r.category == name) for name in categories}
        return {
            **self.model_dump(mode="json"),
            "agree": right,
            "of": of,
            "outcomes": dict(Counter(row.outcome for row in self.rows)),
            "by_category": {name: {"agree": agree, "of": total} for name, (agree, total) in by_category.items()},
        }


def drawn(tasks: Sequence[Task], number: int, seed: int) -> list[tuple[str, Task]]:
    """Numbers and tasks that want an answer, by category, scene and difficulty; the numbers follow no order of the tasks."""
    wanted = [task for task in tasks if task.stratum == "core" and not isinstance(task.expected, ActionOnly)]
    chosen = stratified_sample(wanted, number, seed)
    mixed = sorted(chosen, key=lambda t: hashlib.sha256(f"order:{seed}:{t.id}".encode()).hexdigest())
    return [(f"q{n:03d}", task) for n, task in enumerate(mixed, 1)]


def task_digest(task: Task) -> str:
    """Short digest of what a task asks and expects."""
    return hashlib.sha256(f"{task.instruction}|{task.expected.model_dump_json()}".encode()).hexdigest()[:16]


def score(folder: Path, tasks: Sequence[Task]) -> Audit:
    """Hold the answers in a folder against the tasks that its questions were drawn from.

    Raises:
        InputError: a file is missing or damaged, or the tasks are not those that were drawn from.
    """
    (draw,) = _rows(folder / DRAW, Draw)
    if draw.tasks != digest_of(tasks):
        raise InputError(f"The questions in {folder} were drawn from other tasks. Name those with --tasks.")
    given: dict[str, list[Answer]] = {}
    for answer in _rows(folder / ANSWERS, Answer):
        given.setdefault(answer.q, []).append(answer)
    findings = {f.q: f.finding for f in _rows(folder / FINDINGS, Finding)} if (folder / FINDINGS).is_file() else {}
    questions = dict(drawn(tasks, draw.number, draw.seed))
    if unknown := sorted({*given, *findings} - set(questions)):
        raise InputError(f"{folder} holds an answer to {unknown[0]}, which was not asked.")
    rows = [
        _held(q, task, answer, findings)
        for q, task in questions.items()
        for answer in given.get(q) or [Answer(q=q, answer="", reader="")]
    ]
    return Audit(draw=draw, rows=tuple(rows))


def _held(q: str, task: Task, answer: Answer, findings: Mapping[str, str]) -> Held:
    agreed = agrees(task.expected, parse_answer(task.expected, answer.answer)) if answer.answer.strip() else None
    outcome: Outcome = "agrees" if agreed else "disagrees" if agreed is False else "not readable"
    return Held(
        q=q,
        task=task.id,
        digest=task_digest(task),
        category=task.category,
        scene=task.scene,
        instruction=task.instruction,
        expected=right_answers(task.expected)[0],
        reader=answer.reader,
        answer=answer.answer,
        outcome=outcome if answer.answer.strip() else "not answered",
        finding=findings.get(q, ""),
    )


def read_audit(path: Path) -> Audit:
    """A published audit. Raises ``InputError`` when it is damaged."""
    try:
        content = json.loads(path.read_text("utf-8"))
        return Audit.model_validate({name: content[name] for name in ("draw", "rows")})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} holds no audit: {error}.") from error


def _rows(path: Path, kind: type[Row]) -> list[Row]:
    """The rows of a JSONL file."""
    try:
        lines = path.read_text("utf-8").splitlines()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            if line.strip():
                rows.append(kind.model_validate_json(line))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise InputError(f"{path}, line {number}: {'.'.join(map(str, first['loc'])) or 'row'}: {first['msg']}.") from error
    return rows
