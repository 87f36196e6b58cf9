"""Audit the expected answers with readers who see only pictures: sample questions, and compare the readers' answers.

A reader is a person or a model. Readers receive the instruction and the frames that the reference program observes, under a
question number that does not identify the task. Their answers are parsed and compared with the expected answers.
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
from scope_ptz.taskgen.facts.answer_phrasing import correct_answers

QUESTIONS, ANSWERS, FINDINGS, DRAW = "questions.jsonl", "answers.jsonl", "findings.jsonl", "draw.json"
"""File names in an audit folder."""

Outcome = Literal["agrees", "disagrees", "not readable", "not answered"]


class _Row(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


Row = TypeVar("Row", bound=_Row)


class QuestionDraw(_Row):
    """The parameters with which questions were sampled. The same tasks, number and seed always give the same questions."""

    number: int = Field(ge=1)
    seed: int
    tasks: str
    """SHA-256 digest of all tasks from which the questions were sampled."""


class ReaderAnswer(_Row):
    """One reader's answer to one question."""

    q: Annotated[str, Field(pattern=r"^q\d{3,}$")]
    answer: str
    reader: str = "reader"


class DisagreementNote(_Row):
    """An explanation of why a reader's answer disagrees with the expected answer."""

    q: str
    finding: str


class AuditedAnswer(_Row):
    """A reader's answer to a task, and whether it agrees with the expected answer.

    ``digest`` is the task's ``task_digest`` at the time of the audit. A different digest now means that the task has changed since.
    """

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
    """The published result of an audit."""

    draw: QuestionDraw
    rows: tuple[AuditedAnswer, ...]

    def agreement_counts(self, rows: Iterable[AuditedAnswer] | None = None) -> tuple[int, int]:
        """Return the number of answers that agree and the total number of answers. Unanswered questions are not counted.

        By default, all rows in the audit are counted.
        """
        counted = [row for row in (self.rows if rows is None else rows) if row.outcome != "not answered"]
        return sum(row.outcome == "agrees" for row in counted), len(counted)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON data."""
        agree, total = self.agreement_counts()
        categories = sorted({row.category for row in self.rows})
        by_category = {name: self.agreement_counts(r for r in self.rows if r.category == name) for name in categories}
        return {
            **self.model_dump(mode="json"),
            "agree": agree,
            "of": total,
            "outcomes": dict(Counter(row.outcome for row in self.rows)),
            "by_category": {name: {"agree": correct, "of": number} for name, (correct, number) in by_category.items()},
        }


def draw_questions(tasks: Sequence[Task], number: int, seed: int) -> list[tuple[str, Task]]:
    """Sample questions from the core tasks that have an answer, stratified by category, scene and difficulty.

    Args:
        tasks: The tasks.
        number: Number of questions.
        seed: Seed for the sampling.

    Returns:
        Question numbers with their tasks. The questions are shuffled, so that a number does not identify its task.
    """
    candidates = [task for task in tasks if task.stratum == "core" and not isinstance(task.expected, ActionOnly)]
    chosen = stratified_sample(candidates, number, seed)
    shuffled = sorted(chosen, key=lambda t: hashlib.sha256(f"order:{seed}:{t.id}".encode()).hexdigest())
    return [(f"q{n:03d}", task) for n, task in enumerate(shuffled, 1)]


def task_digest(task: Task) -> str:
    """Return a short digest of a task's instruction and expected answer."""
    return hashlib.sha256(f"{task.instruction}|{task.expected.model_dump_json()}".encode()).hexdigest()[:16]


def score_answers(folder: Path, tasks: Sequence[Task]) -> Audit:
    """Compare the answers in a folder with the tasks from which its questions were sampled.

    Raises:
        InputError: A file is missing or damaged, or the questions were sampled from other tasks.
    """
    (draw,) = _read_rows(folder / DRAW, QuestionDraw)
    if draw.tasks != digest_of(tasks):
        raise InputError(f"The questions in {folder} were sampled from other tasks. Specify those tasks with --tasks.")
    by_question: dict[str, list[ReaderAnswer]] = {}
    for answer in _read_rows(folder / ANSWERS, ReaderAnswer):
        by_question.setdefault(answer.q, []).append(answer)
    findings = {f.q: f.finding for f in _read_rows(folder / FINDINGS, DisagreementNote)} if (folder / FINDINGS).is_file() else {}
    questions = dict(draw_questions(tasks, draw.number, draw.seed))
    if unknown := sorted({*by_question, *findings} - set(questions)):
        raise InputError(
            f"{folder} contains an answer or a finding for {unknown[0]}, which is not one of its questions. Remove it."
        )
    rows = [
        _audit_answer(q, task, answer, findings)
        for q, task in questions.items()
        for answer in by_question.get(q) or [ReaderAnswer(q=q, answer="", reader="")]
    ]
    return Audit(draw=draw, rows=tuple(rows))


def _audit_answer(q: str, task: Task, answer: ReaderAnswer, findings: Mapping[str, str]) -> AuditedAnswer:
    agreed = agrees(task.expected, parse_answer(task.expected, answer.answer)) if answer.answer.strip() else None
    outcome: Outcome = "agrees" if agreed else "disagrees" if agreed is False else "not readable"
    return AuditedAnswer(
        q=q,
        task=task.id,
        digest=task_digest(task),
        category=task.category,
        scene=task.scene,
        instruction=task.instruction,
        expected=correct_answers(task.expected)[0],
        reader=answer.reader,
        answer=answer.answer,
        outcome=outcome if answer.answer.strip() else "not answered",
        finding=findings.get(q, ""),
    )


def read_audit(path: Path) -> Audit:
    """Read a published audit.

    Raises:
        InputError: The file is damaged.
    """
    try:
        content = json.loads(path.read_text("utf-8"))
        return Audit.model_validate({name: content[name] for name in ("draw", "rows")})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} is not a published audit: {error}.") from error


def _read_rows(path: Path, row_type: type[Row]) -> list[Row]:
    """Return the rows of a JSONL file."""
    try:
        lines = path.read_text("utf-8").splitlines()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    rows = []
    for number, line in enumerate(lines, 1):
        try:
            if line.strip():
                rows.append(row_type.model_validate_json(line))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            raise InputError(f"{path}, line {number}: {'.'.join(map(str, first['loc'])) or 'row'}: {first['msg']}.") from error
    return rows
