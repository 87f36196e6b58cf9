"""Create the drafts for one scene, by category."""

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
from scope_ptz.taskgen.authoring.categories.descriptor_tasks import AttributeValues
from scope_ptz.taskgen.authoring.drafts import TaskDraft
from scope_ptz.taskgen.authoring.task_places import ScenePlaces, TaskPlace
from scope_ptz.taskgen.facts.robust import TASK_CAMERA

_OFF_PRESET_VIEWS = 64  # number of views away from the presets, per scene
_CANDIDATE_VIEWS = 2  # number of random candidates for each such view; the one with the most visible objects is used
_START_VIEWS = 3  # number of presets with questions about the start view, which need no move
_MAX_GROUPS = 40  # maximum number of pairs of presets to compare, and of groups of three presets
_MAX_PER_TYPE = 10  # maximum number of drafts per question type and view
_READING_VIEWS = 36  # maximum number of views that are zoomed in to read text, per scene


class SceneDrafts:
    """The drafts for one scene, in an order that depends on the seed. A view's ground truth is read on first use.

    Args:
        scene: The scene.
        seed: Seed for every random choice.
        nouns: Nouns of object categories that a question may be about even if the scene has no such object.
        values: The attribute values in all scenes, which questions offer as options.
    """

    def __init__(self, scene: Scene, seed: int, nouns: frozenset[str], values: AttributeValues) -> None:
        self.scene, self.nouns, self.values = scene, nouns, values
        self._seed = f"{seed}:{scene.name}"
        self.places = ScenePlaces(scene, self._rng("places"))

    def _rng(self, purpose: str) -> random.Random:
        return random.Random(f"{self._seed}:{purpose}")

    @cached_property
    def presets(self) -> list[TaskPlace]:
        """All presets, taken from the viewpoints in turn."""
        by_viewpoint: dict[str, list[str]] = {}
        for preset in self.scene.file.presets:
            by_viewpoint.setdefault(preset.viewpoint, []).append(preset.name)
        longest = max(map(len, by_viewpoint.values()))
        names = [group[n] for n in range(longest) for group in by_viewpoint.values() if n < len(group)]
        return [self.places.place_from_other_preset(name) for name in names]

    @cached_property
    def views(self) -> list[TaskPlace]:
        """The places that most categories use: presets, sweeps, views away from the presets, and some start views."""
        sweeps = {place.at.viewpoint: place for place in reversed(self.places.sweeps()) if not place.calls}
        start_views = [self.places.place_at_preset(str(p.preset)) for p in self.presets]
        self._rng("stays").shuffle(start_views)
        return [*self.presets, *sweeps.values(), *self._off_preset_views(), *start_views[:_START_VIEWS]]

    def _off_preset_views(self) -> Iterator[TaskPlace]:
        """Yield views away from the presets. Each one is the candidate with the most objects among a few."""
        stream, seen = self.places.off_preset_views(), set[str]()
        for _ in range(_OFF_PRESET_VIEWS):
            candidates = [place for place in islice(stream, _CANDIDATE_VIEWS) if place.key not in seen]
            if not candidates:
                return
            best = max(candidates, key=lambda place: len(place.truth.first_sample.visible))
            seen.add(best.key)
            yield best

    @cached_property
    def reading_views(self) -> list[TaskPlace]:
        """Views that are zoomed in far enough to read text, at most one for each object with lettering."""
        by_object: dict[str, TaskPlace] = {}
        texts = list(self.scene.file.texts)
        self._rng("reading").shuffle(texts)
        for text in texts:
            for viewpoint in self.scene.file.viewpoints:
                origin = self.scene.viewpoint(viewpoint.name)
                centre = np.array(text.centre_m, dtype=np.float64)
                towards = origin.position_m - centre
                angle = float(angle_between_deg(np.cross(np.array(text.right), np.array(text.up)), towards))
                if angle > 42 or text.parent in by_object:
                    continue
                # Capital letters 22 px high are legible even under the strictest threshold.
                cap_deg = np.degrees(text.cap_height_m / float(np.linalg.norm(towards)))
                hfov = TASK_CAMERA.width / (22.0 / cap_deg)
                if hfov < TASK_CAMERA.optics.hfov_deg(TASK_CAMERA.limits.max_zoom):
                    continue
                pan, tilt = pan_tilt_deg(origin.offset(centre))
                zoom = TASK_CAMERA.optics.zoom_for_hfov(min(hfov, TASK_CAMERA.optics.hfov_deg(1.0)))
                place = self.places.place_towards(viewpoint.name, float(pan), float(tilt), zoom)
                if place is not None and any(t.text.id == text.id and t.legible for t in place.truth.first_sample.texts):
                    by_object[text.parent] = place
                if len(by_object) == _READING_VIEWS:
                    return list(by_object.values())
        return list(by_object.values())

    def drafts(self, category: Category) -> Iterator[TaskDraft]:
        """Yield all drafts in a category."""
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
                    yield from _limit_per_type(self._drafts_at(category, place), self._seed)
        if category == "comparative":
            for group in (*self._groups(2), *self._groups(3)):
                yield from preset_comparisons.drafts(group, rng)
        elif category == "multi_step_reasoning":
            for one, two in self._groups(2):
                yield from reasoning_tasks.drafts(one, two, self.places, self.nouns, rng)

    def _groups(self, size: int) -> list[tuple[TaskPlace, ...]]:
        """Return groups of two or three presets to compare."""
        rng = self._rng(f"groups:{size}")
        groups = [tuple(rng.sample(group, size)) for group in combinations(self.presets, size)]
        rng.shuffle(groups)
        return groups[:_MAX_GROUPS]

    def _drafts_at(self, category: Category, place: TaskPlace) -> list[TaskDraft]:
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
        return reasoning_tasks.drafts_within_view(place, rng)


def _limit_per_type(drafts: list[TaskDraft], seed: str) -> Iterator[TaskDraft]:
    """Yield a limited number of drafts of each question type, with as many different answers as possible."""
    by_type: dict[str, list[TaskDraft]] = {}
    for draft in sorted(drafts, key=lambda draft: draft.digest(seed)):
        by_type.setdefault(draft.question_type, []).append(draft)
    for group in by_type.values():
        seen: Counter[str] = Counter()
        ranks = []
        for draft in group:
            ranks.append(seen[draft.answer_key])
            seen[draft.answer_key] += 1
        order = sorted(range(len(group)), key=ranks.__getitem__)
        yield from (group[index] for index in order[:_MAX_PER_TYPE])
