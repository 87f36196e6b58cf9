"""Parse the text that an answer reports, and compare texts, with optional tolerance for look-alike characters."""

from __future__ import annotations

import re
from itertools import pairwise

from scope_ptz.bench.answers.figures import is_figure, parse_figure
from scope_ptz.bench.answers.parsed import ParsedAnswer, ParsedValue, Unreadable
from scope_ptz.bench.answers.quotes import Quote, find_quotes, reported_quotes
from scope_ptz.bench.answers.text import AnswerText
from scope_ptz.bench.answers.tokenizer import clean
from scope_ptz.bench.tasks.expected import Text
from scope_ptz.english.numerals import SMALL_NUMBERS

TEXT_SEPARATOR = " / "
"""Separator between texts that are written in different places."""

_LOOK_ALIKES = str.maketrans({"o": "0", "i": "1", "l": "1", "|": "1", "s": "5", "b": "8"})
"""Replacement of letters by the digits that look like them."""
_DIGITS = {word: str(number) for number, word in enumerate(SMALL_NUMBERS[:13])}
"""Digits for number words, so that "three" and "3" compare as equal."""
_CUES = (
    (re.compile(r"\b(?:reads?(?! (?:the|its|this|that) \w+\s*:)|says?|states?|displays?|spells?)\b\s*:?\s*", re.IGNORECASE), 14),
    (re.compile(r":\s+"), 14),
    (re.compile(r"\b(?:shows?|called|named)\b\s*", re.IGNORECASE), 14),
    (re.compile(r"\b(?:(?<![Tt]here )is|(?<![Tt]here )are)\b\s*"), 6),
)
"""Patterns that introduce the reported text, the most reliable first, each with the maximum number of words in that text.

The last match of the last pattern and the first match of the other patterns count.
An "IS" in capitals is part of the text and does not match.
"""
_WRITTEN_TEXT = re.compile(
    r"^\W*(?!it\b|what\b|the (?:text|words?)\b)(.{1,80}?)\s+(?:is|are)\s+(?:written|painted|printed|displayed)\b", re.IGNORECASE
)
"""A sentence that begins with the reported text ("STOP is written on the sign")."""

_LEADING_WORDS = re.compile(r"^(?:the )?(?:text|words?|letters|lettering)\s+(?:that reads?\s+)?", re.IGNORECASE)
"""Words directly before the reported text that are not part of it."""
_TRAILING_WORDS = re.compile(
    r",?\s+(?:in|on|above|below|with|at|written|painted|printed|near|beside)\s+(?:(?:the|a|an|its|big|large|small|bold|capital|white|black|red|"
    r"blue|green|yellow|dark|light|orange)\s+)*(?:letters?|lettering|capitals|sign|board|text|background|front|back|plate|door|van|car|"
    r"lorry|truck|bus|shop|wall|view|top|bottom|left|right|gantry|white|black|red|blue|green|yellow|orange)\b.*$",
    re.IGNORECASE,
)
"""Words after the reported text that state where it is written or what it looks like."""
_NEXT_SENTENCE = re.compile(r"[.!]\s+(?=(?:It|This|That|The|There|I|They|In|On|At|Source|Let|Please|If|Would|You|Feel|So)\b)")
"""The end of a sentence, if the next sentence is not part of the reported text."""
_NEGATION = re.compile(r"(?:\bnot|n't|\bnever)(?: \w+)? $", re.IGNORECASE)
"""A negation before a cue."""
_NO_TEXT = re.compile(r"(?:there (?:is|are)|done|not)\b", re.IGNORECASE)
"""Beginnings of sentences that report no text."""
_COMPLETION = re.compile(
    r"(?:(?:ok|okay|sure|done|finished|completed?|ready|all set)|"
    r"(?:(?:the|this|your|all|i have|i|has) )*(?:it|everything|task|request|job|action|operation|command|instruction|step|all)s?"
    r"(?: (?:is|was|has|have|been|are|now|all))*(?: \w+ly)? (?:done|completed?|finished|executed|performed|successful|carried out)"
    r"(?:,? (?:\w+ly|with success|as (?:requested|asked)|now))*)\W*",
    re.IGNORECASE,
)
"""An answer that only states that the task is finished."""

_MAX_WORDS_ALONE = 8
"""Maximum number of words in reported text without a cue."""
_MAX_WORDS_IN_CAPITALS = 16
"""Maximum number of words in reported text in capitals."""


def same_text(one: str, other: str, *, ocr: bool) -> bool:
    """Return whether two texts are equal, ignoring case, punctuation and spaces.

    Args:
        one: A text. Parts separated by " / " may come in any order.
        other: The other text.
        ocr: Whether look-alike characters (0/O, 1/I, 5/S, 8/B) count as equal.
    """
    parts, others = ([normalized_text(part, ocr) for part in text.split(TEXT_SEPARATOR)] for text in (one, other))
    return "".join(parts) == "".join(others) or sorted(parts) == sorted(others)


def normalized_text(text: str, ocr: bool) -> str:
    """Return text in lower case without punctuation and spaces. With ``ocr``, letters are replaced by look-alike digits."""
    words = re.findall(r"[^\W_]+", re.sub(r"(?<=\w)'(?=\w)", "", clean(text).lower()))
    joined = "".join(_DIGITS.get(word, word) for word in words)
    return joined.translate(_LOOK_ALIKES) if ocr else joined


def parse_text(expected: Text, statement: AnswerText, answer: str) -> ParsedAnswer:
    """Parse the text that an answer reports.

    This is the quoted text or, if nothing is quoted, the text after "reads", "says" or "is". Otherwise it is the whole answer,
    provided that the answer is short.
    """
    text = clean(answer)
    quotes = find_quotes(text)
    if statement.declined and not quotes:
        return Unreadable("declined")
    if is_figure(expected.accepted) and (figure := Unreadable("a guess") if statement.hedged else parse_figure(expected, answer)):
        return figure
    if quotes:
        return _from_quotes(quotes, text)
    if re.search(r"\b(?:no (?:text|letters|writing)|blank|nothing (?:is )?written)\b", text, re.IGNORECASE):
        return ParsedValue("")
    written_text = _WRITTEN_TEXT.match(text)
    candidate, max_words = (written_text.group(1), _MAX_WORDS_ALONE) if written_text else _after_cue(text)
    if max_words == 0:
        return Unreadable("it only states what the text is not")
    candidate = _NEXT_SENTENCE.split(candidate)[0]
    candidate = _TRAILING_WORDS.sub("", candidate.strip().strip(".!,")).strip()
    candidate = _LEADING_WORDS.sub("", re.sub(r"\s*\n\s*", TEXT_SEPARATOR, candidate))
    words = [word for word in candidate.split() if word != TEXT_SEPARATOR.strip()]
    if candidate.isupper():
        # Text in capitals is taken to be the reported text rather than prose.
        max_words = max(max_words, _MAX_WORDS_IN_CAPITALS)
    if not candidate.isupper() and (_NO_TEXT.match(candidate) or any(map(_COMPLETION.fullmatch, (candidate, text)))):
        return Unreadable("no text is quoted")
    if len(words) > max_words:
        return Unreadable("no text is quoted")
    if "or" in [w.lower() for w in words] and not any("or" in a.lower().split() for a in expected.accepted):
        return Unreadable("it states alternatives")
    return ParsedValue(candidate)


def _after_cue(text: str) -> tuple[str, int]:
    """Return the text that follows the most reliable cue, and the maximum number of words that it may have.

    Without a cue, the whole text is returned. If every match of the cue is negated ("does not read"), the maximum is 0.
    """
    for cue, max_words in _CUES:
        matches = [match for match in cue.finditer(text) if match.end() < len(text)]
        ends = [match.end() for match in matches if not _NEGATION.search(text[: match.start()])]
        if ends:
            return text[ends[-1] if cue is _CUES[-1][0] else ends[0] :], max_words
        if matches:
            return "", 0
    return text, _MAX_WORDS_ALONE


def _from_quotes(quotes: list[Quote], text: str) -> ParsedAnswer:
    readings = reported_quotes(quotes, text)
    if not readings:
        return Unreadable("it only quotes what the text is not")
    between = [text[first.end : second.start] for first, second in pairwise(quotes)]
    if len({normalized_text(q.text, ocr=False) for q in quotes}) > 1 and any(
        re.fullmatch(r"\s*,?\s+(?:or|and then)\s+", b) for b in between
    ):
        return Unreadable("it states alternatives")
    texts = {normalized_text(quote.text, ocr=False): quote.text for quote in reversed(readings)}
    return ParsedValue(TEXT_SEPARATOR.join(reversed(texts.values())))
