"""Parse descriptions and questions. If the grammar allows several readings, the one with the lowest cost is used."""

from __future__ import annotations

from functools import lru_cache

from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions.ambiguity import cheapest
from scope_ptz.english.grammar.questions.followups import without_first_part
from scope_ptz.english.grammar.questions.question_tree import Description, Exists, Phrase, Question
from scope_ptz.english.grammar.questions.recognition import is_short_enough, parser
from scope_ptz.english.grammar.questions.typed_tokens import tokenise


@lru_cache(maxsize=512)
def parse_description(text: str) -> Description:
    """Return the best reading of a noun phrase. If no rule matches, return a phrase of all its words, each of which must apply."""
    reading = _best(text, "description")
    if isinstance(reading, Description):
        return reading
    return Description((Phrase(tuple(str(t) for t in tokenise(text) if t.type in {"W", "COLOUR", "SIDE", "NUM", "TEXTNOUN"})),))


@lru_cache(maxsize=512)
def parse_question(text: str) -> Question | None:
    """Return the best reading of a question; None if no rule matches."""
    text = without_first_part(text)
    reading = _best(text, "question") or _best(text, "description")
    if not isinstance(reading, Description):
        return reading
    # A noun phrase alone, such as "any vehicles?", asks whether there are any.
    has_nouns = all(nouns_in(p.words) for p in reading.phrases)
    return Exists(reading) if has_nouns else None


def _best(text: str, start: str) -> Description | Question | None:
    from scope_ptz.english.grammar.questions.question_builder import QuestionBuilder  # many runs parse no question

    tokens = tokenise(text)
    if not is_short_enough(tokens):
        return None
    reading: Description | Question | None = cheapest(parser().readings(tokens, start, QuestionBuilder().build))
    return reading
