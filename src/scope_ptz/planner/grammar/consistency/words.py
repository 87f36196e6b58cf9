"""Split an instruction into words for the check of its plan. The rules are deliberately simple and independent of the lexer."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.spelling import corrected_word

_WORD = re.compile(r"(?<![\w./])\d+/\d+(?![\w/])|[-+−]?\d+(?:\.\d+)?|\.\d+|[^\W\d_]+|[,;:.!?()\n&]|->|→|[–—]")
_NEGATING = frozenset(
    {
        "not",
        "dont",
        "never",
        "without",
        "no",
        "avoid",
        "cannot",
        "instead",
        "because",
        "cos",
        "since",
        "except",
        "excluding",
        "leave",
    }
)
"""Words that begin a clause about what not to do, or about a reason."""

REPAIRING = frozenset({
    "no", "nah", "naw", "nope", "sorry", "wait", "oops", "er", "erm", "actually", "rather", "mean", "meant", "make", "correction",
    "scratch", "scrap", "strike", "belay", "cancel", "forget", "disregard", "negative", "instead", "skip", "drop", "leave",
    "thoughts", "excuse", "pardon", "apologise", "apologize", "hang", "hold", "except", "exc", "mistake", "wrong", "ignore",
    "other",
})  # fmt: skip
"""Words after which a speaker repairs, or takes back, what was said before them."""

_BREAKS = frozenset(",;:.!?()\n&→–—") | {"->", "and", "then", "but", "or", "so", "just"}

_ASKING = frozenset({"could", "can", "would", "will"})
"""Words that begin a request if "you" follows: "if it is not too much bother could you ..."."""


@dataclass(slots=True)
class Word:
    """A word or punctuation mark of an instruction.

    Attributes:
        text: The word in lower case.
        start: The index of its first character in the instruction.
        end: The index after its last character.
        is_negated: Whether the word belongs to a clause that says what not to do, or why.
        is_described: Whether the word is part of a description or question of the plan.
    """

    text: str
    start: int
    end: int
    is_negated: bool = False
    is_described: bool = False

    @property
    def is_break(self) -> bool:
        """Whether the word separates clauses."""
        return self.text in _BREAKS


def words_of(text: str) -> list[Word]:
    """Return the words of an instruction, with those of negated clauses marked."""
    plain = "".join(c.lower() if len(c.lower()) == 1 else c for c in text)
    words: list[Word] = []
    for match in _WORD.finditer(plain):
        word = Word(unicodedata.normalize("NFKC", match.group()).replace("−", "-"), match.start(), match.end())
        word.text = "and" if word.text == "&" else corrected_word(word.text)
        if word.text == "clockwise" and words and words[-1].text in {"anti", "counter"}:
            words[-1] = Word("anticlockwise", words[-1].start, word.end)
        else:
            words.append(word)
    _mark_negated(words)
    return words


def _mark_negated(words: list[Word]) -> None:
    """Mark the words from a negation to the end of its clause: "but do not zoom"."""
    is_negated = False
    for i, word in enumerate(words):
        contracted = word.text == "t" and i > 0 and words[i - 1].end + 1 == word.start
        if word.is_break or (word.text in _ASKING and [w.text for w in words[i + 1 : i + 2]] == ["you"]):
            is_negated = False
        elif (
            contracted
            or word.text in _NEGATING
            or (word.text == "keep" and {"as", "same"} & {w.text for w in words[i : i + 4]})
            or (word.text == "of" and words[i - 1].text in {"instead", "rather"})
        ):
            is_negated = True
        word.is_negated = is_negated
