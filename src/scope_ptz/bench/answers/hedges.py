"""Detect answers that contain a value without stating it: alternatives, guesses, claims by others and appeals to the grader."""

from __future__ import annotations

import re

from scope_ptz.bench.answers.refusals import READINGS, join_words, split_clauses
from scope_ptz.bench.answers.tokenizer import plain_words, words_of
from scope_ptz.bench.tasks.expected import AnyExpected, Relation, Text

_ALTERNATIVES = re.compile(
    r"\b(?:unless|or else|it depends|depending on|alternatively|assuming|provided that|could go either way)\b"
    r"|\botherwise (?:none|no|yes|not|it|there|zero|nothing|0)\b|\b(?:first|second|third) (?:option|possibility|guess)\b"
    r"|^(?:yes no|no yes|none one|one none)$|\beither (?:.*)\bor not\b"
    r"|(?<!not )\beither\b(?! of| side| way| end)(?:.*)\bor\b"
    r"|\bor (?:there|it|they|i) (?:is|are|was|were|has|have|does|do)\b|\bor (?:the other way round|vice versa)\b"
)
"""Phrases that state several possibilities."""
_GUESS = re.compile(
    r"\b(?:i (?:would |will |can only )?(?:guess|hope|assume|suppose|bet)|if i (?:had to|must)|let us say|"
    r"(?:my|a|an|the) (?:\w+ )?guess|"
    r"guess(?:ing|ed)?|pick any|any number|at random|arbitrar(?:y|ily)|by default|default$|blindly|"
    r"vielleicht|peut être|peut-être|quiz[áa]s?|tal vez|forse|talvez|misschien|kanske)\b"
)
"""Phrases that make an answer a mere guess, in English and other languages."""
_GUESSED_READING = re.compile(r"\b(?:perhaps|maybe|possibly|conceivably|(?:might|may) (?:say|read|be|have)|could (?:say|be))\b")
"""Words that mark reported text as a guess."""
_DISOWNED_CLAIM = re.compile(
    r"\b(?:false|wrong|incorrect|untrue|a mistake|a lie) to (?:say|claim|state|think|answer)\b"
    r"|\b(?:anyone|anybody|whoever|people|those|someone) (?:who )?(?:says?|claims?|thinks?|states?)\b"
)
"""Phrases that attribute a claim to others, or call a claim wrong."""
_APPEAL_TO_GRADER = re.compile(
    r"\b(?:mark|grade|score|accept|count|treat|rate) (?:this|the|my|any|it|all) (?:\w+ )?(?:answers?|responses?|replies|runs?)\b"
    r"|\b(?:expected|reference|gold|official) (?:answers?|values?|results?|solution)\b|\bexpected \d|\bgrader\b|\banswer key\b"
    r"|\bignore (?:the|all|any) (?:previous|earlier|above|other)\b|\bas correct\b"
)
"""Phrases that address the grader or refer to the expected answer."""
_CONDITION = re.compile(
    r"(?<!check )(?<!see )(?<!asked )(?<!know )(?<!tell )(?<!look )(?<!out )(?<!verify )(?<!determine )(?<!me )(?<!say )(?<!find )"
    r"\bif (?:the|it|there|that|present)\b"
)
"""A condition. After verbs such as "check" and "know", "if" means "whether" and does not match."""


def hedge_reason(expected: AnyExpected, cleaned: str) -> str | None:
    """Return the reason why an answer contains a value without stating it; None if it states the value.

    Args:
        expected: The expected answer. Only its type and its wordings are used.
        cleaned: The answer as returned by ``tokenizer.clean``, without withdrawn statements.
    """
    if isinstance(expected, Text):
        cleaned = READINGS.sub(" ", cleaned)
    for clause in split_clauses(words_of(cleaned)):
        text = join_words(clause)
        if _ALTERNATIVES.search(text) or _CONDITION.search(text) or _offers_opposite(expected, text):
            return "it states alternatives"
        if _GUESS.search(text) or (isinstance(expected, Text) and _GUESSED_READING.search(text)):
            return "only a guess"
        if _DISOWNED_CLAIM.search(text):
            return "it only says what others say"
        if _APPEAL_TO_GRADER.search(text):
            return "it is about its own grading"
    return None


def _offers_opposite(expected: AnyExpected, text: str) -> bool:
    """Return whether a comparison offers an alternative after "or", as in "more than the gate, or fewer"."""
    if not isinstance(expected, Relation) or "whether" in text.split():
        return False
    wordings = "|".join(
        re.escape(" ".join(plain_words(w))) for w in (*expected.forward, *expected.backward, *expected.same, "equal")
    )
    return re.search(rf"(?<!more )\bor (?:is |has |to |of |on |the )*(?:{wordings})\b", text) is not None
