"""What one scene has to offer: for each category all drafts."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Iterator
from functools import cached_property
from itertools import combinations, islice

import numpy as np

from scope_ptz.bench.tasks.task import Category
from scope_ptz.geometry import angle_between_deg, pan_tilt_deg
from scope_ptz.simulator.pack import Scene
from scope_ptz.taskgen.authoring.categories import (
    command_tasks,
    comparative_tasks,
    counting_tasks,
    descriptor_tasks,
    location_tasks,
    ocr_tasks,
    preset_comparisons,
    reasoning_tasks,
    single_call_tasks,
)
from scope_ptz.taskgen.authoring.categories.descriptor_tasks import Values
from scope_ptz.taskgen.authoring.drafts import Draft
from scope_ptz.taskgen.authoring.task_places import Place, Places
from scope_ptz.taskgen.facts.robust import EYES

OFF = 64
"""How many views off the presets a scene is asked about,"""

TRIED = 2
"""... each the one that shows most of so many."""

STAYS = 3
"""At so many presets something is asked of the start view itself: such tasks can be answered without a move."""

MOST_GROUPS = 40
"""How many pairs, and threes, of presets are compared."""

MOST_OF_A_SORT = 10
"""So many drafts of one sort are kept of a view."""

READING = 36
"""How many views near to a text a scene is asked about."""


class SceneDrafts:
    """Drafts of a scene, in an order that the seed fixes. Places are looked at only when a category asks for them."""

    def __init__(self, scene: Scene, seed: int, nouns: frozenset[str], values: Values) -> None:
        self.scene, self.nouns, self.values = scene, nouns, values
        self._seed = f"{seed}:{scene.name}"
        self.places = Places(scene, self._rng("places"))

    def _rng(self, purpose: str) -> random.Random:
        return random.Random(f"{self._seed}:{purpose}")

    @cached_property
    def presets(self) -> list[Place]:
        """Every preset, viewpoints in turn."""
        by_viewpoint: dict[str, list[str]] = {}
        for preset in self.scene.file.presets:
            by_viewpoint.setdefault(preset.viewpoint, []).append(preset.name)
        longest = max(map(len, by_viewpoint.values()))
        names = [group[n] for n in range(longest) for group in by_viewpoint.values() if n < len(group)]
        return [self.places.direct(name) for name in names]

    @cached_property
    def views(self) -> list[Place]:
        """The same places for every category: presets, a sweep from each viewpoint, views off the presets, a few start views."""
        sweeps = {place.at.viewpoint: place for place in reversed(self.places.around()) if not place.calls}
        stays = [self.places.stay(str(p.preset)) for p in self.presets]
        self._rng("stays").shuffle(stays)
        return [*self.presets, *sweeps.values(), *self._off(), *stays[:STAYS]]

    def _off(self) -> Iterator[Place]:
        """Views off the presets, each the fullest of a few, all presets and viewpoints in turn."""
        stream, seen = self.places.off(), set[str]()
        for _ in range(OFF):
            tried = [place for place in islice(stream, TRIED) if place.key not in seen]
            if not tried:
                return
            best = max(tried, key=lambda place: len(place.sight.first.visible))
            seen.add(best.key)
            yield best

    @cached_property
    def reading_views(self) -> list[Place]:
        """Views that are near enough to read a text, one for each thing that bears some."""
        found: dict[str, Place] = {}
        texts = list(self.scene.file.texts)
        self._rng("reading").shuffle(texts)
        for text in texts:
            for viewpoint in self.scene.file.viewpoints:
                here = self.scene.viewpoint(viewpoint.name)
                centre = np.array(text.centre_m, dtype=np.float64)
                towards = here.position_m - centre
                angle = float(angle_between_deg(np.cross(np.array(text.right), np.array(text.up)), towards))
                if angle > 42 or text.parent in found:
                    continue
                # 22 px of capitals: enough to be read under the strictest threshold.
                cap_deg = np.degrees(text.cap_height_m / float(np.linalg.norm(towards)))
                hfov = EYES.width / (22.0 / cap_deg)
                if hfov < EYES.optics.hfov_deg(EYES.limits.max_zoom):
                    continue
                pan, tilt = pan_tilt_deg(here.offset(centre))
                zoom = EYES.optics.zoom_for_hfov(min(hfov, EYES.optics.hfov_deg(1.0)))
                place = self.places.towards(viewpoint.name, float(pan), float(tilt), zoom)
                if place is not None and any(t.text.id == text.id and t.legible for t in place.sight.first.texts):
                    found[text.parent] = place
                if len(found) == READING:
                    return list(found.values())
        return list(found.values())

    def drafts(self, category: Category) -> Iterator[Draft]:
        """Everything that could be asked in a category."""
        rng = self._rng(category)
        match category:
            case "single_call":
                yield from single_call_tasks.drafts(self.places, self.presets, rng)
            case "multi_step_command":
                yield from command_tasks.drafts(self.places, rng)
            case "ocr":
                for place in [*self.presets, *self.reading_views, *self.views[len(self.presets) :]]:
                    yield from ocr_tasks.drafts(place)
            case _:
                for place in self.views:
                    yield from _few(self._at(category, place), self._seed)
        if category == "comparative":
            for group in (*self._groups(2), *self._groups(3)):
                yield from preset_comparisons.drafts(group, rng)
        elif category == "multi_step_reasoning":
            for one, two in self._groups(2):
                yield from reasoning_tasks.drafts(one, two, self.places, self.nouns, rng)

    def _groups(self, size: int) -> list[tuple[Place, ...]]:
        """Presets to be compared, two or three at a time."""
        rng = self._rng(f"groups:{size}")
        groups = [tuple(rng.sample(group, size)) for group in combinations(self.presets, size)]
        rng.shuffle(groups)
        return groups[:MOST_GROUPS]

    def _at(self, category: Category, place: Place) -> list[Draft]:
        rng = self._rng(f"{category}:{place.start}:{place.key}")
        match category:
            case "counting":
                return counting_tasks.drafts(place, self.nouns, rng)
            case "descriptor":
                return descriptor_tasks.drafts(place, self.nouns, self.values, rng)
            case "location":
                return location_tasks.drafts(place, self.nouns, rng)
            case "comparative":
                return comparative_tasks.drafts(place, rng)
        return reasoning_tasks.within(place, rng)


def _few(drafts: list[Draft], seed: str) -> Iterator[Draft]:
    """No more than some drafts of each sort, as different in their answers as there are."""
    by_kind: dict[str, list[Draft]] = {}
    for draft in sorted(drafts, key=lambda draft: draft.digest(seed)):
        by_kind.setdefault(draft.kind, []).append(draft)
    for group in by_kind.values():
        seen: Counter[str] = Counter()
        ranks = []
        for draft in group:
            ranks.append(seen[draft.reads])
            seen[draft.reads] += 1
        order = sorted(range(len(group)), key=ranks.__getitem__)
        yield from (group[at] for at in order[:MOST_OF_A_SORT])
