"""Tool evidence: what the tools reported in a run, and whether this supports the final answer."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from scope_ptz.bench.answers import (
    TEXT_SEPARATOR,
    ParsedValue,
    all_wordings,
    is_stated,
    names_any,
    normalized_text,
    numbers_in,
    parse_answer,
)
from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.tasks.expected import (
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Text,
    YesNo,
)
from scope_ptz.bench.tasks.task import Task

_MAX_COUNTS = 8
"""Maximum number of counts for which sums are computed. Later counts in a run are ignored in sums."""


def text_from_tools(episode: Episode) -> str:
    """Return everything that the tools reported, joined into one text."""
    parts = list[str]()
    for call in episode.calls:
        if call.succeeded and call.result is not None:
            parts += [str(call.result[key]) for key in ("message", "answer", "chosen", "count", "presets") if key in call.result]
    return "\n".join(parts)


def numbers_from_tools(episode: Episode) -> set[float]:
    """Return the reported numbers, the sums and differences of reported counts, and the number of counts above zero."""
    counts, other_numbers = list[float](), set[float]()
    for call in episode.calls:
        result = call.result or {}
        if not call.succeeded:
            continue
        if "count" in result:
            counts.append(float(result["count"]))
        if "matches" in result:
            other_numbers.add(float(result["matches"]))
        if "answer" in result:
            other_numbers |= numbers_in(str(result["answer"]))
            if parse_answer(NoneThere(subject=("thing",)), str(result["answer"])) == ParsedValue(True):
                other_numbers.add(0.0)
    sums = {sum(c) for n in range(1, min(len(counts), _MAX_COUNTS) + 1) for c in combinations(counts[:_MAX_COUNTS], n)}
    return other_numbers | sums | {abs(a - b) for a, b in combinations(counts, 2)} | {float(sum(c > 0 for c in counts))}


def is_supported_by_tools(task: Task, episode: Episode) -> bool:
    """Return whether the answer follows from the tool results.

    Denials and comparisons are conclusions, so no tool needs to report them.
    """
    parsed = parse_answer(task.expected, episode.answer)
    if not isinstance(parsed, ParsedValue):
        return True
    value, reported = parsed.value, text_from_tools(episode)
    match task.expected:
        case Number():
            return value in numbers_from_tools(episode)
        case Text():
            reported_text = normalized_text(reported, ocr=task.expected.ocr)
            return all(normalized_text(part, ocr=task.expected.ocr) in reported_text for part in str(value).split(TEXT_SEPARATOR))
        case Choice():
            wordings = all_wordings(str(value), task.expected.options[str(value)]) if value != "same" else ()
            has_several_items = any(len(view.items) > 1 for view in task.evidence)
            return not wordings or (_is_reported(episode, wordings) if has_several_items else names_any(reported, wordings))
        case NameSet():
            named = value if isinstance(value, frozenset) else frozenset()
            return all(_is_reported_present(episode, all_wordings(name, task.expected.options[name])) for name in named)
        case YesNo() | NoneThere():
            claims_presence = value == isinstance(task.expected, YesNo)
            return not claims_presence or _is_presence_reported(task, episode)
        case Description():
            return _are_contradictions_reported(task.expected, value, reported)
        case _:
            return True


def _is_reported(episode: Episode, wordings: Sequence[str]) -> bool:
    """Return whether the tools reported on a thing: its presence, or a count (even zero)."""
    descriptions = (str(c.arguments.get("description", "")) for c in episode.calls if c.succeeded and "count" in (c.result or {}))
    return _is_reported_present(episode, wordings) or any(names_any(description, wordings) for description in descriptions)


def _is_reported_present(episode: Episode, wordings: Sequence[str]) -> bool:
    """Return whether a tool reported that a thing is present.

    A tool reports presence by counting at least one thing, finding it, naming it without denying it, or answering yes.
    """
    for call in episode.calls:
        result = call.result or {}
        if not call.succeeded:
            continue
        asked = " ".join(str(call.arguments.get(key, "")) for key in ("description", "question"))
        answer, chosen = str(result.get("answer", "")), str(result.get("chosen", ""))
        if is_stated(answer, wordings) or names_any(chosen, wordings):
            return True
        is_positive = bool(result.get("count") or result.get("found")) or (
            parse_answer(YesNo(value=True), answer) == ParsedValue(True)
        )
        if is_positive and names_any(asked, wordings):
            return True
    return False


def _is_presence_reported(task: Task, episode: Episode) -> bool:
    """Return whether a tool reported a presence that supports a positive answer."""
    for call in episode.calls:
        result = call.result or {}
        if call.succeeded and (result.get("count", 0) or result.get("found") or _answers_yes(task.expected, result.get("answer"))):
            return True
    return False


def _answers_yes(expected: AnyExpected, answer: object) -> bool:
    if not isinstance(answer, str):
        return False
    return parse_answer(expected, answer) == ParsedValue(isinstance(expected, YesNo))


def _are_contradictions_reported(expected: Description, value: object, reported: str) -> bool:
    stated = value[1] if isinstance(value, tuple) else frozenset()
    return all(names_any(reported, expected.contradictions[n].any_of) for n in stated if isinstance(n, int))
