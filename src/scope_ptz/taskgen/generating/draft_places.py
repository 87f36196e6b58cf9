"""Resolve the views in a draft to places in the scene, and check that the draft's instruction states the moves."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.bench.tasks.task import ProgramCall
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.task_places import TaskPlace, adjust_call, apply_adjustment, preset_call, preset_position
from scope_ptz.taskgen.facts.answer_phrasing import number_in_words
from scope_ptz.taskgen.generating.draft_schema import Draft, Move

_SWEEP_WORDS = re.compile(
    r"\b(?:around|round|sweep|whole|everything|entire|everywhere|all directions|every direction|full)\b", re.IGNORECASE
)
"""Words that indicate that an instruction is about everything around the camera."""

_FACTOR_WORDS = {2.0: ("twice", "double"), 3.0: ("three times", "triple"), 0.5: ("half",), 4.0: ("four times",)}
_MAX_CALLS = 6  # maximum number of moves in a draft


class DraftRejectedError(Exception):
    """Raised for a draft that cannot become a task. The message states why."""


def resolve_places(draft: Draft, scene: Scene) -> list[TaskPlace]:
    """Return the places that a draft is about, one for each view.

    Raises:
        DraftRejectedError: A move is not possible, or the instruction does not state it.
    """
    presets = {preset.name: preset for preset in scene.file.presets}
    if draft.start not in presets:
        raise DraftRejectedError(f"the scene has no preset '{draft.start}' to start from")
    position, calls = preset_position(presets[draft.start]), list[ProgramCall]()
    places = list[TaskPlace]()
    for view in draft.views:
        for step in view.moves:
            if (step.preset is not None) == step.turns:
                raise DraftRejectedError("a move must either name a preset, or turn or zoom")
            if step.preset is not None:
                if step.preset not in presets:
                    raise DraftRejectedError(f"the scene has no preset '{step.preset}'")
                call, position = preset_call(step.preset), preset_position(presets[step.preset])
            else:
                call = adjust_call(step.pan_deg, step.tilt_deg, step.zoom_factor)
                next_position = apply_adjustment(position, call)
                if next_position is None:
                    raise DraftRejectedError("a move goes beyond the camera's limits")
                position = next_position
            calls.append(call)
        places.append(TaskPlace(scene, draft.start, tuple(calls), position, swept=view.sweep))
    if len(calls) > _MAX_CALLS:
        raise DraftRejectedError(f"the draft has more than {_MAX_CALLS} moves")
    if reason := next(find_unstated_moves(draft), None):
        raise DraftRejectedError(reason)
    return places


def find_unstated_moves(draft: Draft) -> Iterator[str]:
    """Yield a message for every move that the instruction does not state."""
    text = f" {' '.join(re.findall(r'[a-z0-9.-]+', draft.instruction.lower()))} "
    for view in draft.views:
        for step in view.moves:
            if step.preset is not None and step.preset.lower() not in text and step.preset.lower().replace("-", " ") not in text:
                yield f"the instruction does not name the preset '{step.preset}'"
            yield from (
                f"the instruction does not say {amount:g}" for amount in _amounts(step) if not _contains_number(text, amount)
            )
        if view.sweep and not _SWEEP_WORDS.search(draft.instruction):
            yield "the instruction does not say that it is about everything around the camera"


def _amounts(step: Move) -> list[float]:
    return [abs(n) for n in (step.pan_deg, step.tilt_deg, step.zoom_factor) if n]


def _contains_number(text: str, amount: float) -> bool:
    """Return whether text contains a number, in digits or in words."""
    if any(f" {word} " in text for word in _FACTOR_WORDS.get(amount, ())):
        return True
    if any(float(number) == amount for number in re.findall(r"\d+(?:\.\d+)?", text)):
        return True
    return amount == int(amount) and f" {number_in_words(int(amount))} " in text
