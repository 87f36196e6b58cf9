"""Detect answers that contain a value but do not state it: alternatives, guesses, speech of others, and appeals to the grader."""

from __future__ import annotations

import re

from scope_ptz.bench.answers.refusals import READINGS, clauses_of, joined
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
"""Words that make a reported text a guess."""
_DENIED_SPEECH = re.compile(
    r"\b(?:false|wrong|incorrect|untrue|a mistake|a lie) to (?:say|claim|state|think|answer)\b"
    r"|\b(?:anyone|anybody|whoever|people|those|someone) (?:who )?(?:says?|claims?|thinks?|states?)\b"
)
"""Phrases that attribute a statement to others, or call it wrong."""
_GRADING = re.compile(
    r"\b(?:mark|grade|score|accept|count|treat|rate) (?:this|the|my|any|it|all) (?:\w+ )?(?:answers?|responses?|replies|runs?)\b"
    r"|\b(?:expected|reference|gold|official) (?:answers?|values?|results?|solution)\b|\bexpected \d|\bgrader\b|\banswer key\b"
    r"|\bignore (?:the|all|any) (?:previous|earlier|above|other)\b|\bas correct\b"
)
"""Phrases that address whoever scores the answer, or report what the task expects."""
_CONDITION = re.compile(
    r"(?<!check )(?<!see )(?<!asked )(?<!know )(?<!tell )(?<!look )(?<!out )(?<!verify )(?<!determine )(?<!me )(?<!say )(?<!find )"
    r"\bif (?:the|it|there|that|present)\b"
)
"""A condition, except after verbs that ask whether something is so."""


def why_nothing_is_stated(expected: AnyExpected, cleaned: str) -> str | None:
    """Return why a text that contains a value does not state it; None if nothing speaks against it.

    Args:
        expected: The expected answer. Only its type and its wordings are used.
        cleaned: The answer, as for ``declines``.
    """
    if isinstance(expected, Text):
        cleaned = READINGS.sub(" ", cleaned)
    for clause in clauses_of(words_of(cleaned)):
        text = joined(clause)
        if _ALTERNATIVES.search(text) or _CONDITION.search(text) or _offers_opposite(expected, text):
            return "it states alternatives"
        if _GUESS.search(text) or (isinstance(expected, Text) and _GUESSED_READING.search(text)):
            return "only a guess"
        if _DENIED_SPEECH.search(text):
            return "it only says what others say"
        if _GRADING.search(text):
            return "it is about its own grading"
    return None


def _offers_opposite(expected: AnyExpected, text: str) -> bool:
    """Return whether a comparison offers another one after "or", as in "more than the gate, or fewer"."""
    if not isinstance(expected, Relation) or "whether" in text.split():
        return False
    others = "|".join(re.escape(" ".join(plain_words(w))) for w in (*expected.forward, *expected.backward, *expected.same, "equal"))
    return re.search(rf"(?<!more )\bor (?:is |has |to |of |on |the )*(?:{others})\b", text) is not None
