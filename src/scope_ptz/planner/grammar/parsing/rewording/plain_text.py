"""Replace wordings in the text of an instruction with plainer ones, before it is split into words."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from scope_ptz.planner.grammar.parsing.rewording.surrounding_remarks import without_remarks
from scope_ptz.planner.grammar.parsing.rewording.text_moves import MOVES
from scope_ptz.planner.grammar.parsing.rewording.text_places import with_places_named
from scope_ptz.planner.grammar.parsing.rewording.text_questions import QUESTIONS, with_separate_questions
from scope_ptz.planner.grammar.parsing.rewording.text_remarks import REMARKS
from scope_ptz.planner.grammar.parsing.rewording.text_shorthand import SHORTHAND
from scope_ptz.planner.grammar.parsing.rewording.text_withdrawals import WITHDRAWALS, without_part_left_out

Replacement = str | Callable[[re.Match[str]], str]
"""Words, or a function of the match that returns them."""


def _compiled(patterns: Sequence[tuple[str, Replacement]]) -> tuple[tuple[re.Pattern[str], Replacement], ...]:
    return tuple((re.compile(pattern, re.IGNORECASE), plain) for pattern, plain in patterns)


_SHORTHAND = _compiled(SHORTHAND)
_WORDINGS = _compiled((*WITHDRAWALS, *REMARKS, *MOVES, *QUESTIONS))
_MAX_CHARS = 600  # longer texts are left as they are: nobody types them in one go, and each pattern would have to search them


def plainer(text: str, presets: tuple[str, ...] = ()) -> str:
    """Return a text without "mate" at the end, with "all the way left" for "as far left as you can go", and so on."""
    if len(text) > _MAX_CHARS:
        return text
    text = without_part_left_out(without_remarks(_replaced(text, _SHORTHAND), presets))
    return with_separate_questions(with_places_named(_replaced(text, _WORDINGS), presets))


def _replaced(text: str, patterns: Sequence[tuple[re.Pattern[str], Replacement]]) -> str:
    for pattern, plain in patterns:
        text = pattern.sub(plain, text)
    return text
