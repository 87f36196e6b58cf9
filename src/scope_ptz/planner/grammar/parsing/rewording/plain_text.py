"""Replace wordings in the text of an instruction with plainer ones, before it is split into words."""

from __future__ import annotations

import re
from functools import lru_cache

from scope_ptz.english.grammar.parts_of_speech import parts_of_speech, verb_form
from scope_ptz.planner.grammar.lexing.spelling import is_english
from scope_ptz.planner.grammar.parsing.rewording.rewordings import reworded_text, rewordings
from scope_ptz.planner.grammar.parsing.rewording.surrounding_remarks import without_remarks
from scope_ptz.planner.grammar.parsing.rewording.text_counts import COUNTS
from scope_ptz.planner.grammar.parsing.rewording.text_moves import MOVES
from scope_ptz.planner.grammar.parsing.rewording.text_places import with_places_named
from scope_ptz.planner.grammar.parsing.rewording.text_questions import QUESTIONS, with_separate_questions
from scope_ptz.planner.grammar.parsing.rewording.text_remarks import REMARKS
from scope_ptz.planner.grammar.parsing.rewording.text_shorthand import SHORTHAND
from scope_ptz.planner.grammar.parsing.rewording.text_views import VIEWS
from scope_ptz.planner.grammar.parsing.rewording.text_withdrawals import WITHDRAWALS, without_part_left_out

_SHORTHAND = rewordings(SHORTHAND)
_ASIDES = rewordings((*WITHDRAWALS, *REMARKS))
_WORDINGS = rewordings((*MOVES, *VIEWS, *QUESTIONS, *COUNTS))
_LONG_WORD = re.compile(r"\b[a-z]{5,}\b")
_SHORT_ENDING = re.compile(r"\b([A-Za-z]{2,}in)\b['’]?")
_MAX_CHARS = 600  # longer texts are left as they are: nobody types them in one go, and each pattern would have to search them


def written_out(text: str) -> str:
    """Return a text with abbreviations, dialect, shortened endings and misspelt nouns in standard English."""
    return reworded_text(_with_endings(_with_nouns_corrected(text)), _SHORTHAND) if len(text) <= _MAX_CHARS else text


def without_asides(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without remarks and withdrawn parts, and with abbreviations written out. The rest is as the user said it."""
    if len(text) > _MAX_CHARS:
        return text
    return reworded_text(without_part_left_out(without_remarks(written_out(text), presets)), _ASIDES)


def _with_nouns_corrected(text: str) -> str:
    """Return "bollards" for "bolards" and "waterfall" for "watrefall"."""
    return _LONG_WORD.sub(lambda match: _corrected_noun(match[0]), text)


@lru_cache(maxsize=4096)
def _corrected_noun(word: str) -> str:
    """Return the noun or adjective that results from swapping two adjacent letters or doubling one.

    Known words, and words that could be corrected in more than one way, are returned unchanged.
    """
    if is_english(word) or parts_of_speech(word) or verb_form(word) is not None:
        return word
    swapped = {word[:i] + word[i + 1] + word[i] + word[i + 2 :] for i in range(1, len(word) - 1)}
    doubled = {word[:i] + word[i] + word[i:] for i in range(1, len(word))}
    meant = {other for other in swapped | doubled if parts_of_speech(other) & {"NOUN", "ADJ"}}
    return meant.pop() if len(meant) == 1 else word


def _with_endings(text: str) -> str:
    """Return "sitting" for "sittin" and "sittin'"."""
    return _SHORT_ENDING.sub(lambda match: f"{match[1]}g" if _is_shortened(match[1].lower()) else match[0], text)


def _is_shortened(word: str) -> bool:
    return not (is_english(word) or parts_of_speech(word)) and verb_form(f"{word}g") == "participle"


def plainer(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text in plainer words, such as "all the way left" for "as far left as you can go".

    Args:
        text: A text without asides.
        presets: The camera's presets.
    """
    if len(text) > _MAX_CHARS:
        return text
    return with_separate_questions(with_places_named(reworded_text(text, _WORDINGS), presets))
