"""Read instructions that continue earlier turns: "a bit more", "another 10", "the other way", "the next preset"."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.parsing.instruction_parser import parse

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn

_MAX_TURNS = 30  # maximum number of earlier turns that are considered
_NUMBER = r"(?P<number>\d+(?:\.\d+)?)(?: degrees?| deg|°)?"
_AMOUNT = re.compile(rf"(?:by )?{_NUMBER}[.!]*", re.IGNORECASE)
_LITTLE = r"(?:just )?(?:a )?(?:little |tiny |wee )?(?:bit|touch|smidge|smidgen|tad|fraction|hair|little)"
_MORE = re.compile(
    rf"(?:and |now |ok |okay |yes |please )*(?:(?P<little>{_LITTLE}) (?:more|further)|(?:another|by another) (?P<small>{_LITTLE})"
    rf"|{_NUMBER} (?:more|further)|(?:another|by another) {_NUMBER.replace('number', 'added')})(?: please)?[.!]*",
    re.IGNORECASE,
)
_SAME = re.compile(r"(?:and |now |ok |okay |yes |please )*(?:more|further|keep going|some more)(?: please)?[.!]*", re.IGNORECASE)
_NEIGHBOUR = re.compile(
    r"(?:and |now |ok |okay |please )*(?:(?:go|move|switch|jump|on) (?:on )?to |show (?:me )?)?"
    r"(?:the )?(?P<which>next|following|previous)"
    r" (?:preset|one|position|view|place|stop)(?: please)?[.!?]*",
    re.IGNORECASE,
)
_PICTURES = re.compile(
    r"(?:and )?(?:another(?: one)?|one more|(?P<number>two|three|four|five|\d) more)(?: please)?[.!]*", re.IGNORECASE
)
_NOW = re.compile(r"(?:and |what about |how about )?now\?*", re.IGNORECASE)
_FOR = re.compile(r"for (.+ (?:seconds?|minutes?))[.!]*", re.IGNORECASE)
_CORRECTION = re.compile(r"(?:no|nope|sorry|wait|oops|i meant|i mean|make that|make it|actually)\b", re.IGNORECASE)
_OTHER_WAY = re.compile(
    r"(?:no|nope|wait|sorry|now|and)?,? ?(?:the|in the) (?:other|opposite|wrong) (?:way|direction)(?: please)?[.!]*", re.IGNORECASE
)
_ASKED = re.compile(r"By how many degrees shall I ((?:pan|tilt) (?:left|right|up|down))\?")
"""The question about "the other way", which the next turn may answer with a number."""

_WAYS = {("pan", 1): "right", ("pan", -1): "left", ("tilt", 1): "up", ("tilt", -1): "down"}
_OPPOSITE = {"left": "right", "right": "left", "up": "down", "down": "up", "in": "out", "out": "in"}


def continued_text(instruction: str, conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> str:
    """Return "pan left a bit" for "a bit more" after a turn that panned left; other instructions unchanged.

    A number that answers the question about "the other way" becomes the move that it asks about.
    """
    if not conversation or not _continues(instruction):
        return instruction
    return _continued(instruction, conversation[-_MAX_TURNS:], continued_texts(conversation, presets), presets)


def continued_texts(conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> list[str]:
    """Return the full instruction of each of the latest turns, such as "pan left a bit" for "a bit more"."""
    recent = conversation[-_MAX_TURNS:]
    texts: list[str] = []
    for i, turn in enumerate(recent):
        texts.append(_continued(turn.instruction, recent[:i], texts, presets) if _continues(turn.instruction) else turn.instruction)
    return texts


def question_about_other_way(instruction: str, conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> str | None:
    """Return the question about "the other way" after a turn that panned left; None for other instructions."""
    if not _OTHER_WAY.fullmatch(instruction.strip()):
        return None
    last = _last_direction(continued_texts(conversation, presets), presets)
    if last is None:
        return None
    axis, way = last
    amount = "By what factor" if axis == "zoom" else "By how many degrees"
    return f"{amount} shall I {axis} {_OPPOSITE[way]}?"


def _continues(instruction: str) -> bool:
    """Return whether the wording of an instruction refers to an earlier turn."""
    said = instruction.strip()
    forms = (_AMOUNT, _NEIGHBOUR, _SAME, _MORE, _PICTURES, _NOW, _FOR)
    return any(form.fullmatch(said) for form in forms) or _CORRECTION.match(said) is not None


def _continued(instruction: str, conversation: Sequence[PastTurn], texts: Sequence[str], presets: tuple[str, ...]) -> str:
    """Return the full instruction that a short one stands for. ``texts`` holds the full instructions of the earlier turns."""
    said = instruction.strip()
    asked = _ASKED.fullmatch(conversation[-1].reply) if conversation else None
    if asked is not None and (amount := _AMOUNT.fullmatch(said)):
        return f"{asked[1]} {amount['number']} degrees"
    if (neighbour := _neighbour(said, conversation, presets)) is not None:
        return f"go to preset {neighbour}"
    if texts and (changed := _changed_instruction(said, texts[-1], presets)) is not None:
        return changed
    match = _MORE.fullmatch(said)
    last = _last_direction(texts, presets) if match or _SAME.fullmatch(said) else None
    if last is None:
        return instruction
    if match is None:
        return "again"
    axis, way = last
    number = match["number"] or match["added"]
    if axis == "zoom":
        return instruction if number else f"zoom {way} a bit"
    return f"{axis} {way} {number} degrees" if number else f"{axis} {way} a bit"


def _last_direction(texts: Sequence[str], presets: tuple[str, ...]) -> tuple[str, str] | None:
    """Return the axis and direction of the move that ended the last turn; None unless it moved a single axis."""
    for text in reversed(texts):
        steps = parse(text, presets).steps
        if not steps or all(isinstance(step, ast.DoAgain | ast.Unclear) for step in steps):
            continue
        last = steps[-1]
        if not isinstance(last, ast.Move) or len(last.parts) != 1:
            return None
        part = last.parts[0]
        if isinstance(part, ast.Turn):
            return part.axis, _WAYS[part.axis, 1 if part.sign > 0 else -1]
        if isinstance(part, ast.Zoom) and part.kind == "factor":
            return "zoom", "in" if part.value > 1 else "out"
        return None
    return None


def _changed_instruction(said: str, last: str, presets: tuple[str, ...]) -> str | None:
    """Return the last instruction as changed by a correction or addition ("no, the yard", "for 20 seconds"); None for others."""
    steps = parse(last, presets).steps or ()
    if len(steps) != 1:
        return None
    (step,) = steps
    if isinstance(step, ast.Snap) and (more := _PICTURES.fullmatch(said)) is not None:
        return f"take {more['number'] or 'another'} {'pictures' if more['number'] else 'picture'}"
    if isinstance(step, ast.Count | ast.Ask) and _NOW.fullmatch(said):
        return last
    if isinstance(step, ast.Track) and step.thing.text and (time := _FOR.fullmatch(said)) is not None:
        return f"follow the {step.thing.text} for {time[1]}"
    if _CORRECTION.match(said) and isinstance(step, ast.GoToPreset | ast.ZoomTo | ast.Count | ast.Track):
        corrected = parse(f"{last.rstrip('.!? ')}, {said}", presets)
        if corrected.steps is not None and [type(other) for other in corrected.steps] == [type(step)]:
            return corrected.text
    return None


def _neighbour(said: str, conversation: Sequence[PastTurn], presets: tuple[str, ...]) -> str | None:
    """Return the preset before or after the one visited last, if the instruction asks for it; otherwise None."""
    match = _NEIGHBOUR.fullmatch(said)
    outcomes = [outcome for turn in conversation for exchange in turn.exchanges for outcome in exchange.outcomes]
    visited = [str(o.call.arguments.get("name")) for o in outcomes if o.call.name == "go_to_preset" and o.error is None]
    if match is None or not visited or visited[-1] not in presets:
        return None
    step = -1 if match["which"].lower() == "previous" else 1
    return presets[(presets.index(visited[-1]) + step) % len(presets)]
