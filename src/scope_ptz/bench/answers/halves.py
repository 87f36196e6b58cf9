"""Saying what is in one half of the picture, which alone does not tell whether it is in the half that was asked about."""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.bench.answers.text import AnswerText

_SIDE = (
    r"(on|in|at|to|from) (the |its )?(far |very )?(left|right|upper|lower|top|bottom|other)( hand)?( side| half| part)?\b"
    r"(?! (left|right|corner|quarter|quadrant|of the (?!picture|image|frame|view|photo|scene)))"
)
_AT_A_SIDE = re.compile(rf"\b{_SIDE}")
_NOT_AT_A_SIDE = re.compile(rf"\b(not|none|nothing|neither)( of (them|these|those))?( \w+){{0,2}}? {_SIDE}")
_SOME_AT_A_SIDE = re.compile(
    rf"\b(one|ones|some|several|two|three|four|five|six|[1-9]\d*|them|they|it|these|those|all)( \w+){{0,2}}? {_SIDE}"
)
_ONLY = re.compile(r"\b(all|only|every|each|both|entirely|exclusively|just|solely|always)\b")
_DEFINITE = re.compile(
    r"^(\w+ly )?(is|are|was|were) ((all|only|both|located|visible|standing|found|seen|placed|situated) )*" + _SIDE
)


def leaves_the_half_open(script: AnswerText, subject: Sequence[str]) -> bool:
    """Whether a text only tells the halves apart ("one on the left, none on the right"), or says of all that they are in one half.

    What that answers depends on which half was asked about.
    """
    mentions = script.mentions({"subject": subject}) if subject else []
    there, absent = False, False
    for group in script.segments():
        said = " ".join(script.words[i].text for i in group)
        own = [m for m in mentions if group[0] <= m.start <= group[-1]]
        if not _AT_A_SIDE.search(said):
            there = there or any(not m.denied for m in own)
            continue
        denied = any(m.denied for m in own) or _NOT_AT_A_SIDE.search(said) is not None
        absent = absent or denied
        there = there or any(not m.denied for m in own) or (not denied and _SOME_AT_A_SIDE.search(said) is not None)
        for mention in (m for m in own if not m.denied):
            before = " ".join(script.words[i].text for i in group if i < mention.start)
            after = " ".join(script.words[i].text for i in group if i >= mention.end)
            is_definite = re.search(r"\b(the|these|those)( \w+)?$", before) is not None and _DEFINITE.match(after) is not None
            if is_definite or _ONLY.search(said):
                return True
    return there and absent
