"""From a draft to places in the scene: its start, its moves as tool calls, and whether its words say these moves."""

from __future__ import annotations

import re
from collections.abc import Iterator

from scope_ptz.bench.tasks.task import ProgramCall
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.task_places import Place, adjust, go, move, preset_at
from scope_ptz.taskgen.facts.answer_phrasing import in_words
from scope_ptz.taskgen.generating.draft_schema import Draft, Move

_AROUND = re.compile(
    r"\b(?:around|round|sweep|whole|everything|entire|everywhere|all directions|every direction|full)\b", re.IGNORECASE
)
_TIMES = {2.0: ("twice", "double"), 3.0: ("three times", "triple"), 0.5: ("half",), 4.0: ("four times",)}
MOST_CALLS = 6


class Refused(Exception):  # noqa: N818 - an outcome of checking a draft, not an error of the program
    """A draft that cannot become a task, and why."""


def places_of(draft: Draft, scene: Scene) -> list[Place]:
    """The views of a draft as places. Raises ``Refused``."""
    presets = {preset.name: preset for preset in scene.file.presets}
    if draft.start not in presets:
        raise Refused(f"the scene has no preset '{draft.start}' to start from")
    at, calls = preset_at(presets[draft.start]), list[ProgramCall]()
    places = list[Place]()
    for view in draft.views:
        for wanted in view.moves:
            if (wanted.preset is not None) == wanted.turns:
                raise Refused("a move either names a preset or turns and zooms")
            if wanted.preset is not None:
                if wanted.preset not in presets:
                    raise Refused(f"the scene has no preset '{wanted.preset}'")
                call, at = go(wanted.preset), preset_at(presets[wanted.preset])
            else:
                call = adjust(wanted.pan_deg, wanted.tilt_deg, wanted.zoom_factor)
                there = move(at, call)
                if there is None:
                    raise Refused("a move goes beyond the camera's limits")
                at = there
            calls.append(call)
        places.append(Place(scene, draft.start, tuple(calls), at, swept=view.sweep))
    if len(calls) > MOST_CALLS:
        raise Refused(f"more than {MOST_CALLS} moves")
    if wrong := next(unsaid(draft), None):
        raise Refused(wrong)
    return places


def unsaid(draft: Draft) -> Iterator[str]:
    """What the moves do that the instruction does not say."""
    said = f" {' '.join(re.findall(r'[a-z0-9.-]+', draft.instruction.lower()))} "
    for view in draft.views:
        for wanted in view.moves:
            if (
                wanted.preset is not None
                and wanted.preset.lower() not in said
                and wanted.preset.lower().replace("-", " ") not in said
            ):
                yield f"the instruction does not name the preset '{wanted.preset}'"
            yield from (f"the instruction does not say {amount:g}" for amount in _amounts(wanted) if not _says(said, amount))
        if view.sweep and not _AROUND.search(draft.instruction):
            yield "the instruction does not say that all around is meant"


def _amounts(wanted: Move) -> list[float]:
    return [abs(n) for n in (wanted.pan_deg, wanted.tilt_deg, wanted.zoom_factor) if n]


def _says(said: str, amount: float) -> bool:
    """Whether a number is in a text, in digits or in words."""
    if any(f" {word} " in said for word in _TIMES.get(amount, ())):
        return True
    if any(float(number) == amount for number in re.findall(r"\d+(?:\.\d+)?", said)):
        return True
    return amount == int(amount) and f" {in_words(int(amount))} " in said
