"""Drafts of tasks: a question or an order about a place, before it has a wording and a number."""

from __future__ import annotations

import hashlib
import math
import random
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from scope_ptz.bench.tasks.expected import AnyExpected, Wordings
from scope_ptz.bench.tasks.task import Behaviour, Category, EvidenceView, Item, Need, ProgramCall
from scope_ptz.taskgen.authoring.noun_phrases import capital
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.facts.robust import EYES
from scope_ptz.tools.arguments import View

_WRAPPERS = (
    "{M}. {D}", "{L} and tell me {i}.", "{L}, then tell me {i}.", "Please {l} and let me know {i}.", "{M}: {d}",
    "Could you {l} and report {i}?", "I'd like you to {m}. {D}", "{L} and find out {i}.", "First {m}. {D}",
    "I need to know {i}. {M} to see.", "{L} and have a look: {d}", "Tell me {i}. You will have to {m} for that.",
    "Can you {m}? {D}", "{L} and answer this: {d}", "For the log, {l} and note {i}.", "{D} To find out, {m}.",
    "Would you {l} and say {i}?", "Let me know {i}: {l} and look.",
)  # fmt: skip
_AT_PRESET = (
    "At the {p} preset, {d}", "From the {p} preset, {d}", "{D} Use the {p} preset.", "Check the {p} view: {d}",
    "Looking from the {p} preset, {d}", "In the {p} view, {d}", "Using the preset {p}, tell me {i}.",
)  # fmt: skip
_AROUND = (
    "In the whole scene, {d}", "Taking in everything around the camera, {d}", "{D} Consider the whole scene.",
    "All around the camera, {d}", "Over the full scene, tell me {i}.", "{D} Not in this view only, but all around.",
    "Looking in every direction, {d}",
)  # fmt: skip
_STAYING = (
    "{D}", "In the current view, {d}", "In this view, tell me {i}.", "Looking straight at what the camera shows now, {d}",
    "Without moving the camera, {d}", "Right here in this view, {d}",
)  # fmt: skip


@dataclass(frozen=True)
class Question:
    """Ways to ask one thing: each directly ("how many cars are there?") and inside a sentence ("how many cars there are")."""

    forms: tuple[tuple[str, str], ...]


def same_form(*questions: str) -> tuple[tuple[str, str], ...]:
    """Questions that read the same inside a sentence ("which is nearer, ...")."""
    return tuple((question, question.rstrip("?")) for question in questions)


@dataclass(frozen=True)
class Draft:
    """``key``: what is asked, so that nothing is asked twice of a view; ``kind``: the sort of question, for an even mixture.

    ``orders``: complete wordings, for what is no question. ``twin``: the like-worded task whose answer is a presence where this
    one's is an absence. ``reads``: words that tell the answer apart, for the spread of answers.
    """

    category: Category
    kind: str
    key: str
    place: Place
    expected: AnyExpected
    question: Question | None = None
    orders: tuple[str, ...] = ()
    evidence: tuple[EvidenceView, ...] = ()
    looks: tuple[ProgramCall, ...] = ()
    program: tuple[ProgramCall, ...] | None = None
    behaviour: Behaviour | None = None
    needs: tuple[Need, ...] | None = None
    tags: tuple[str, ...] = ()
    weight: int = 1
    twin: Draft | None = None
    reads: str = ""

    @property
    def calls(self) -> tuple[ProgramCall, ...]:
        return self.program if self.program is not None else (*self.place.calls, *self.looks)

    @property
    def looks_closer(self) -> bool:
        """Whether the camera ends where a close-up leaves it."""
        return any(call.tool == "zoom_to_object" for call in self.looks)

    @property
    def calls_move(self) -> bool:
        """Whether the reference moves the camera or looks all around."""
        return self.place.swept or any(call.tool not in ("count_objects", "query_answer", "take_image") for call in self.calls)

    @cached_property
    def traits(self) -> tuple[tuple[str, str], ...]:
        """What tasks are to be spread over: scene, viewpoints looked at, sort of question, answer, subject, view, start."""
        place = self.place
        seen = {view.aim.viewpoint for view in self.evidence} or {str(place.at.viewpoint)}
        return (
            ("scene", place.scene.name),
            *(("viewpoint", f"{place.scene.name}:{name}") for name in sorted(seen)),
            ("kind", self.kind),
            ("answer", self.reads),
            *(("subject", name) for name in sorted({view.about[0] for view in self.evidence if view.about})),
            ("place", place.key),
            ("start", f"{place.scene.name}:{place.start}"),
        )

    @property
    def full_key(self) -> str:
        return f"{self.place.key}|{self.key}"

    def digest(self, seed: int | str) -> str:
        """A number of its own, as good as drawn by lot, that no other draft has a say in."""
        said = f"{seed}|{self.category}|{self.kind}|{self.full_key}|{self.reads}|{self.place.start}"
        return hashlib.blake2b(said.encode(), digest_size=8).hexdigest()


class Frames:
    """Which wordings a category has used, so that none is used more than its share and no text comes twice."""

    def __init__(self, texts: set[str]) -> None:
        self.used: Counter[str] = Counter()
        self.texts = texts

    def word(self, draft: Draft, rng: random.Random, like: str | None = None) -> tuple[str, str] | None:
        """An instruction for a draft and the name of its frame; None when every wording is taken. ``like``: the frame to use."""
        options = [o for o in self._options(draft, rng) if o[0] not in self.texts and (like is None or o[1] == like)]
        if not options:
            return None
        least = min(self.used[frame] for _, frame in options)
        text, frame = rng.choice([o for o in options if self.used[o[1]] == least])
        return text, frame

    def take(self, text: str, frame: str) -> None:
        self.texts.add(text)
        self.used[frame] += 1

    def _options(self, draft: Draft, rng: random.Random) -> list[tuple[str, str]]:
        if draft.question is None:
            return [(text, f"{draft.kind}/{n}") for n, text in enumerate(draft.orders)]
        place, options = draft.place, list[tuple[str, str]]()
        for n, (direct, inside) in enumerate(draft.question.forms):
            words = {"d": direct, "D": capital(direct), "i": inside}
            name = f"{draft.kind}/{n}"
            if place.stays:
                options += [(w.format(**words), f"{name}/stay{k}") for k, w in enumerate(_STAYING)]
                continue
            if place.preset is not None and not place.swept:
                options += [(w.format(p=place.preset, **words), f"{name}/preset{k}") for k, w in enumerate(_AT_PRESET)]
            if place.swept and not place.calls:
                options += [(w.format(**words), f"{name}/around{k}") for k, w in enumerate(_AROUND)]
            for k, wrapper in enumerate(_WRAPPERS):
                moves, before_and = place.said(rng)
                said = wrapper.format(m=moves, M=capital(moves), l=before_and, L=capital(before_and), **words)
                options.append((said, f"{name}/{k}"))
        return options


def view(place: Place, shows: AnyExpected | None, about: Wordings, items: Sequence[Item] = (), *, whole: bool) -> EvidenceView:
    """A place as evidence. A view that counts as a whole must be seen at 60% of its sharpness here."""
    eyes = place.sight.projection
    density = eyes.density * math.pi / 180
    return EvidenceView(
        aim=place.aim,
        scope="full" if place.swept else "current",
        hfov_deg=place.hfov_deg,
        band_deg=band() if place.swept else None,
        items=tuple(items),
        whole=whole,
        min_density_px_deg=round(0.6 * density, 3) if whole else 0.0,
        shows=shows,
        about=about,
    )


def band() -> tuple[float, float]:
    """The tilts that a sweep takes in, bottom and top."""
    sweep = EYES.sweep()
    return round(sweep.bottom_tilt_deg + 0.01, 2), round(sweep.top_tilt_deg, 2)


def scope_of(place: Place) -> View:
    return "full" if place.swept else "current"


def count(description: str, place: Place) -> ProgramCall:
    return ProgramCall(tool="count_objects", arguments={"description": description, "view": scope_of(place)})


def ask(question: str, place: Place) -> ProgramCall:
    return ProgramCall(tool="query_answer", arguments={"question": capital(question), "view": scope_of(place)})


Difficulty = Literal["easy", "medium", "hard"]


def difficulty(calls: Sequence[ProgramCall], size: float, *, swept: bool) -> Difficulty:
    """By rule: what it takes, and how much there is to tell. ``size``: how many things must be told apart."""
    points = (len(calls) > 2) + (len(calls) > 4) + (size > 4) + (size > 9) + swept
    return "easy" if points == 0 else "medium" if points == 1 else "hard"
