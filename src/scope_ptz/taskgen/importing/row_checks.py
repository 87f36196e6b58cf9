"""Find questionable rows: duplicates, contradictions, and questions that give away the answer or contradict other cells.

No row is changed or omitted. Questionable rows are imported like any other, and the report lists the findings about them.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence

from scope_ptz.bench.answers import plain_words
from scope_ptz.bench.tasks.findings import FindingKind, RowFinding
from scope_ptz.taskgen.facts.answer_phrasing import number_in_words
from scope_ptz.taskgen.importing.row_reading import ParsedRow

_NOW = re.compile(
    r"\b(?:right now|at the moment|currently (?:visible|in view|see)|in (?:this|the|your) (?:current )?view|current view)\b",
    re.IGNORECASE,
)
_THEN = re.compile(r"\b(?:then|afterwards?|after that|finally|followed by|once (?:there|done))\b", re.IGNORECASE)
_DONE = r"(?:followed|completed?|executed|performed|finished|done|carried out)"
_WORK = r"(?:steps?|instructions?|commands?|tasks?|requests?|actions?|operations?|sequence)"
_VACUOUS_ANSWER = re.compile(
    r"\W*(?:(?:ok(?:ay)?|done|ready|sure|complete|completed|finished|success|successful|successfully)"
    rf"|(?:(?:i|we|the agent|the camera|the system)\W?\s?(?:ve|have|has)? )?(?:successfully )?{_DONE} "
    rf"(?:all |of |the |your |these |those |requested |given |specified |required )*{_WORK}"
    r"(?: as [\w ]{0,40}| that [\w ]{0,40}| successfully| in (?:the )?order)?"
    rf"|(?:the |all )*{_WORK} (?:has |have |had |was |were |is |are )?(?:been )?(?:all )?(?:successfully )?{_DONE}"
    r"(?: successfully)?)\W*",
    re.IGNORECASE,
)
"""Expected answers that assert nothing about the scene, such as "All steps have been completed"."""

_QUOTED = re.compile(r"[\"“”'‘]([^\"“”'’]{2,60})[\"“”'’]")
_NUMBERS = {number_in_words(number): str(number) for number in range(21)}
_UNINFORMATIVE_WORDS = frozenset("the a an is are it there of in on yes no none not say says read reads i see".split())  # noqa: SIM905
_MAX_ANSWER_WORDS = 6


def check_rows(rows: Sequence[ParsedRow]) -> dict[int, tuple[RowFinding, ...]]:
    """Return the findings about questionable rows, by line number."""
    by_line: dict[int, list[RowFinding]] = defaultdict(list)
    for row in rows:
        by_line[row.line] += _single_row_findings(row)
    for line, finding in _row_group_findings(rows):
        by_line[line].append(finding)
    return {line: tuple(findings) for line, findings in by_line.items()}


def _single_row_findings(row: ParsedRow) -> Iterator[RowFinding]:
    """Yield the findings that concern a single row."""
    if _NOW.search(row.question) and row.sweeps:
        yield _finding("now-but-full")
    if _THEN.search(row.question) and row.order == "any" and len(row.calls) > 1:
        yield _finding("then-unordered", ", ".join(call.tool for call in row.calls))
    if _VACUOUS_ANSWER.fullmatch(row.answer):
        yield _finding("empty-assertion", row.answer)
    if (part := answer_in_question(row.question, row.answer)) is not None:
        yield _finding("answer-in-question", part)
    if row.question and not row.moves and not row.sweeps:
        yield _finding("no-viewpoint-change")


def answer_in_question(question: str, answer: str) -> str | None:
    """Return the part of the answer that is already in the question; None if there is none.

    The check covers quoted parts of the answer, and whole answers of up to six words. Answers such as "yes" and "no" are ignored,
    and so are questions that offer options.
    """
    if re.search(r"\bor\b", question, re.IGNORECASE):
        return None
    question_words = normalised_words(question)
    candidates: list[str] = _QUOTED.findall(answer)
    words = normalised_words(answer)
    if 0 < len(words) <= _MAX_ANSWER_WORDS:
        candidates.append(answer)
    for candidate in candidates:
        words = [word for word in normalised_words(candidate) if word not in _UNINFORMATIVE_WORDS]
        if words and any(
            question_words[index : index + len(words)] == words for index in range(len(question_words) - len(words) + 1)
        ):
            return candidate
    return None


def _row_group_findings(rows: Sequence[ParsedRow]) -> Iterator[tuple[int, RowFinding]]:
    """Yield the line number and the finding for every row that contradicts or repeats other rows."""
    by_question: dict[tuple[str, ...], list[ParsedRow]] = defaultdict(list)
    for row in rows:
        if row.question:
            by_question[tuple(normalised_words(row.question))].append(row)
    for same_question in by_question.values():
        by_view: dict[tuple[str, ...], list[ParsedRow]] = defaultdict(list)
        for row in same_question:
            by_view[row.view].append(row)
        for same_rows in by_view.values():
            yield from _same_view_findings(same_rows)
        if len(by_view) > 1 and len({_answer_key(row.answer) for row in same_question}) == 1:
            lines = _line_list(same_question)
            yield from ((row.line, _finding("same-at-every-preset", lines)) for row in same_question)
    for name, same_rows in _group_by_id(rows).items():
        if len(same_rows) > 1:
            yield from ((row.line, _finding("id-repeated", f"{name}: {_line_list(same_rows)}")) for row in same_rows)


def _same_view_findings(rows: Sequence[ParsedRow]) -> Iterator[tuple[int, RowFinding]]:
    by_answer: dict[tuple[str, ...], list[ParsedRow]] = defaultdict(list)
    for row in rows:
        by_answer[_answer_key(row.answer)].append(row)
    for same_rows in by_answer.values():
        if len(same_rows) > 1:
            yield from ((row.line, _finding("duplicate", _line_list(same_rows))) for row in same_rows)
    if len(by_answer) > 1:
        answers = "; ".join(f"line {same_rows[0].line}: {same_rows[0].answer[:60]}" for same_rows in by_answer.values())
        yield from ((row.line, _finding("contradiction", answers)) for row in rows)


def _group_by_id(rows: Iterable[ParsedRow]) -> Mapping[str, list[ParsedRow]]:
    by_id: dict[str, list[ParsedRow]] = defaultdict(list)
    for row in rows:
        if row.row.cells.get("question_id"):
            by_id[row.row.cells["question_id"]].append(row)
    return by_id


def _answer_key(answer: str) -> tuple[str, ...]:
    """Return a key for comparing answers: the numbers in the answer, or its words if it contains no number."""
    words = normalised_words(answer)
    numbers = tuple(sorted(word for word in words if word.replace(".", "", 1).isdigit()))
    return numbers or tuple(words)


def normalised_words(text: str) -> list[str]:
    """Return the words of text with normalised case, spelling and punctuation, and with numbers as digits."""
    return [_NUMBERS.get(word, word) for word in plain_words(text)]


def _line_list(rows: Sequence[ParsedRow]) -> str:
    return "lines " + ", ".join(str(row.line) for row in rows)


def _finding(kind: FindingKind, detail: str = "") -> RowFinding:
    return RowFinding(kind=kind, detail=detail[:300])
