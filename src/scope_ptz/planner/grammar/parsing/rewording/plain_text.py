"""Replace wordings in the text of an instruction with plainer ones, before it is split into words."""

from __future__ import annotations

import re

from scope_ptz.planner.grammar.lexing.spelling import corrected_noun, with_whole_ending, without_stretched_letters
from scope_ptz.planner.grammar.parsing.remark_detection.surrounding_remarks import without_remarks
from scope_ptz.planner.grammar.parsing.rewording.rewordings import reworded_text, rewordings
from scope_ptz.planner.grammar.parsing.rewording.tables.conditions import CONDITIONS
from scope_ptz.planner.grammar.parsing.rewording.tables.counts import COUNTS
from scope_ptz.planner.grammar.parsing.rewording.tables.courtesy import COURTESIES
from scope_ptz.planner.grammar.parsing.rewording.tables.moves import MOVES
from scope_ptz.planner.grammar.parsing.rewording.tables.places import with_places_named
from scope_ptz.planner.grammar.parsing.rewording.tables.questions import QUESTIONS, with_question_apart, with_separate_questions
from scope_ptz.planner.grammar.parsing.rewording.tables.remarks import REMARKS
from scope_ptz.planner.grammar.parsing.rewording.tables.second_halves import REPAIRS
from scope_ptz.planner.grammar.parsing.rewording.tables.spelling import SPELLING, WORDS
from scope_ptz.planner.grammar.parsing.rewording.tables.views import VIEWS
from scope_ptz.planner.grammar.parsing.rewording.tables.withdrawals import WITHDRAWALS, without_part_left_out

_STANDARD = rewordings((*SPELLING, *CONDITIONS, *COURTESIES))
_ASIDES = rewordings((*REPAIRS, *WITHDRAWALS, *REMARKS))
_SET_REMARKS = rewordings(REMARKS)
_WORDINGS = rewordings((*MOVES, *VIEWS, *QUESTIONS, *COUNTS))
_NONSTANDARD = re.compile(rf"\b(?:{'|'.join(WORDS)})\b['’]?(?!\w)", re.IGNORECASE)
_LONG_WORD = re.compile(r"\b[a-z]{5,}\b")
_STRETCHED_WORD = re.compile(r"\b[a-z]*([a-z])\1\1[a-z]*\b", re.IGNORECASE)
_SHORT_ENDING = re.compile(r"\b([A-Za-z]{2,}in)\b['’]?")
_MAX_CHARS = 600  # longer texts are left as they are: nobody types them in one go, and each pattern would have to search them


def written_out(text: str) -> str:
    """Return a text with abbreviations, dialect, shortened endings and misspelt nouns in standard English."""
    if len(text) > _MAX_CHARS:
        return text
    text = _STRETCHED_WORD.sub(lambda match: without_stretched_letters(match[0].lower()), text)
    text = _LONG_WORD.sub(lambda match: corrected_noun(match[0]), text)
    text = _NONSTANDARD.sub(lambda match: WORDS[match[0].lower().rstrip("'’")], text)
    return with_question_apart(reworded_text(_SHORT_ENDING.sub(_whole, text), _STANDARD))


def _whole(match: re.Match[str]) -> str:
    """Return "sitting" for "sittin" and "sittin'"."""
    word = match[1]
    return f"{word}g" if with_whole_ending(word.lower()) != word.lower() else match[0]


def without_set_remarks(text: str) -> str:
    """Return a text, written out, without the remarks that are known by their words: "..., that's me done for tonight"."""
    return reworded_text(written_out(text), _SET_REMARKS) if len(text) <= _MAX_CHARS else text


def without_asides(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without remarks and withdrawn parts, and with abbreviations written out. The rest is as the user said it."""
    if len(text) > _MAX_CHARS:
        return text
    return reworded_text(without_part_left_out(without_remarks(written_out(text), presets)), _ASIDES)


def plainer(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text in plainer words, such as "all the way left" for "as far left as you can go".

    Args:
        text: A text without asides.
        presets: The camera's presets.
    """
    if len(text) > _MAX_CHARS:
        return text
    return with_separate_questions(with_places_named(reworded_text(text, _WORDINGS), presets))
