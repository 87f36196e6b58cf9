"""Replace wordings in the text of an instruction with plainer ones, before it is split into words."""

from __future__ import annotations

import re

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
from scope_ptz.planner.grammar.parsing.rewording.text_withdrawals import WITHDRAWALS, without_part_left_out

_SHORTHAND = rewordings(SHORTHAND)
_ASIDES = rewordings((*WITHDRAWALS, *REMARKS))
_WORDINGS = rewordings((*MOVES, *QUESTIONS, *COUNTS))
_SHORT_ENDING = re.compile(r"\b([A-Za-z]{2,}in)\b['’]?")
_MAX_CHARS = 600  # longer texts are left as they are: nobody types them in one go, and each pattern would have to search them


def without_asides(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without remarks and withdrawn parts, and with abbreviations written out. The rest is as the user said it."""
    if len(text) > _MAX_CHARS:
        return text
    return reworded_text(without_part_left_out(without_remarks(reworded_text(_with_endings(text), _SHORTHAND), presets)), _ASIDES)


def _with_endings(text: str) -> str:
    """Return "sitting" for "sittin" and "sittin'"."""
    return _SHORT_ENDING.sub(lambda match: f"{match[1]}g" if _is_shortened(match[1].lower()) else match[0], text)


def _is_shortened(word: str) -> bool:
    return not (is_english(word) or parts_of_speech(word)) and verb_form(f"{word}g") == "participle"


def plainer(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without "mate" at the end, with "all the way left" for "as far left as you can go", and so on.

    Args:
        text: A text without asides.
        presets: The camera's presets.
    """
    if len(text) > _MAX_CHARS:
        return text
    return with_separate_questions(with_places_named(reworded_text(text, _WORDINGS), presets))
