"""The contents of a frame: the visible things with their facts, and the texts on them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import lexicon, singular_phrase
from scope_ptz.perception.base import Box
from scope_ptz.simulator.actors import path_position
from scope_ptz.simulator.models import Attribute, SceneActor, SceneFile, SceneInstance
from scope_ptz.simulator.truth import MIN_VISIBLE_PX, Sighting, TextSighting, ViewTruth

NOTICEABLE_PX = 20
"""A thing with at most this many visible pixels is not noticed, so it counts as absent."""

Floats = NDArray[np.float64]

PART_WORDS = (
    " with ",
    " without ",
    " of ",
    " on ",
    " in ",
    " at ",
    " for ",
    " by ",
    " from ",
    " near ",
    " beside ",
    " behind ",
    " to ",
)
"""Words that end the head of a name: "lorry with crane" is a lorry."""
_PARTICIPLE_WITH_OBJECT = re.compile(r" \w+ing (?:an?|the) .*")
"""The end of a name that says what somebody does with a thing: "worker carrying a box" is a worker, not a box."""


@dataclass(frozen=True, slots=True, eq=False)
class Thing:
    """A visible instance.

    Attributes:
        sighting: Position and size of the instance in the frame.
        low_m: Lowest corner of the instance's box in the world.
        high_m: Highest corner of that box.
        concepts: The instance's concept and all kinds that it belongs to.
        motion: "moving" or "stationary".
        texts: The legible texts on it and its parts.
    """

    sighting: Sighting
    low_m: Floats
    high_m: Floats
    concepts: frozenset[str]
    motion: str
    texts: tuple[str, ...] = ()

    @property
    def id(self) -> str:
        return self.sighting.instance.id

    @property
    def name(self) -> str:
        return self.sighting.instance.name or self.sighting.instance.category

    @property
    def category(self) -> str:
        return self.sighting.instance.category

    @property
    def attributes(self) -> Mapping[str, Attribute]:
        return self.sighting.instance.attributes

    @property
    def parent(self) -> str | None:
        instance = self.sighting.instance
        return instance.parent if isinstance(instance, SceneInstance) else None

    @property
    def box(self) -> Box:
        x0, y0, x1, y1 = self.sighting.box
        return Box(x_min=max(x0, 0.0), y_min=max(y0, 0.0), x_max=min(x1, 1.0), y_max=min(y1, 1.0), label=self.name)

    @property
    def point(self) -> tuple[float, float]:
        return self.sighting.point

    @property
    def distance_m(self) -> float:
        return self.sighting.distance_m

    def gap_m(self, other: Thing) -> float:
        """Return the distance in metres between the world boxes of two things."""
        gaps_m = np.maximum(0.0, np.maximum(self.low_m - other.high_m, other.low_m - self.high_m))
        return float(np.linalg.norm(gaps_m))


@dataclass(frozen=True)
class View:
    """Everything visible in a frame. Things are sorted by distance, nearest first."""

    things: tuple[Thing, ...]
    texts: tuple[TextSighting, ...]
    """All texts, including illegible ones, from top to bottom and from left to right."""
    parents: Mapping[str, str]
    """The id of the parent of each instance, for the whole scene."""
    instances: Mapping[str, SceneInstance | SceneActor]
    """Instances by id, for the whole scene."""
    values: Mapping[str, frozenset[str]]
    """The words that occur in each attribute's values, for the whole scene."""
    nouns: frozenset[str] = field(default=frozenset())
    """Nouns that the scene adds to the lexicon."""
    cut_off_text_things: tuple[Thing, ...] = ()
    """Things with legible text that are cut off too much to count as visible, such as a sign larger than the frame."""
    unclear: tuple[Thing, ...] = ()
    """Things that are noticeable in the frame, but too small, too hidden or cut off too much to count as visible."""

    @cached_property
    def by_id(self) -> dict[str, Thing]:
        return {thing.id: thing for thing in self.things}

    def belongs(self, part: str, whole: str) -> bool:
        """Return whether ``part`` is the instance ``whole`` or belongs to it, directly or indirectly."""
        current: str | None = part
        while current is not None:
            if current == whole:
                return True
            current = self.parents.get(current)
        return False

    @cached_property
    def concepts(self) -> frozenset[str]:
        """The concepts of all nouns that the scene uses, whether or not the things are in view."""
        table = lexicon()
        return frozenset(k for n in self.nouns if (c := table.concept(n)) for k in table.kinds(c))

    def texts_on(self, thing: Thing) -> tuple[TextSighting, ...]:
        """Return the texts on a thing and its parts, from top to bottom and from left to right."""
        return tuple(t for t in self.texts if self.belongs(t.text.parent, thing.id))

    def with_cut_off_texts(self) -> View:
        """Return a view whose things also include ``cut_off_text_things``, for questions about text."""
        return replace(self, things=(*self.things, *self.cut_off_text_things))

    def with_unclear(self) -> View:
        """Return a view whose things also include the unclear ones, to find out whether a description may match more things."""
        return replace(self, things=(*self.things, *self.unclear), unclear=())

    @cached_property
    def with_surfaces(self) -> View:
        """A view whose things also include the surfaces in the picture of which the frame shows only a part.

        Where somebody stands on a path, the path is in the picture, wherever the rest of it is.
        """
        surfaces = [t for t in self.unclear if "surface" in t.concepts and t.sighting.pixels >= MIN_VISIBLE_PX]
        return replace(self, things=(*self.things, *surfaces)) if surfaces else self

    def top_level(self) -> tuple[Thing, ...]:
        """Return the things that are not parts of another visible thing."""
        return tuple(t for t in self.things if t.parent is None or t.parent not in self.by_id)


@dataclass(frozen=True, slots=True, eq=False)
class SceneFacts:
    """The facts that all views of a scene share. The attributes have the same meaning as in ``View``."""

    file: SceneFile
    parents: Mapping[str, str]
    instances: Mapping[str, SceneInstance | SceneActor]
    values: Mapping[str, frozenset[str]]
    nouns: frozenset[str]
    concepts: Mapping[str, frozenset[str]]
    """The concepts of each instance, by its id."""


_FACTS_BY_SCENE: dict[int, SceneFacts] = {}
_MAX_SCENES = 32  # the cache is emptied when it contains this many scenes


def scene_facts(scene: SceneFile) -> SceneFacts:
    """Return the facts about a scene. They are computed once for each scene file in memory."""
    cached = _FACTS_BY_SCENE.get(id(scene))
    if cached is None or cached.file is not scene:
        if len(_FACTS_BY_SCENE) >= _MAX_SCENES:
            _FACTS_BY_SCENE.clear()
        cached = _FACTS_BY_SCENE[id(scene)] = _read_facts(scene)
    return cached


def _read_facts(scene: SceneFile) -> SceneFacts:
    objects: list[SceneInstance | SceneActor] = [*scene.instances, *scene.actors]
    values: dict[str, set[str]] = {}
    nouns: set[str] = set()
    for instance in objects:
        nouns |= trades_of(instance)
        nouns |= {singular_phrase(n.lower()) for n in (instance.category, head_of(instance.name)) if n.strip()}
        for key, value in instance.attributes.items():
            values.setdefault(key, set()).update(english.letters(str(value)).split())
    return SceneFacts(
        file=scene,
        parents={i.id: i.parent for i in scene.instances if i.parent},
        instances={i.id: i for i in objects},
        values={k: frozenset(v) for k, v in values.items()},
        nouns=frozenset(nouns),
        concepts={i.id: concepts_of(i) for i in objects},
    )


def read_view(truth: ViewTruth, scene: SceneFile, time_s: float) -> View:
    """Create a frame's view from its ground truth."""
    facts = scene_facts(scene)
    texts = tuple(sorted(truth.texts, key=lambda t: (round(t.box[1], 2), t.box[0])))
    legible: dict[str, list[str]] = {}
    for text in (t for t in texts if t.legible):
        holder: str | None = text.text.parent
        while holder is not None:
            legible.setdefault(holder, []).append(text.text.text)
            holder = facts.parents.get(holder)

    def thing(sighting: Sighting) -> Thing:
        instance = sighting.instance
        low, high = _world_box(instance, time_s)
        concepts = facts.concepts[instance.id]
        return Thing(sighting, low, high, concepts, _motion(instance, time_s), tuple(legible.get(instance.id, ())))

    return View(
        things=tuple(thing(x) for x in truth.visible),
        texts=texts,
        parents=facts.parents,
        instances=facts.instances,
        values=facts.values,
        nouns=facts.nouns,
        cut_off_text_things=tuple(thing(x) for x in truth.sightings if not x.visible and x.instance.id in legible),
        unclear=tuple(thing(x) for x in truth.sightings if not x.visible and x.pixels > NOTICEABLE_PX),
    )


def head_of(name: str) -> str:
    """Return the part of a name that identifies the kind of thing."""
    head = _PARTICIPLE_WITH_OBJECT.sub("", name.lower())
    for word in PART_WORDS:
        head = head.partition(word)[0]
    return head


def trades_of(instance: SceneInstance | SceneActor) -> frozenset[str]:
    """Return the words for the owner of a shop or a surgery, which also name the place: "the butcher" for a butcher's shop."""
    match = _SHOP_OF_TRADE.match(instance.name.lower())
    return frozenset({match["trade"], f"{match['trade']}s", f"{match['trade']}'s"}) if match else frozenset()


_SHOP_OF_TRADE = re.compile(r"(?P<trade>[a-z]+)'s (?:shop|surgery)\b")


def concepts_of(instance: SceneInstance | SceneActor) -> frozenset[str]:
    """Return every concept of an instance: from its category, a more specific kind, and the noun at the end of its name."""
    table = lexicon()
    concepts: set[str] = set()
    if instance.category and (concept := table.concept(instance.category.lower())):
        concepts |= table.kinds(concept)
    for key in ("kind", "type"):
        kind = str(instance.attributes.get(key, "")).lower()
        concept = table.concept(kind) if kind else None
        # A barrier of the kind "pedestrian" is not a pedestrian.
        if concept and (not concepts or (table.kinds(concept) & concepts) - {"thing"}):
            concepts |= table.kinds(concept)
    name = head_of(instance.name).split()
    for start in range(len(name)):
        noun = " ".join(name[start:])
        if concepts and instance.category.lower().endswith(f" {noun}"):
            break  # "lamp" is short for the category, a table lamp, and does not mean a lamp post
        if concept := table.concept(noun):
            concepts |= table.kinds(concept)
            break
    for concept in concepts & _ALSO_SEEN_AS.keys():
        concepts |= table.kinds(_ALSO_SEEN_AS[concept])
    return frozenset(concepts or {"thing"})


_ALSO_SEEN_AS = {"dock light": "traffic light"}
"""Other concepts of which things look like one: a light that shows drivers red or green is taken for a traffic light."""


def _world_box(instance: SceneInstance | SceneActor, time_s: float) -> tuple[Floats, Floats]:
    """Return the lowest and highest corners of a box in the world. An actor's box stands on its path and is not rotated."""
    if isinstance(instance, SceneInstance):
        return np.array(instance.box_min_m), np.array(instance.box_max_m)
    position = path_position(instance, time_s)
    ground_point = np.zeros(3) if position is None else position.position_m
    width, depth, height = instance.size_m
    return ground_point - np.array([width / 2, depth / 2, 0.0]), ground_point + np.array([width / 2, depth / 2, height])


def _motion(instance: SceneInstance | SceneActor, time_s: float) -> str:
    """Return "moving" or "stationary". Only actors move, and only while their path advances."""
    if isinstance(instance, SceneInstance):
        return "stationary"
    now, later = path_position(instance, time_s), path_position(instance, time_s + _MOTION_STEP_S)
    return "moving" if now and later and abs(later.walked_m - now.walked_m) > _MIN_MOTION_M else "stationary"


_MOTION_STEP_S, _MIN_MOTION_M = 0.1, 0.005  # an actor is moving if it moves at least _MIN_MOTION_M metres in _MOTION_STEP_S seconds
