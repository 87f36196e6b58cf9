"""Find statements that take back, forbid or change what the rest of an instruction asks for."""

from __future__ import annotations

import re

_NUMBER = r"(?:\d+|ten|twelve|fifteen|twenty|thirty|forty|fifty|sixty|ninety)"
_LAST_WORDS = (
    r"nope|no way|rewind|get out|skip it|as you were|(?:please )?refrain|no such thing|quit it",
    r"(?:i )?give up(?: on (?:that|it))?",
    r"i said nothing|consider it unsaid",
    r"(?:it|that)(?: is|['’]s) fine as (?:it )?is",
    r"(?:the plan|it) is off|plans have changed",
    r"(?:let us |let['’]s |we will |we['’]ll )?stay (?:here|where we are)(?: for now)?",
    r"(?:the )?(?:wrong way|opposite(?: direction)?|other direction)",
    r"which is forbidden",
    r"(?:we|you) (?:don['’]t|do not) (?:have|need) to",
    r"on my (?:mark|signal)",
    r"(?:he|she|they) (?:told me|shouted|said)",
)
"""Set phrases that take a command back as the last sentence. Other statements are recognised by the model of statements."""

_FIRST_WORDS = (
    r"(?:don['’]?t|do not) take this literally",
    r"(?:please )?(?:don['’]?t|do not) (?:do|execute|run|obey|carry out) (?:this|that|it|the following)",
    r"the (?:label|manual|note) (?:reads|says)",
    r"the syntax is",
    r"the following is",
    r"yesterday i said",
    r"i doubt (?:that )?we should",
    r"i['’]m not sure (?:that )?we should",
    r"did i ask you to",
    r"on my (?:mark|signal)",
)
"""First words of an instruction that only quotes, doubts or postpones a command."""

_STATEMENTS = (
    re.compile(
        r"\b(?:nobody|no one|we|i|you|he|they)\b[^.;?!]{0,20} (?:are|is|am|was|were)(?: not|n['’]t)? allowed to\b"
        r"|\b(?:nobody|no one) (?:is|was) allowed\b"
        r"|\bnot to be (?:moved|touched|used|turned|disturbed|operated)\b"
        r"|\bmust(?:n['’]t| not| never) (?:do (?:this|that|it|so)|move|touch (?:it|the camera)|use (?:it|the camera))\b"
        r"|\b(?:i|we) (?:take|took) (?:that|it|this) back\b"
        r"|\byou should(?: not|n['’]t)? have (?:asked|waited|done)\b"
        r"|\b(?:check|clear it|talk) with (?:me|him|her|us|them) first\b|\bask (?:me|him|her|us|them) first\b"
        r"|\bwithout asking\b.{0,20}\b(?:not|never)\b"
        r"|\b(?:i|we)(?: would|['’]d) rather (?:have|see|not|do|go)\b(?! a closer)"
        r"|\b(?:only|just) (?:want|need|meant) half\b|\b(?:need|want)s? it (?:twice|half)\b",
        re.IGNORECASE,
    ),
    re.compile(
        rf"[,.;] (?:my \w+ |he |she |i |we |they )?(?:says? |said |think |thinks |reckons? )?{_NUMBER}(?: degrees)? (?:is|will be) "
        rf"(?:enough|plenty|too much|fine|right|better)\b",
        re.IGNORECASE,
    ),
    re.compile(
        r"(?:^|[,.;?!–-] |\b(?:but|and) )(?:"
        r"(?:i|we) (?:refuse|object)\b|(?:abort|retract|belay|disregard|strike)(?: that| it| this)?\W*$"
        r"|(?:that|this|it) (?:is|was)(?:n['’]t| not) what (?:i|we) (?:want|need|ask|mean)"
        r"|(?:that|this|it) (?:is|was) (?:meant )?for (?:the other|another)\b"
        r"|(?:nobody|no one) (?:told|asked|wants|needs)(?: (?:you|me|us))?(?: to| for| it| that)?\W*$"
        r"|the camera (?:must|should|has to|is to) (?:stay|remain|be left)\b|the camera stays\b"
        r"|(?:we|you|i) (?:should|must|ought|need)(?:n['’]t| not)\W*$|(?:he|she|they) meant\b"
        r"|(?:that|this|the) (?:order|request|command|instruction) (?:is|was|has been)\b|[^,.;?!]{0,40}\bwithdr[ae]w\w*"
        r"|(?:just |only )?(?:imagine|pretend|suppose|assume) (?:i|we|that|you)\b|(?:bad|terrible|stupid) idea\W*$"
        r"|[^,.;?!]{0,40}\b(?:permission for (?:it|that|this)|finger slipped|better (?:leave|not))\b"
        r"|i(?: am|['’]m) (?:only|just) (?:testing|joking|kidding)\b)"
        r"|[,;] assuming\b",
        re.IGNORECASE,
    ),
    re.compile(rf"[,.;?!–-] (?:(?:oh|ah|no|well|actually|sorry|please|but|and),? )*(?:{'|'.join(_LAST_WORDS)})\W*$", re.IGNORECASE),
    re.compile(rf"^(?:{'|'.join(_FIRST_WORDS)})\b", re.IGNORECASE),
)


def withdrawing_statement(instruction: str) -> str | None:
    """Return the words that take back, forbid or change a command; None if there are none.

    Args:
        instruction: The user's text.
    """
    found = (pattern.search(instruction) for pattern in _STATEMENTS)
    return next((match[0].strip(" ,.;") for match in found if match), None)
