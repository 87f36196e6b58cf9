"""Reduce a question to what perception must answer."""

from __future__ import annotations

import re

from scope_ptz.planner.grammar.binding.embedded_questions import direct_question

_LEAD = re.compile(
    r"(?:(?:please|now|then|and|so|ok|okay),? |(?:have|take) a look[:,]? (?:and (?:tell me|see) )?"
    r"|(?:answer|tell me) (?:this|the following|me this|this question)[:,] )+",
    re.IGNORECASE,
)
_IF_ANY = re.compile(
    r",? (?:if|assuming|provided) (?:there (?:is|are) (?:one|any|some)|(?:you|i|we) (?:can )?see (?:one|any|it|them)"
    r"|(?:it|one|any) is (?:there|visible|in view)|any|visible)"
    r"(?=\W*$)",
    re.IGNORECASE,
)
_CLOSE_UP = re.compile(
    r",? (?:(?:when|if|once|after|as) (?:you )?zoom(?:ed|ing)? in (?:on|onto) (?:it|them)(?: to read(?: it)?)?"
    r"|seen from close up|from close up|up close)(?=\W*$)",
    re.IGNORECASE,
)
_TRUE_THAT = re.compile(r"is it (?:true|the case|correct|right) that (.+)", re.IGNORECASE)
_BEARER = re.compile(
    r"(?:what|which|tell me what)\b.*?\b(?:does|do|on|of) (?:the|a|an) (?P<thing>.+?)(?: (?:say|says|read|reads|show|shows))?\W*",
    re.IGNORECASE,
)


def plain_question(question: str) -> tuple[str, str]:
    """Return a question without the parts that perception does not need, and the thing to zoom in on first.

    "If there is one" at the end is dropped, because every answer says so if there is none. "When you zoom in on it" is dropped too,
    and the thing is returned. "Is it true that the cart is blue" becomes "Is the cart blue?".

    Returns:
        The question, and the description of the thing; empty if the question does not ask to zoom in.
    """
    shorter = _IF_ANY.sub("", _LEAD.sub("", question, count=1) if _LEAD.match(question) else question)
    thing = ""
    if _CLOSE_UP.search(shorter):
        bare = _CLOSE_UP.sub("", shorter)
        if match := _BEARER.fullmatch(bare):
            shorter, thing = bare, match["thing"]
    if match := _TRUE_THAT.fullmatch(shorter.strip().rstrip("?. ")):
        shorter = direct_question(f"whether {match[1]}")
    return shorter, thing
