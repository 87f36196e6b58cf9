"""Other words for the same command give the same plan."""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from tests.planner.lots import FILES, Row, planned, rows, verdict

_ROWS = 40  # instructions to which a change of wording is applied
_MIN_SHARE = 0.85  # of those with the expected plan; some changes are odd English in some instructions


def words(pattern: str, replacement: str) -> Callable[[str], str]:
    """Return a function that replaces the words that a pattern matches, whatever their case."""
    return lambda text: re.sub(pattern, replacement, text, flags=re.IGNORECASE)


def opened_with(words_first: str) -> Callable[[str], str]:
    """Return a function that puts words before an instruction that begins with a verb."""
    return words(r"\A(?=(pan|tilt|zoom|go|take|turn|look|count|show|find|swing|point|follow) )", f"{words_first} ")


CHANGES: dict[str, Callable[[str], str]] = {
    "lower case": str.lower,
    "capitals": str.upper,
    "could you": opened_with("could you please"),
    "I want you to": opened_with("I want you to"),
    "thanks": lambda text: re.sub(r"[.!]*$", ", thanks", text),
    "no degrees": words(r"(?<=\d) degrees?\b", ""),
    "no articles": words(r"\b(the|a|an) (?=[a-z])(?!(?:lot|bit|little|touch|hair|time|half|single)\b)", ""),
    "ampersand": words(r"\band\b", "&"),
    "semicolons": words(r",? (and )?then ", "; "),
    "sentences": words(r",? and then ", ". Then "),
    "head over to": words(r"\bgo to\b", "head over to"),
    "let me see": words(r"\bshow me\b", "let me see"),
    "I want to see": words(r"\bshow me\b", "I want to see"),
    "report": words(r"\btell me\b", "report"),
    "return": words(r"\bgo back\b", "return"),
    "otherwise": words(r"\botherwise\b", "else"),
    "swing": words(r"\bpan (?=left|right)", "swing "),
    "get closer": words(r"(?<!max )(?<!full )(?<!maximum )\bzoom in\b(?! on| to)(?!.*\bzoom\b)", "get closer"),
    "till": words(r"\buntil\b", "till"),
    "curly apostrophes": lambda text: text.replace("'", "’"),
}


def changed(row: Row, name: str) -> Row | None:
    """Return a row in other words; None if they are the same. Without articles, descriptions are expected without them, too."""
    change = CHANGES[name]
    text = change(row.instruction)
    calls = tuple(with_changed_texts(call, change) for call in row.calls) if name == "no articles" else row.calls
    return replace(row, instruction=text, calls=calls) if row.understood and text != row.instruction else None


def with_changed_texts(call: dict[str, Any], change: Callable[[str], str]) -> dict[str, Any]:
    """Return an expected call with its texts in other words."""
    arguments = call.get("arguments", {})
    texts = {name: change(value) for name, value in arguments.items() if isinstance(value, str) and name != "name"}
    return {**call, "arguments": {**arguments, **texts}} if texts else call


@pytest.mark.parametrize("name", [*(pytest.param(n, marks=pytest.mark.full) for n in list(CHANGES)[1::2]), *list(CHANGES)[::2]])
def test_other_words_give_the_same_plan(name: str) -> None:
    every = [(row, other) for lot in FILES for row in rows(lot, "dev") if (other := changed(row, name)) is not None]
    sample = random.Random(name).sample(every, min(_ROWS, len(every)))
    pairs = [other for row, other in sample if verdict(row, planned(row)) == "right"]
    found = Counter(verdict(other, planned(other)) for other in pairs)
    assert len(pairs) > 5
    assert found["wrong move"] == 0, [other.instruction for other in pairs if verdict(other, planned(other)) == "wrong move"]
    assert found["right"] >= _MIN_SHARE * found.total(), found
