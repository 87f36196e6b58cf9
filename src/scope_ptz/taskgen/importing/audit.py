"""What is wrong with tasks as tasks: duplicates, contradictions, answers given away, demands that do not fit their words.

Nothing is mended and nothing dropped: a row with such a finding is run like any other, and the report lists it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence

from scope_ptz.bench.answers import plain_words
from scope_ptz.bench.tasks.findings import FindingKind, RowFinding
from scope_ptz.taskgen.importing.rows import RowRead

_NOW = re.compile(
    r"\b(?:right now|at the moment|currently (?:visible|in view|see)|in (?:this|the|your) (?:current )?view|current view)\b",
    re.IGNORECASE,
)
_THEN = re.compile(r"\b(?:then|afterwards?|after that|finally|followed by|once (?:there|done))\b", re.IGNORECASE)
_DEED = r"(?:followed|completed?|executed|performed|finished|done|carried out)"
_ERRAND = r"(?:steps?|instructions?|commands?|tasks?|requests?|actions?|operations?|sequence)"
_ASSERTS_NOTHING = re.compile(
    r"\W*(?:(?:ok(?:ay)?|done|ready|sure|complete|completed|finished|success|successful|successfully)"
    rf"|(?:(?:i|we|the agent|the camera|the system)\W?\s?(?:ve|have|has)? )?(?:successfully )?{_DEED} "
    rf"(?:all |of |the |your |these |those |requested |given |specified |required )*{_ERRAND}"
    r"(?: as [\w ]{0,40}| that [\w ]{0,40}| successfully| in (?:the )?order)?"
    rf"|(?:the |all )*{_ERRAND} (?:has |have |had |was |were |is |are )?(?:been )?(?:all )?(?:successfully )?{_DEED}"
    r"(?: successfully)?)\W*",
    re.IGNORECASE,
)
_QUOTED = re.compile(r"[\"“”'‘]([^\"“”'’]{2,60})[\"“”'’]")
_NUMBERS = {
    word: str(number)
    for number, word in enumerate(
        [
            "zero",
            "one",
            "two",
            "three",
            "four",
            "five",
            "six",
            "seven",
            "eight",
            "nine",
            "ten",
            "eleven",
            "twelve",
            "thirteen",
            "fourteen",
            "fifteen",
            "sixteen",
            "seventeen",
            "eighteen",
            "nineteen",
            "twenty",
        ]
    )
}
_SLIGHT = frozenset("the a an is are it there of in on yes no none not say says read reads i see".split())  # noqa: SIM905
_MOST_ANSWER_WORDS = 6


def audit(rows: Sequence[RowRead]) -> dict[int, tuple[RowFinding, ...]]:
    """Findings by the row's line."""
    found: dict[int, list[RowFinding]] = defaultdict(list)
    for row in rows:
        found[row.line] += _alone(row)
    for line, finding in _together(rows):
        found[line].append(finding)
    return {line: tuple(findings) for line, findings in found.items()}


def _alone(row: RowRead) -> Iterator[RowFinding]:
    """What can be said of a row without the others."""
    if _NOW.search(row.question) and row.sweeps:
        yield _finding("now-but-full")
    if _THEN.search(row.question) and row.order == "any" and len(row.calls) > 1:
        yield _finding("then-unordered", ", ".join(call.tool for call in row.calls))
    if _ASSERTS_NOTHING.fullmatch(row.answer):
        yield _finding("empty-assertion", row.answer)
    if (given := given_away(row.question, row.answer)) is not None:
        yield _finding("answer-in-question", given)
    if row.question and not row.moves and not row.sweeps:
        yield _finding("no-viewpoint-change")


def given_away(question: str, answer: str) -> str | None:
    """The part of the answer that already stands in the question; None when nothing does.

    Looked for are what the answer quotes, and answers of up to six words. Yes and no, and options that a question offers, give
    nothing away.
    """
    if re.search(r"\bor\b", question, re.IGNORECASE):
        return None
    asked = comparable(question)
    candidates: list[str] = _QUOTED.findall(answer)
    words = comparable(answer)
    if 0 < len(words) <= _MOST_ANSWER_WORDS:
        candidates.append(answer)
    for candidate in candidates:
        words = [word for word in comparable(candidate) if word not in _SLIGHT]
        if words and any(asked[at : at + len(words)] == words for at in range(len(asked) - len(words) + 1)):
            return candidate
    return None


def _together(rows: Sequence[RowRead]) -> Iterator[tuple[int, RowFinding]]:
    """What can be said of rows only beside others."""
    by_question: dict[tuple[str, ...], list[RowRead]] = defaultdict(list)
    for row in rows:
        if row.question:
            by_question[tuple(comparable(row.question))].append(row)
    for alike in by_question.values():
        by_view: dict[tuple[str, ...], list[RowRead]] = defaultdict(list)
        for row in alike:
            by_view[row.view].append(row)
        for same in by_view.values():
            yield from _same_view(same)
        if len(by_view) > 1 and len({_told(row.answer) for row in alike}) == 1:
            lines = _lines(alike)
            yield from ((row.line, _finding("same-at-every-preset", lines)) for row in alike)
    for name, same in _by_id(rows).items():
        if len(same) > 1:
            yield from ((row.line, _finding("id-repeated", f"{name}: {_lines(same)}")) for row in same)


def _same_view(rows: Sequence[RowRead]) -> Iterator[tuple[int, RowFinding]]:
    by_answer: dict[tuple[str, ...], list[RowRead]] = defaultdict(list)
    for row in rows:
        by_answer[_told(row.answer)].append(row)
    for same in by_answer.values():
        if len(same) > 1:
            yield from ((row.line, _finding("duplicate", _lines(same))) for row in same)
    if len(by_answer) > 1:
        answers = "; ".join(f"line {same[0].line}: {same[0].answer[:60]}" for same in by_answer.values())
        yield from ((row.line, _finding("contradiction", answers)) for row in rows)


def _by_id(rows: Iterable[RowRead]) -> Mapping[str, list[RowRead]]:
    found: dict[str, list[RowRead]] = defaultdict(list)
    for row in rows:
        if row.row.cells.get("question_id"):
            found[row.row.cells["question_id"]].append(row)
    return found


def _told(answer: str) -> tuple[str, ...]:
    """What an answer says, as far as can be compared without understanding it: its numbers, where it has some, else its words."""
    words = comparable(answer)
    numbers = tuple(sorted(word for word in words if word.replace(".", "", 1).isdigit()))
    return numbers or tuple(words)


def comparable(text: str) -> list[str]:
    """The words of a text whatever their case, spelling and punctuation; numbers in digits."""
    return [_NUMBERS.get(word, word) for word in plain_words(text)]


def _lines(rows: Sequence[RowRead]) -> str:
    return "lines " + ", ".join(str(row.line) for row in rows)


def _finding(kind: FindingKind, detail: str = "") -> RowFinding:
    return RowFinding(kind=kind, detail=detail[:300])
