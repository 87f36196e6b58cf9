"""What one scene has to offer: for each category a stream of drafts, place by place."""

from __future__ import annotations

import random
from collections.abc import Iterator
from functools import cached_property

import numpy as np

from scope_ptz.bench.authoring import commands, comparative, counting, descriptor, location, ocr, reasoning, single_call
from scope_ptz.bench.authoring.descriptor import Values
from scope_ptz.bench.authoring.drafts import Draft
from scope_ptz.bench.authoring.places import Place, Places
from scope_ptz.bench.ground import EYES
from scope_ptz.bench.tasks import Category
from scope_ptz.geometry import angle_between_deg, pan_tilt_deg
from scope_ptz.world.pack import Scene

STAY_EVERY = 12
"""One place in so many is the start view itself: such tasks can be answered without a move."""

MOST_OFF = 90
"""How many views off the presets a scene is searched for."""


class Desk:
    """Drafts of a scene, in an order that the seed fixes. Places are looked at only when a category asks for them."""

    def __init__(self, scene: Scene, seed: int, nouns: frozenset[str], values: Values) -> None:
        self.scene, self.nouns, self.values = scene, nouns, values
        self._seed = f"{seed}:{scene.name}"
        self.places = Places(scene, self._rng("places"))
        self._grown: list[Place] = []
        self._drafts: dict[tuple[str, int], list[Draft]] = {}

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
    def _off(self) -> Iterator[Place]:
        return self.places.off()

    def views(self) -> Iterator[Place]:
        """Presets and sweeps mixed, then views off them; the same places in the same order for every category."""
        at = 0
        while True:
            if at == len(self._grown) and not self._grow():
                return
            yield self._grown[at]
            at += 1

    def _grow(self) -> bool:
        if not self._grown:
            sweeps, off = self.places.around(), [next(self._off, None) for _ in self.presets]
            for n, preset in enumerate(self.presets):
                self._grown += [p for p in (preset, off[n], sweeps[n] if n < 4 and n < len(sweeps) else None) if p is not None]
            self._grown += [self.places.stay(p.preset or "") for p in self.presets[:: max(1, STAY_EVERY // 3)]]
            return True
        if len(self._grown) >= MOST_OFF + 3 * len(self.presets):
            return False
        place = next(self._off, None)
        if place is None:
            return False
        self._grown.append(place)
        return True

    @cached_property
    def reading_views(self) -> list[Place]:
        """Views that are near enough to read a text, one for each thing that bears some."""
        found: dict[str, Place] = {}
        for viewpoint in self.scene.file.viewpoints:
            here = self.scene.viewpoint(viewpoint.name)
            for text in self.scene.file.texts:
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
                if place is not None:
                    found[text.parent] = place
        places = list(found.values())
        self._rng("reading").shuffle(places)
        return places

    def stream(self, category: Category) -> Iterator[list[Draft]]:
        """Drafts of a category, all of one place at a time."""
        if category == "single_call":
            yield from ([draft] for draft in single_call.drafts(self.places, [*self.presets], self._rng(category)))
        elif category == "multi_step_command":
            yield from ([draft] for draft in commands.drafts(self.places, self._rng(category)))
        elif category in ("multi_step_reasoning", "comparative"):
            yield from self._mixed(category)
        else:
            places = self.views() if category != "ocr" else self._for_reading()
            for n, place in enumerate(places):
                yield self._at(category, n, place)

    def _for_reading(self) -> Iterator[Place]:
        yield from self.presets
        yield from self.reading_views
        yield from (place for place in self.views() if place.preset is None)

    def _at(self, category: Category, n: int, place: Place) -> list[Draft]:
        rng = self._rng(f"{category}:{n}")
        match category:
            case "counting":
                return counting.drafts(place, self.nouns, rng)
            case "descriptor":
                return descriptor.drafts(place, self.nouns, self.values, rng)
            case "location":
                return location.drafts(place, self.nouns, rng)
            case "ocr":
                return ocr.drafts(place)
            case "comparative":
                return comparative.drafts(place, rng)
        return reasoning.within(place, rng)

    def _mixed(self, category: Category) -> Iterator[list[Draft]]:
        """One view, then two presets, in turn."""
        pairs = [(a, b) for a in self.presets for b in self.presets if a is not b]
        self._rng(f"{category}:pairs").shuffle(pairs)
        for n, place in enumerate(self.views()):
            yield self._at(category, n, place)
            for one, two in pairs[2 * n : 2 * n + 2]:
                rng = self._rng(f"{category}:{n}:{one.preset}:{two.preset}")
                if category == "comparative":
                    yield comparative.between(one, two, rng)
                else:
                    yield reasoning.drafts(one, two, self.places, self.nouns, rng)
