"""Rewrite embedded questions as direct questions.

"Tell me if it's open" becomes "Is it open?", and "tell me its colour" becomes "What is its colour?".
"""

from __future__ import annotations

import re

from scope_ptz.planner.grammar.execution.answer_sentences import head_and_rest

_BE = r"is|are|was|were|isn't|aren't"
_AUXILIARY = rf"{_BE}|has|have|can|could|will|should"
_BASE_FORMS = {
    "says": "say", "say": "say", "reads": "say", "read": "say", "shows": "show", "show": "show", "has": "have", "have": "have",
    "means": "mean", "looks": "look", "look": "look", "wears": "wear", "carries": "carry", "holds": "hold", "does": "do",
    "contains": "contain", "weighs": "weigh", "costs": "cost", "lists": "list", "displays": "display",
}  # fmt: skip
_WITH_AUXILIARY = re.compile(rf"(.+?) ({_AUXILIARY}) (.+)", re.IGNORECASE)
_YES_NO = re.compile(
    r"(?:if|whether|that (?=(?:the|an?|all|every|no|any|there|it|they)\b))(?: or not)? ?(.+?)(?:,? or not)?", re.IGNORECASE
)
_WH = re.compile(
    r"((?:what|which)(?: (?!(?:the|an?|that|this|its|it|they|you|is|are|does|do|of)\b)\w+){0,2}|where(?:abouts)?|who|why"
    r"|how(?: (?:far|big|tall|high|wide|long|fast|close|busy|full|wet|bright|dark|many \w+))?(?: away)?)"
    r" ((?:the|an?|that|this|these|those|its|their|his|her|it|they|he|she|each|every|all|both|any)\b.*?)",
    re.IGNORECASE,
)
_PLURAL = re.compile(r"(?:[^s]s|\b(?:people|men|women|children|feet))$", re.IGNORECASE)
"""The pattern for words that look like plurals.

It must remain coarse ("this" counts as a plural), because recorded plans depend on it.
"""

_QUESTION_WORD = re.compile(
    r"(what|which|who|whom|whose|where|when|why|how|is|are|was|were|do|does|did|can|could|has|have|any)\b", re.IGNORECASE
)


def direct_question(text: str) -> str:
    """Return the direct question for the words after "tell me". A text that is already a direct question is returned unchanged."""
    phrase = text.strip().rstrip("?!. ").replace("’", "'")
    question = _yes_no_question(phrase) or _you_see_question(phrase) or _wh_question(phrase) or _noun_question(phrase)
    return f"{question[0].upper()}{question[1:]}?" if question else text.strip()


def _yes_no_question(phrase: str) -> str | None:
    """Return the question for "if the gate is open" or "whether you can see a van"; None for other phrases."""
    match = _YES_NO.fullmatch(phrase)
    if not match:
        return None
    clause = re.sub(r"\b(there|it|they|that|anyone|anybody|someone|everyone)'(s|re)\b", _expand_contraction, match[1])
    if see := re.fullmatch(r"you (?:can )?(see|spot|make out|read) (.+)", clause, re.IGNORECASE):
        return f"can you {see[1]} {see[2]}"
    if some := re.fullmatch(rf"((?:an?|any|some|no) .+) ({_BE})", clause, re.IGNORECASE):
        return f"{some[2]} there {some[1]}"  # "whether a ladder is", at a preset
    if inverted := _WITH_AUXILIARY.fullmatch(clause):
        return f"{inverted[2]} {inverted[1]} {inverted[3]}"
    if match := re.fullmatch(r"(.+?)'s (.+)", clause):
        return f"is {match[1]} {match[2]}"
    return f"is it true that {clause}"


def _expand_contraction(contraction: re.Match[str]) -> str:
    return f"{contraction[1]} {'are' if contraction[2] == 're' else 'is'}"


def _you_see_question(phrase: str) -> str | None:
    """Return the question for "what you see" or "what you can see there"; None for other phrases."""
    match = re.fullmatch(
        r"(what(?: else)?|which \w+|how many \w+|who(?:m)?) you (can )?(see|find|notice|spot|observe)( .+)?", phrase, re.IGNORECASE
    )
    return f"{match[1]} {'can' if match[2] else 'do'} you {match[3]}{match[4] or ''}" if match else None


def _wh_question(phrase: str) -> str | None:
    """Return the question for "what colour the door is" or "what the sign says"; None for other phrases."""
    if match := re.fullmatch(rf"{_WH.pattern} ({_AUXILIARY})( .+)?", phrase, re.IGNORECASE):
        return f"{match[1]} {match[3]} {match[2]}{match[4] or ''}"
    if match := re.fullmatch(rf"{_WH.pattern} ({'|'.join(_BASE_FORMS)})( .+)?", phrase, re.IGNORECASE):
        plural = re.match(r"they|these|those", match[2], re.IGNORECASE)
        return f"{match[1]} {'do' if plural else 'does'} {match[2]} {_BASE_FORMS[match[3].lower()]}{match[4] or ''}"
    if match := re.fullmatch(r"what(?:'s| is) happening(.*)", phrase, re.IGNORECASE):
        return f"what is happening{match[1]}"
    return None


def _noun_question(phrase: str) -> str | None:
    """Return the question for a noun phrase such as "its number plate"; None for other phrases."""
    if about := re.fullmatch(r"(?:something |more )?about (.+)", phrase, re.IGNORECASE):
        return f"what can you say about {about[1]}"
    if _QUESTION_WORD.match(phrase):
        return None
    head = re.split(r" (?:of|on|in|at|for|to|with|near|behind|from|by|that|which|who) ", phrase)[0]
    plural = _PLURAL.search(head_and_rest(head)[0]) and not re.search(r"\bbus$|ss$|'s$", head)
    return (
        f"what {'are' if plural else 'is'} {phrase}"
        if re.match(r"(the|its|their|his|her|an?|this|that|these|those)\b", phrase, re.IGNORECASE)
        else None
    )
