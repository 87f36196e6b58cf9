"""Detect answers that only state which half of the picture something is in.

It is not clear whether such an answer is about the half that the question asks about.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.text import AnswerText, NameMention

_SIDE = (
    r"(on|in|at|to|from) (the |its )?(far |very )?(left|right|upper|lower|top|bottom|other)( hand)?( side| half| part)?\b"
    r"(?! (left|right|corner|quarter|quadrant|of the (?!picture|image|frame|view|photo|scene)))"
)
"""A phrase such as "on the left side". Quarters of the picture and sides of other things do not match."""
_ON_A_SIDE = re.compile(rf"\b{_SIDE}")
_NOTHING_ON_A_SIDE = re.compile(rf"\b(not|none|nothing|neither)( of (them|these|those))?( \w+){{0,2}}? {_SIDE}")
"""Statements that nothing is on a side, such as "none on the right"."""
_SOMETHING_ON_A_SIDE = re.compile(
    rf"\b(one|ones|some|several|two|three|four|five|six|[1-9]\d*|them|they|it|these|those|all)( \w+){{0,2}}? {_SIDE}"
)
"""Statements that something is on a side, such as "two on the left"."""
_ALL_OR_ONLY = re.compile(r"\b(all|only|every|each|both|entirely|exclusively|just|solely|always)\b")
"""Words that place every instance in one half."""
_EVERY_INSTANCE_PREDICATE = re.compile(
    r"^(\w+ly )?(is|are|was|were) ((all|only|both|located|visible|standing|found|seen|placed|situated) )*" + _SIDE
)
"""The predicate of a statement about every instance, such as "are on the left" after "the cones"."""


def is_half_unclear(text: AnswerText, subject: Sequence[str]) -> bool:
    """Return whether it is unclear which half of the picture an answer is about.

    The half counts as unclear when the answer makes different statements about the two halves ("one on the left, none on the
    right"), or places everything in one half.
    """
    mentions = text.mentions({"subject": subject}) if subject else []
    present, absent = False, False
    for group in text.segments():
        segment = " ".join(text.words[i].text for i in group)
        inside = [m for m in mentions if group[0] <= m.start <= group[-1]]
        stated = [m for m in inside if not m.denied]
        present = present or bool(stated)
        if not _ON_A_SIDE.search(segment):
            continue
        if any(_ALL_OR_ONLY.search(segment) or _is_about_every_instance(text, group, m) for m in stated):
            return True
        denied = len(stated) < len(inside) or _NOTHING_ON_A_SIDE.search(segment) is not None
        absent = absent or denied
        present = present or (not denied and _SOMETHING_ON_A_SIDE.search(segment) is not None)
    return present and absent


def _is_about_every_instance(text: AnswerText, group: Sequence[int], mention: NameMention) -> bool:
    """Return whether a segment places every instance of the subject on one side, as in "the cones are on the left"."""
    before = " ".join(text.words[i].text for i in group if i < mention.start)
    after = " ".join(text.words[i].text for i in group if i >= mention.end)
    return re.search(r"\b(the|these|those)( \w+)?$", before) is not None and _EVERY_INSTANCE_PREDICATE.match(after) is not None
