"""Parse model replies into boxes and points, or into plain answers. Many forms of JSON are accepted, even truncated JSON.

A reply means "nothing found" only if it contains an empty list or a short sentence that states this. Any other reply that cannot
be parsed raises ``PerceptionError`` of kind "malformed".
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from scope_ptz.endpoints.bodies import safe_text
from scope_ptz.errors import PerceptionError
from scope_ptz.perception.models.coordinates import RawLocation

MAX_REPLY_CHARS = 200_000
"""Maximum length of a reply; the rest is ignored. Valid lists of boxes and points are shorter."""

MAX_ANSWER_CHARS = 2_000
"""Maximum length of an answer. Longer answers are truncated, because they become part of the planner's context."""


@dataclass(frozen=True, slots=True)
class ParsedLocations:
    """The boxes and points in a reply, in order. ``complete`` is False if the reply was cut off and may have contained more."""

    locations: tuple[RawLocation, ...]
    complete: bool = True


def parse_locations(text: str) -> ParsedLocations:
    """Return the boxes and points in a model's text.

    Accepts bare and fenced JSON (one or more documents), lists cut off at the token limit, point and box tags, and corner
    pairs in prose. The result is empty if the reply states that nothing was found.

    Raises:
        PerceptionError: The reply cannot be parsed (kind "malformed").
    """
    visible = remove_reasoning(text)
    body, within_limit = visible[:MAX_REPLY_CHARS], len(visible) <= MAX_REPLY_CHARS
    documents, reply_complete = _parse_documents(body)
    locations = tuple(location for document in documents for location in _collect_locations(document)) or tuple(
        _tagged_locations(body)
    )
    if locations:
        return ParsedLocations(locations, within_limit and reply_complete)
    if within_limit and reply_complete and (any(_is_empty(d) for d in documents) or _says_none(body)):
        return ParsedLocations(())
    truncation_note = "" if reply_complete else " (cut off before the first one was complete)"
    raise PerceptionError(f"The reply contains no readable boxes or points{truncation_note}: {excerpt(text)}", kind="malformed")


def parse_answer(text: str) -> str:
    """Return the answer in a reply, without reasoning, control characters or outer quotes. A long answer is truncated.

    Raises:
        PerceptionError: There is no answer (kind "empty").
    """
    answer = "".join(c for c in remove_reasoning(text) if c.isprintable() or c in "\n\t").strip()
    if len(answer) > 1 and answer[0] == answer[-1] == '"' and answer.count('"') == 2:
        answer = answer[1:-1].strip()
    if not answer:
        raise PerceptionError("The reply contains no answer.", kind="empty")
    return answer if len(answer) <= MAX_ANSWER_CHARS else answer[:MAX_ANSWER_CHARS].rstrip() + " …"


def remove_reasoning(text: str) -> str:
    """Return the reply without ``<think>`` blocks, even if the opening or the closing tag is missing."""
    rest = re.sub(r"<think(?:ing)?>.*?</think(?:ing)?>", "", text, flags=re.DOTALL | re.IGNORECASE)
    _, closing, after = rest.rpartition("</think>")
    rest = after if closing else rest
    return re.split(r"<think(?:ing)?>", rest, maxsplit=1, flags=re.IGNORECASE)[0].strip()


def excerpt(text: str, limit: int = 160) -> str:
    """Return the beginning of a reply for an error message."""
    flat = " ".join(text[: 4 * limit].split())
    return repr(flat if len(flat) <= limit else flat[:limit] + "…")


_UNKNOWN_ANSWER = re.compile(
    r"^\W*(unknown|n/a|not (visible|legible|readable|clear|sure|possible to (tell|say))\b"
    r"|((i am |i['’]m )?(sorry|unfortunately),? (but )?)?(i|we)( am|'m|’m)? (can(not|'t|’t)|unable to|not able to) "
    r"(tell|say|determine|answer|know|read|help|assist|provide|identify|make out|see (it|that|enough|clearly|the answer))\b"
    r"|(i|we) do(n't|n’t| not) (know|see enough)"
    r"|it('s| is)? (is )?(not possible|impossible|unclear|hard to (tell|say))"
    r"|(this|that|it|the answer) (can(not|'t|’t) be|is not) (determined|told|seen|read|visible|legible)"
    r"|there is (not enough|no) (information|text|writing)\b)",
    re.IGNORECASE,
)


def is_unknown_answer(answer: str) -> bool:
    """Return whether an answer states that the question cannot be answered from the picture."""
    return bool(_UNKNOWN_ANSWER.match(answer))


_NONE_FOUND = re.compile(
    r"^\W*((none|nothing)( (is|are|of (the|these|them)|in|on|here|there|that|fits?|found|visible|detected)\b[^.{}\[\]]{0,80})?"
    r"|(there (are|is)|i (can )?(see|find|detect)|i found) (no|none|nothing|not any)\b[^{}\[\]]{0,120}"
    r"|no [^{}\[\]]{1,80}? (found|visible|present|detected|seen|in (the|this) (image|picture|frame|view|photo))"
    r"[^{}\[\]]{0,60})[\s.`]*$",
    re.IGNORECASE,
)


def _says_none(body: str) -> bool:
    return len(body) < 240 and not any(c.isdigit() for c in body) and bool(_NONE_FOUND.match(body))


_JSON_START = re.compile(r"[\[{](?=\s*(?:[\[{\]}\"'\-\d]|NaN|Infinity))")


def _parse_documents(body: str) -> tuple[list[Any], bool]:
    """Return every JSON document in a text, repaired where needed, and whether the last one was closed."""
    decoder, documents, position = json.JSONDecoder(), list[Any](), 0
    while start := _JSON_START.search(body, position):
        try:
            document, position = decoder.raw_decode(body, start.start())
        except (ValueError, RecursionError):
            repaired, closed, length = _repair(body[start.start() :])
            documents.append(repaired)
            if not closed:
                return documents, False
            position = start.start() + length
        else:
            documents.append(document)
    return documents, True


_MAX_NESTING = 64
"""Maximum nesting depth of a JSON document. Deeper documents are degenerate output without boxes."""


def _repair(text: str) -> tuple[Any, bool, int]:
    """Repair a broken document. Return the document, whether it was closed, and its length.

    If the document was cut off, only complete values are kept, because a truncated number is a wrong number.
    """
    end, open_brackets, last_closed = 0, list[str](), (0, "")
    quote = ""
    previous = ""
    skip = False
    for end, char in enumerate(text):
        if skip:
            skip = False
        elif quote:
            skip = char == "\\"
            quote = "" if char == quote else quote
        elif char == '"' or (char == "'" and previous in "[{,:"):
            quote = char
        elif char in "[{":
            open_brackets.append("]" if char == "[" else "}")
            if len(open_brackets) > _MAX_NESTING:
                return None, False, end + 1
        elif char in "]}" and open_brackets:
            open_brackets.pop()
            last_closed = (end + 1, "".join(reversed(open_brackets)))
            if not open_brackets:
                return _parse_leniently(text[: end + 1]), True, end + 1
        previous = char if not char.isspace() else previous
    complete_end, closing = last_closed
    return (_parse_leniently(text[:complete_end] + closing) if complete_end else None), False, end + 1


def _parse_leniently(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        from json_repair import repair_json  # imported here, because only broken replies need it

        try:
            return repair_json(text, return_objects=True, skip_json_loads=True)
        except Exception:  # the library raises exceptions of any kind, even assertions, for text beyond repair
            return None


_BOX_KEYS = ("bbox_2d", "box_2d", "bbox", "box", "bounding_box", "boundingbox", "rect")
_POINT_KEYS = ("point_2d", "point", "coordinates", "coordinate", "center", "centre", "location", "position")
_LABEL_KEYS = ("label", "name", "class", "category", "object", "description")
_SCORE_KEYS = ("score", "confidence", "conf", "probability")
_CORNERS = (("x_min", "y_min", "x_max", "y_max"), ("xmin", "ymin", "xmax", "ymax"), ("x1", "y1", "x2", "y2"),
            ("left", "top", "right", "bottom"))  # fmt: skip
_SIZES = (("x", "y", "width", "height"), ("x", "y", "w", "h"))


def _collect_locations(value: Any, depth: int = 0) -> Iterator[RawLocation]:
    """Yield the boxes and points anywhere in a JSON value."""
    if depth > 8:
        return
    if isinstance(value, dict):
        fields = {str(k).lower(): v for k, v in value.items()}
        locations = _from_fields(fields)
        if locations:
            yield from locations
            return
        for inner in fields.values():
            if isinstance(inner, dict | list):
                yield from _collect_locations(inner, depth + 1)
    elif isinstance(value, list):
        if len(value) > 1 and all(_is_number(v) for v in value):
            yield RawLocation(tuple(map(_number, value)))
            return
        locations_by_item = [list(_collect_locations(inner, depth + 1)) for inner in value]
        for inner, locations in zip(value, locations_by_item, strict=True):
            # An object without coordinates is malformed if its siblings have some. It is kept without numbers, so that
            # ``locations_in_frame`` reports it as unusable.
            malformed = [RawLocation(())] if not locations and isinstance(inner, dict) and any(locations_by_item) else []
            yield from locations or malformed


def _from_fields(fields: dict[str, Any]) -> list[RawLocation]:
    """Return the box and the point in one JSON object, if there are any."""
    label = next((safe_text(fields[k][:200]) for k in _LABEL_KEYS if isinstance(fields.get(k), str)), None)
    score = next((_number(fields[k]) for k in _SCORE_KEYS if _is_number(fields.get(k))), None)
    locations = []
    for keys in (_BOX_KEYS, _POINT_KEYS):
        value = next((fields[k] for k in keys if fields.get(k) is not None), None)
        if isinstance(value, dict):
            locations += [
                RawLocation(inner.numbers, label or inner.label, score, named=True)
                for inner in _from_fields({k.lower(): v for k, v in value.items()})
            ]
        elif flat := _flatten_numbers(_parse_number_list(value)):
            locations.append(RawLocation(tuple(flat), label, score))
    if locations:
        return locations
    for names in _CORNERS:
        if all(n in fields for n in names):
            return [RawLocation(tuple(_number(fields[n]) for n in names), label, score, named=True)]
    for names in _SIZES:
        if all(n in fields for n in names):
            x, y, width, height = (_number(fields[n]) for n in names)
            return [RawLocation((x, y, x + width, y + height), label, score, named=True)]
    if "x" in fields and "y" in fields:
        return [RawLocation((_number(fields["x"]), _number(fields["y"])), label, score, named=True)]
    return []


def _parse_number_list(value: Any) -> Any:
    """Parse a list that is written as a string, such as "[1, 2, 3, 4]". Other values are returned unchanged."""
    if isinstance(value, str) and len(value) < 200 and re.fullmatch(r"[\s\[\](),.\d+-]+", value):
        return re.findall(r"[-+]?\d+\.?\d*|[-+]?\.\d+", value)
    return value


def _flatten_numbers(value: Any) -> list[float]:
    """Return the numbers in a list, which may be nested once (two corners). Return an empty list if it contains anything else."""
    if not isinstance(value, list):
        return []
    inner = [v for part in value for v in (part if isinstance(part, list) else [part])]
    return [_number(v) for v in inner] if all(_is_number(v) for v in inner) else []


def _is_number(value: Any) -> bool:
    if isinstance(value, str):
        return bool(re.fullmatch(r"\s*[-+]?(\d+\.?\d*|\.\d+|nan|inf(inity)?)\s*", value, re.IGNORECASE))
    return isinstance(value, int | float) and not isinstance(value, bool)


def _number(value: Any) -> float:
    """Return a value as a float. If it is not a number, return NaN, which ``locations_in_frame`` reports as unusable."""
    try:
        return float(value) if _is_number(value) else math.nan
    except OverflowError:
        return math.inf


_TAG_NUMBERS = re.compile(r"\bx\d*\s*=\s*[\"']?\s*(-?[\d.]+)[\"']?\s+y\d*\s*=\s*[\"']?\s*(-?[\d.]+)")
_CORNER_PAIR = re.compile(r"\(\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*\)\s*,?\s*\(\s*(-?[\d.]+)\s*,\s*(-?[\d.]+)\s*\)")


def _tagged_locations(body: str) -> Iterator[RawLocation]:
    """Yield boxes and points outside JSON: ``<point x="63.5" y="44.5">`` and ``(x1,y1),(x2,y2)``."""
    for match in _TAG_NUMBERS.finditer(body) if "<point" in body else ():
        yield RawLocation(tuple(_number(v) for v in match.groups()), named=True)
    for match in _CORNER_PAIR.finditer(body):
        yield RawLocation(tuple(_number(v) for v in match.groups()))


def _is_empty(document: Any) -> bool:
    """Return whether a document means that nothing was found: an empty list, alone or in an object without an error."""
    if isinstance(document, dict):
        return "error" not in document and any(v == [] for v in document.values())
    return bool(document == [])
