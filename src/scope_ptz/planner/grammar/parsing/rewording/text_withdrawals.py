"""Patterns for parts of an instruction that are taken back, with what is left of the instruction."""

from __future__ import annotations

_PICTURE = r"(?:pic|photo|picture|still|shot|snap|image)"
_NO = r"(?:(?:scratch that|actually|no|nah|nope|wait|sorry|oh)[, ]+)*"
_LEAVE_OUT = r"(?:no|skip|forget|leave|leave out|drop|scrap|never mind|don['’]?t (?:bother with|take))"
_LINK = r"(?:,| and| then|, and| and then|, then)"

WITHDRAWALS = (
    (
        rf"^(?:take|get|grab|make|snap) (?:a |the |one )?{_PICTURE}\b[,.]* +{_NO}{_LEAVE_OUT} (?:the |that "
        rf")?{_PICTURE}[,.]+ *(?:just|only) "
        r"(?=\w)",
        "",
    ),
    (
        r" and (follow|track|count|read) (?:it|him|her|them)\b[.,;]+ *(?:(?:actually|no|wait|sorry|oh)[, ]+)*(?:do "
        r"not|don['’]?t) \1 "
        r"(?:it|him|her|them)\b",
        "",
    ),
    (
        r"[;,.] *(?:zooming in|panning|the zoom|the pan|that|this|the picture|the count) (?:is|will be) (?:enough|fine|plenty)\W*$",
        "",
    ),
    (
        rf"^(.+?){_LINK} (?:take|get|grab|make|snap) (?:a |the |one |me a |us a )?{_PICTURE}\b[,.]* +"
        rf"{_NO}{_LEAVE_OUT} (?:the |that )?{_PICTURE}\W*$",
        r"\1",
    ),
    (
        rf"^(.+?){_LINK} (pan|tilt|zoom)\b[^,.;]*[,.;] *{_NO}{_LEAVE_OUT} the \2(?:ning|ting|ing)?"
        r"(?:,? (?:just|only) (?:do )?the \w+)?\W*$",
        r"\1",
    ),
    (
        r"(?<=, )(?:(?:actually|no|nah|wait|oh)[, ]+)+(?:leave (?:it|that|him|her|them)|never mind(?: that)?|forget "
        r"(?:it|that)),? +"
        r"(?=(?:just|only) \w)",
        "scratch that, ",
    ),
)
"""Patterns with the words that replace them: "go home and take a photo, actually no, leave the photo" is "go home"."""
