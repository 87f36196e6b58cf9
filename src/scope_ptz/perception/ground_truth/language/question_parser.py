"""The parser of descriptions and questions. Of all readings that the grammar allows, the one with the lowest cost is used."""

from __future__ import annotations

from functools import cache, lru_cache
from importlib.resources import files

from lark.exceptions import LarkError

from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.perception.ground_truth.language.ambiguity import cheapest
from scope_ptz.perception.ground_truth.language.earley import EarleyGrammar, readings
from scope_ptz.perception.ground_truth.language.followups import without_first_part
from scope_ptz.perception.ground_truth.language.question_builder import QuestionBuilder
from scope_ptz.perception.ground_truth.language.question_tree import Description, Exists, Phrase, Question
from scope_ptz.perception.ground_truth.language.tokeniser import tokenise

MAX_TOKENS = 40
"""Maximum number of tokens. Longer input is not parsed, because it is slow to parse and unlikely to be about a picture."""

MAX_CONNECTIVES = 6
"""Maximum number of connectives ("next to", "with", "that"), each of which multiplies the number of readings."""

_CONNECTIVES = frozenset({"REL", "WITH", "WITHOUT", "WEAR", "HAVE", "OF", "BETWEEN", "THAT", "FROM", "TO", "EXCEPT"})


@cache
def _grammar() -> EarleyGrammar:
    text = files(__package__).joinpath("grammar.lark").read_text("utf-8")
    return EarleyGrammar(text, ("description", "question"))


@lru_cache(maxsize=512)
def parse_description(text: str) -> Description:
    """Return the best reading of a noun phrase. Text that fits no rule becomes a list of words that must all apply."""
    reading = _best(text, "description")
    if isinstance(reading, Description):
        return reading
    return Description((Phrase(tuple(str(t) for t in tokenise(text) if t.type in {"W", "COLOUR", "SIDE", "NUM", "TEXTNOUN"})),))


def is_description(text: str) -> bool:
    """Return whether a text is a noun phrase, so that ``parse_description`` understands it as a whole."""
    return isinstance(_best(text, "description"), Description)


@lru_cache(maxsize=512)
def parse_question(text: str) -> Question | None:
    """Return the best reading of a question; None if it fits no rule."""
    text = without_first_part(text)
    reading = _best(text, "question") or _best(text, "description")
    if not isinstance(reading, Description):
        return reading
    # A noun phrase alone, such as "any vehicles?", asks whether there are any.
    has_nouns = all(nouns_in(p.words) for p in reading.phrases)
    return Exists(reading) if has_nouns else None


def _best(text: str, start: str) -> Description | Question | None:
    tokens = tokenise(text)
    if not 0 < len(tokens) <= MAX_TOKENS or sum(t.type in _CONNECTIVES for t in tokens) > MAX_CONNECTIVES:
        return None
    try:
        forest = _grammar().parse(tokens, start)
    except LarkError:
        return None
    reading: Description | Question | None = cheapest(readings(forest, QuestionBuilder().build))
    return reading
