"""Detect answers that decline to answer the question, even if they also state a value.

Neither "I cannot tell. There are 0." nor "0, because the tool failed" counts as the answer 0. A refusal counts only if it concerns
the subject of the question: "5 cones; I cannot tell who put them there" is an answer.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from scope_ptz.bench.answers.refusal_words import COMMON_WORDS, WORDS_BY_KIND
from scope_ptz.bench.answers.tokenizer import Word, plain_words, same_word, words_of
from scope_ptz.bench.tasks.expected import (
    AnyExpected,
    Choice,
    Description,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)

_VERBS = (
    r"(?:tell|say|determined?|know|known|readable|compared?|rank|ranked|counted|judged?|identify|identified|answer|answered|"
    r"confirm|confirmed|decided?|sure|certain|possible|legible|establish|established|verify|verified|described?|look|looked|"
    r"check|checked|observed?|perceived?|inspect|inspected|examined?|analysed?|measured?|make out|read|clear|available|"
    r"load|loaded|succeed|succeeded|respond|responded|work|worked|count)"
)
"""Verbs and adjectives that describe observation and knowledge."""
_NOUNS = (
    r"(?:images?|pictures?|photos?|frames?|video|feed|footage|view|camera|eyes|vision|sight|visibility|tools?|calls?|data|information|"
    r"info|access|results?|responses?|reply|replies|output|answers?|idea|clue|comment|knowledge|evidence|observations?|readings?|"
    r"counts?|detections?|ability|means|way)"
)
"""Nouns that denote means and results of observation."""
_REFUSAL = re.compile(
    rf"\b(?:not|never|nor) (?:(?:\w+ly|been|be|yet|even|have|had|really|able to|in a position to) ){{0,3}}{_VERBS}\b"
    r"|\b(?:unable|impossible|hard|difficult|not able|too \w+|fail|failed|tried in vain) (?:for \w+ )?to "
    r"(?:tell|say|determine|know|read|compare|rank|count|judge|identify|answer|confirm|decide|verify|describe|look|make out|do|"
    r"check|observe|perceive|inspect)\b"
    r"|\b(?:not (?:\w+ )?|never |unable to |without )(?:see|saw|seen|view|access|open|process|interpret|seeing|viewing|looking|"
    r"checking|knowing|observing) (?:at )?(?:the |this |that |an? |any )?"
    r"(?:image|images|picture|pictures|photo|photos|scene|frame|video|view|"
    r"camera|anything|it|clearly|enough|well)\b"
    r"|\bwithout (?:looking|checking|seeing|observing|knowing|counting|access)\b"
    rf"|\b(?:no|without|lack|lacks|lacked|not (?:have|had|get|got|receive|received|obtain|reach|given))"
    rf"(?: (?:any|an?|the|enough|usable|valid|clear|useful|further|sufficient|reliable|more|such|camera|tool|perception)){{0,3}} "
    rf"{_NOUNS}\b(?! (?:of|with|that) (?:an?|the) )"
    r"|\b(?:illegible|unreadable|unknown|indeterminable|undetermined|undecided|unavailable|uncertain|unclear|unverified|unanswerable)\b"
    rf"|\bno (?:\w+ ){{0,3}}(?:information|data|access|results?|counts?|reply|output)"
    r"(?: (?:is|are|was|were))?(?: (?:available|returned|given|known))?$"
    r"|\b(?:refuse|decline|abstain|refrain)\b|\b(?:give|gave|given|giving) up\b|\bskipped\b|\bsight unseen\b"
    r"|(?<!no )(?<!without )\berror\b"
    r"|\bnothing (?:(?:i|we) can (?:say|tell|report)|to (?:say|tell|report)|could be (?:seen|observed|read|counted|determined))\b"
    r"|\b(?:no one|nobody|who|god) knows\b"
    r"|\btoo (?:\w+ )?(?:dark|blurry|blurred|small|far|distant|dim|unclear|bright|faint)\b.* to (?:\w+ )?"
    r"(?:see|tell|say|read|count|make|determine|identify|judge|be)\b"
    r"|\b(?:tools?|calls?|perception|detector|counts?|query|request|camera|sweep|model|image|picture|upload|connection) "
    r"(?:has |have |had |is |was )?(?:failed|crashed|timed out|down|broken|missing|corrupt|blank|black)\b"
    r"|\bnot (?:\w+ )?(?:find|locate|detect|spot|see|seen) (?:it|them|that|this|one|any)$"
    r"|\bnot (?:\w+ )?(?:see|make out|observe) (?:\w+ ){1,4}at all\b"
    r"|\b(?:not|never) (?:been )?seen (?:it|them|that|this)\b"
)
"""Phrases that decline to answer or state that nothing was observed."""
_ABANDONMENT = re.compile(r"\b(?:i|we) (?:refuse|decline|abstain|(?:give|gave) up|skipped)\b|\bsight unseen\b")
"""Phrases that abandon the task, whatever the subject of the question."""
_FOREIGN_REFUSAL = re.compile(
    r"\b(?:no (?:lo )?(?:s[ée]|puedo)|no tengo (?:ni )?idea|non (?:lo )?so|non posso|je ne (?:sais|peux|vois) (?:pas|rien)|"
    r"aucune id[ée]e|(?:wei(?:ß|ss)|kann|sehe) (?:es |ich |das |den |die )?(?:es |das |bild )?(?:nicht|nichts)|keine ahnung|"
    r"n[ãa]o (?:sei|posso|consigo)|"
    r"(?:weet|kan) (?:het |ik )?niet|(?:vet|kan) inte|nie (?:wiem|mog[ęe]))\b"
)
"""Refusals in other languages."""
READINGS = re.compile(r"\"[^\"]*\"|\b[A-Z0-9][A-Z0-9'&-]+(?:[ /]+[A-Z0-9'&-]+)*\b")
"""Quoted text and text in capitals ("NO ACCESS"). It reports what a sign says, so it is not a refusal."""
_RETRY = re.compile(r"\b(?:first|initially|earlier|previously|before|until|again|retried|repeated|second|once|originally)\b")
"""Words which show that a later attempt succeeded."""
_BECAUSE = re.compile(r"^(?:because|since|as)\b")
_ABSENCE = re.compile(r"\b(?:no|none|not|nothing|neither|without|absent|missing|zero|0)\b")
"""Words that state an absence. An absence can be the reason for a refusal."""

_NOT_SEEN = re.compile(r"(?:find|locate|detect|spot|see) (?:it|them|that|this|one|any)$|at all$")
"""Endings of statements which say that the thing was not seen."""
_KINDS_REQUIRING_SIGHT = frozenset({"choice", "text", "ordering", "relation", "description"})
"""Kinds of expected answers that can only be given if the thing is seen."""
_SPECULATION = re.compile(
    r"\b(?:probably|likely|presumably|surely|must|should|would|guess|assume|typical|typically|usually|normally|generally|often|expected)\b"
)
"""Words that turn a statement after a refusal into a guess."""


def declines_to_answer(expected: AnyExpected, cleaned: str) -> bool:
    """Return whether an answer declines to answer the question, even if it also states a value.

    Args:
        expected: The expected answer. Only its type and its wordings are used.
        cleaned: The answer as returned by ``tokenizer.clean``, without withdrawn statements.
    """
    if _FOREIGN_REFUSAL.search(cleaned.lower()) or re.search(r"\bn/a\b", cleaned.lower()):
        return True
    if isinstance(expected, Text):
        cleaned = READINGS.sub(" ", cleaned)
    words = words_of(re.sub(r"[^.!?\n]*\?", "", cleaned))
    return any(_is_refusal(expected, clause) for clause in split_clauses(words))


def _is_refusal(expected: AnyExpected, clause: list[Word]) -> bool:
    text = join_words(clause)
    if _ABANDONMENT.search(text):
        return True
    match = _REFUSAL.search(text)
    if match is None or _RETRY.search(text):
        return False
    first_word = text[: match.start()].count(" ")
    last_word = text[: match.end()].count(" ")
    rest = clause[last_word + 1 :]
    after_but = next((rest[at + 1 :] for at, word in enumerate(rest) if word.text == "but"), None)
    if after_but is not None and not _SPECULATION.search(join_words(after_but)):
        return False
    if not match.group().startswith("no ") and _is_absence_given_as_reason(clause, first_word, rest):
        return False
    if _NOT_SEEN.search(match.group()):  # "I could not find any" is an answer to "is there a van?"
        return expected.kind in _KINDS_REQUIRING_SIGHT
    segment = [word for word in clause if clause[first_word].segment <= word.segment <= clause[last_word].segment]
    return _concerns_question(expected, [word.text for word in segment])


def _is_absence_given_as_reason(clause: list[Word], first_word: int, rest: list[Word]) -> bool:
    """Return whether an absence is the reason for a refusal, as in "no kite, so I cannot tell"."""
    segment = [word for word in clause if word.segment == clause[first_word].segment]
    before = clause[: clause.index(segment[0])]
    if before and segment[0].text in ("so", "therefore", "thus", "hence") and _ABSENCE.search(join_words(before)):
        return True
    for at, word in enumerate(rest):
        if ":" in word.gap or _BECAUSE.match(word.text):
            return _ABSENCE.search(join_words(rest[at:])) is not None and not any(w.text[0].isdigit() for w in rest[at:])
    return False


def _concerns_question(expected: AnyExpected, words: list[str]) -> bool:
    """Return whether a refusal concerns the subject of the question rather than another subject."""
    known = COMMON_WORDS | WORDS_BY_KIND.get(expected.kind, frozenset())
    named = [part for wording in _wordings(expected) for part in plain_words(wording)]
    match = _REFUSAL.search(" ".join(words))
    phrase = set(match.group().split()) if match else set[str]()
    subject_words = [
        word for word in words if not (word in known or word in phrase or any(same_word(word, name) for name in named))
    ]
    asks_whether = isinstance(expected, YesNo) and "whether" in words and any(same_word(words[-1], name) for name in named)
    return not subject_words or asks_whether


def _wordings(expected: AnyExpected) -> Iterable[str]:
    match expected:
        case Number():
            return expected.unit
        case YesNo():
            return (*expected.affirms, *expected.denies)
        case NoneThere():
            return expected.subject
        case Choice():
            return (*expected.subject, *expected.picks, *expected.options, *(w for ws in expected.options.values() for w in ws))
        case NameSet() | Ordering():
            return (*expected.options, *(w for ws in expected.options.values() for w in ws))
        case Relation():
            return (*expected.subject, *expected.object, *expected.forward, *expected.backward, *expected.same)
        case Description():
            return [w for fact in (*expected.facts, *expected.contradictions) for w in fact.any_of]
        case _:
            return ()


def split_clauses(words: list[Word]) -> list[list[Word]]:
    """Return the words, grouped by clause."""
    clauses: dict[int, list[Word]] = {}
    for word in words:
        clauses.setdefault(word.clause, []).append(word)
    return list(clauses.values())


def join_words(words: Iterable[Word]) -> str:
    """Return words joined by spaces."""
    return " ".join(word.text for word in words)
