"""Sentences about results. They say what the results say and nothing else."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from scope_ptz.planner.grammar.instruction_tree import (
    Condition,
    Holds,
    Joined,
    Negated,
    Outnumbers,
    PresetWins,
    Quantity,
    Readable,
    Seen,
)

_WORDS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve")
_IRREGULAR = {
    "person": "people",
    "man": "men",
    "woman": "women",
    "child": "children",
    "foot": "feet",
    "lorry": "lorries",
    "bus": "buses",
    "body": "bodies",
}
_SINGULAR = {plural: singular for singular, plural in _IRREGULAR.items()}
_AFTER_HEAD = re.compile(
    r"\s(?:in|on|at|of|with|by|near|behind|beside|under|above|between|from|inside|outside|to|that|which|who|next|wearing|holding|carrying|parked|standing|"
    r"facing|driving|walking|visible|along|across|over|below|against|without|not)\b"
)
_OPERATORS = {">=": "at least ", "<=": "at most ", ">": "more than ", "<": "fewer than ", "==": "exactly "}


def number(value: float) -> str:
    return str(int(value)) if float(value).is_integer() else f"{value:.2f}".rstrip("0").rstrip(".")


def spelled(count: int) -> str:
    """Small numbers as words, for how often something was done; seen counts stay in digits."""
    return _WORDS[count] if 0 < count < len(_WORDS) else str(count)


def noun(description: str, count: float) -> str:
    """The description with its head noun in the singular or plural."""
    cut = _AFTER_HEAD.search(description)
    head, tail = (description[: cut.start()], description[cut.start() :]) if cut else (description, "")
    *front, last = head.split(" ")
    return " ".join([*front, (_one if count == 1 else _many)(last)]) + tail


def _one(word: str) -> str:
    low = word.lower()
    if low in _SINGULAR:
        return _SINGULAR[low]
    if low in _IRREGULAR or not low.endswith("s") or low.endswith("ss"):
        return word
    if low.endswith("ies") and len(low) > 4:
        return word[:-3] + "y"
    return word[:-2] if low.endswith(("sses", "xes", "ches", "shes")) else word[:-1]


def _many(word: str) -> str:
    low = word.lower()
    if low in _IRREGULAR:
        return _IRREGULAR[low]
    if low in _SINGULAR or low in {"traffic", "sheep", "equipment"} or (low.endswith("s") and not low.endswith("ss")):
        return word
    if low.endswith("y") and low[-2:-1] not in "aeiou":
        return word[:-1] + "ies"
    return word + ("es" if low.endswith(("s", "x", "ch", "sh")) else "s")


def counted(description: str, count: int, *, complete: bool = True) -> str:
    """ "3 cones", "no cones"; "at least 3 cones" when there may be more."""
    number = ("no" if count == 0 else str(count)) if complete else f"at least {count}"
    return f"{number} {noun(description, count)}"


def where(view: str) -> str:
    return "in the whole scene" if view == "full" else "in this view"


def pose_text(pose: Mapping[str, float]) -> str:
    return f"pan {pose['pan_deg']:.1f}, tilt {pose['tilt_deg']:.1f}, zoom {pose['zoom']:.1f}x"


def move_text(arguments: Mapping[str, Any]) -> str:
    """What a relative move did, in the past tense: "panned right 20 degrees and tilted down 10 degrees"."""
    parts = []
    if pan := arguments.get("pan_deg"):
        parts.append(f"panned {'right' if pan > 0 else 'left'} {degrees(pan)}")
    if tilt := arguments.get("tilt_deg"):
        parts.append(f"tilted {'up' if tilt > 0 else 'down'} {degrees(tilt)}")
    if factor := arguments.get("zoom_factor"):
        parts.append(f"zoomed {'in' if factor >= 1 else 'out'} {number(round(factor if factor >= 1 else 1 / factor, 2))} times")
    if percent := arguments.get("zoom_percent"):
        parts.append(f"zoomed {'in' if percent > 0 else 'out'} by {number(abs(percent))}%")
    if limit := arguments.get("zoom_limit"):
        parts.append(f"zoomed all the way {limit}")
    return listed(parts) or "did not move"


def degrees(value: float) -> str:
    return f"{number(round(abs(value), 2))} {'degree' if abs(value) == 1 else 'degrees'}"


def moves_text(arguments: Mapping[str, Any], times: int) -> str:
    """How a loop moved: "after two pans of 15 degrees to the right"."""
    plural = "" if times == 1 else "s"
    pan, tilt = arguments.get("pan_deg"), arguments.get("tilt_deg")
    if pan and not tilt and len(arguments) == 1:
        return f"{spelled(times)} pan{plural} of {degrees(pan)} to the {'right' if pan > 0 else 'left'}"
    if tilt and not pan and len(arguments) == 1:
        return f"{spelled(times)} tilt{plural} of {degrees(tilt)} {'up' if tilt > 0 else 'down'}"
    return f"{spelled(times)} move{plural}"


def listed(items: Sequence[str], joiner: str = "and") -> str:
    if len(items) < 2:
        return "".join(items)
    return f"{', '.join(items[:-1])} {joiner} {items[-1]}"


def clamped_text(clamped: Sequence[str]) -> str:
    if not clamped:
        return ""
    return f" The {listed(list(clamped))} {'limit' if len(clamped) == 1 else 'limits'} cut the move short."


def sentence(text: str) -> str:
    """With a capital letter and a full stop."""
    text = text.strip()
    if not text:
        return ""
    return text[0].upper() + text[1:] + ("" if text[-1] in ".!?" else ".")


def quantity_text(quantity: Quantity, description: str) -> str:
    if quantity == Quantity("==", 0):
        return f"no {noun(description, 2)}"
    if quantity == Quantity():
        return f"any {noun(description, 2)}"
    return f"{_OPERATORS[quantity.operator]}{number(quantity.number)} {noun(description, quantity.number)}"


def condition_text(condition: Condition) -> str:
    """What is waited for, after "I never ...": "saw at least 6 cones"."""
    if isinstance(condition, Seen):
        return f"saw {quantity_text(condition.quantity, condition.thing.text)}"
    if isinstance(condition, Readable):
        return f"could read the {condition.thing.text}"
    if isinstance(condition, Holds):
        return f"saw that the {condition.subject.text} is {'' if condition.wanted else 'not '}{condition.predicate}"
    if isinstance(condition, PresetWins):
        return f"saw {condition.wish} {condition.thing.text} at {condition.first.name} than at {condition.second.name}"
    if isinstance(condition, Outnumbers):
        return f"saw {condition.wish} {condition.first.text} than {condition.second.text}"
    if isinstance(condition, Negated):
        return f"reached a view where it does not hold that I {condition_text(condition.part)}"
    if isinstance(condition, Joined):
        return listed([condition_text(part) for part in condition.parts], "and" if condition.mode == "all" else "or")
    return "met the condition"


def source_text(sources: Sequence[str]) -> str:
    if not sources:
        return ""
    named = ["the simulator's ground truth" if source == "ground-truth" else source for source in sources]
    return f" (Source: {listed(named)}.)"
