"""Replace wordings in the text of an instruction with plainer ones, before it is split into words."""

from __future__ import annotations

import re

from scope_ptz.planner.grammar.parsing.rewording.final_remarks import without_final_remark
from scope_ptz.planner.grammar.parsing.rewording.text_moves import MOVES
from scope_ptz.planner.grammar.parsing.rewording.text_places import with_places_named
from scope_ptz.planner.grammar.parsing.rewording.text_questions import QUESTIONS, with_separate_questions
from scope_ptz.planner.grammar.parsing.rewording.text_remarks import REMARKS
from scope_ptz.planner.grammar.parsing.rewording.text_withdrawals import WITHDRAWALS

_REPLACEMENTS = tuple(
    (re.compile(pattern, re.IGNORECASE), plain) for pattern, plain in (*WITHDRAWALS, *REMARKS, *MOVES, *QUESTIONS)
)


def plainer(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without "mate" at the end, with "all the way left" for "as far left as you can go", and so on."""
    text = without_final_remark(text, presets)
    for pattern, plain in _REPLACEMENTS:
        text = pattern.sub(plain, text)
    return with_separate_questions(with_places_named(text, presets))
