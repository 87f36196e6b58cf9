"""Apply corrections within an instruction: "pan left 20, sorry, I meant right 20" becomes "pan right 20".

A correction replaces the last number, direction or preset before it. Anything else is left as it is, and the grammar asks back.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from scope_ptz.english.grammar.numbers import read_number

_HESITATION = r"(?:oh|oops|er|erm|uh|um|ah|well|actually|please|hang on|hold on)"
_MARKER = re.compile(
    rf"(?:\s*[,;.–—-]+\s*|\s+)(?:{_HESITATION}[,\s.–—-]+)*"
    r"(?:(?:no|sorry|wait|scratch that|scrap that|strike that|belay that|correction|on second thoughts?|my "
    r"mistake|no wait|wait no)\b[,\s.–—-]*)*"
    rf"(?:{_HESITATION}[,\s.–—-]+)*"
    r"(?:i (?:mean|meant)(?: to say)?|(?:make|made) (?:that|it)|no|sorry|wait|scratch that|scrap that|strike "
    r"that|belay that|correction|(?:or )?rather|oops|er|erm|actually)\b[,:\s.–—-]*"
    r"(?P<new>[^,;.!?]*)",
    re.IGNORECASE,
)
_DIRECTIONS = ("anticlockwise", "counterclockwise", "clockwise", "left", "right", "up", "down", "in", "out")
_DIRECTION = re.compile(rf"\b(?:{'|'.join(_DIRECTIONS)})\b", re.IGNORECASE)
_NUMBER_WORD = re.compile(r"[-+−]?\d+(?:\.\d+)?|[^\W\d_]+")
_CONTINUATION = re.compile(r"\s+(?:and|then)\b.*", re.IGNORECASE)
_FILLING = re.compile(r"^(?:to|the|go to|by|not|about|that's|to the)\b\s*", re.IGNORECASE)
_REST = re.compile(r"^(?:degrees?|deg|times|x|°|preset|please|instead|\s)*$", re.IGNORECASE)
_REPORTED = re.compile(r"\s*i said\b", re.IGNORECASE)
_UNIT_AFTER = re.compile(r"^\s*,\s*(?=(?:degrees?|deg|times)\b)", re.IGNORECASE)


def corrected(text: str, presets: Sequence[str] = ()) -> str:
    """Return an instruction with its corrections applied."""
    for _ in range(3):
        match = _MARKER.search(text)
        while match and (replaced := _replacement(text, match, presets)) is None:
            match = _MARKER.search(text, match.start() + 1)
        if not match or replaced is None:
            return text
        text = replaced + _UNIT_AFTER.sub(" ", text[match.end() :])
    return text


def _replacement(text: str, match: re.Match[str], presets: Sequence[str]) -> str | None:
    """Return the text before a correction with the correction applied; None if it is unclear what it replaces."""
    is_inserted = bool(re.search(r"\s[-–—]\s", match["new"]))  # "zoom out - sorry, in - 2x"
    if is_inserted and "mean" not in match[0].lower():
        return None
    return _replaced(text[: match.start()], match["new"], presets)


def _replaced(before: str, new: str, presets: Sequence[str]) -> str | None:
    """Return the text before a correction with its last number, direction or preset replaced; None if nothing fits."""
    if _REPORTED.match(before):
        return None
    more = _CONTINUATION.search(new)
    rest = more[0] if more else ""
    new = new[: len(new) - len(rest)].strip()
    while (shorter := _FILLING.sub("", new)) != new:
        new = shorter
    if not new:
        return None
    if (preset := _preset(new, presets)) and (last := _last_preset(before, presets)):
        return before[: last[0]] + preset + before[last[1] :] + rest
    return _with_amount(before, new, rest)


def _with_amount(before: str, new: str, rest: str) -> str | None:
    """Replace the last direction and the last number by those of the correction."""
    direction = _DIRECTION.search(new)
    number = _numbers(new)
    unread = re.sub(r"\s[-–—]\s", " ", _DIRECTION.sub("", new))
    for start, end in reversed(_numbers(unread)):
        unread = unread[:start] + unread[end:]
    if not (direction or number) or len(number) > 1 or not _REST.match(re.sub(r"\b(?:to|by|the)\b", "", unread)):
        return None
    clause = max(before.rfind(mark) + 1 for mark in (",", ";", ". ", " then ", " and "))
    spans: list[tuple[tuple[int, int], str]] = []
    if direction:
        directions = list(_DIRECTION.finditer(before, clause))
        if not directions:
            return None
        spans.append((directions[-1].span(), direction[0]))
    if number:
        numbers = [span for span in _numbers(before) if span[0] >= clause]
        if not numbers and not direction:
            return None
        if numbers:
            spans.append((numbers[-1], new[slice(*number[0])]))
        else:  # "pan left, no, right 25"
            spans[0] = (spans[0][0], f"{spans[0][1]} {new[slice(*number[0])]}")
    for (start, end), words in sorted(spans, reverse=True):
        before = before[:start] + words + before[end:]
    return before + rest


def _numbers(text: str) -> list[tuple[int, int]]:
    """Return the spans of the numbers in a text."""
    words = [(match.group().lower(), match.span()) for match in _NUMBER_WORD.finditer(text)]
    spans: list[tuple[int, int]] = []
    i = 0
    while i < len(words):
        read = read_number([word for word, _ in words[i : i + 8]])
        if read.used and read.kind != "ORDINAL":
            spans.append((words[i][1][0], words[i + read.used - 1][1][1]))
        i += max(read.used, 1)
    return spans


def _pattern(preset: str) -> re.Pattern[str]:
    return re.compile(r"\b" + r"[-_\s]?".join(map(re.escape, re.split(r"[-_\s]+", preset))) + r"\b", re.IGNORECASE)


def _preset(text: str, presets: Sequence[str]) -> str | None:
    return next((preset for preset in presets if _pattern(preset).fullmatch(text.removesuffix(" preset").strip())), None)


def _last_preset(text: str, presets: Sequence[str]) -> tuple[int, int] | None:
    spans = [match.span() for preset in presets for match in _pattern(preset).finditer(text)]
    return max(spans, default=None)
