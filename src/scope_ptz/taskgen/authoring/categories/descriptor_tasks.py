"""Descriptor tasks: colour, clothing, state, material and kind of an object, presence, and which of several kinds are there."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

from scope_ptz.bench.tasks.expected import Choice, NameSet, Options
from scope_ptz.taskgen.authoring.categories import descriptor_pairs
from scope_ptz.taskgen.authoring.drafts import Question, TaskDraft, evidence_view, query_call, scope_of
from scope_ptz.taskgen.authoring.noun_phrases import (
    colour_options,
    join_names,
    object_words,
    plain_colour,
    plural_noun,
    singular_noun,
    with_article,
)
from scope_ptz.taskgen.authoring.object_names import NamedThing, extreme_things, named_things, unique_things
from scope_ptz.taskgen.authoring.task_places import TaskPlace
from scope_ptz.taskgen.authoring.view_contents import absent_kinds, category_counts, scene_kinds_first
from scope_ptz.taskgen.facts.kinds import COLOUR_WORDS, SceneThing, is_colour_visible, own_colour

STATES: tuple[tuple[str, ...], ...] = (
    ("open", "closed"), ("lit", "unlit"), ("full", "empty"), ("occupied", "free"), ("occupied", "empty"), ("standing", "sitting"),
)  # fmt: skip
"""Pairs of opposite states. A question about a state offers both."""

_SYNONYMS = {
    "closed": ("shut",),
    "lit": ("on", "switched on", "lit up"),
    "unlit": ("off", "switched off", "dark", "not lit"),
    "suv": ("SUV", "4x4"),
    "hatchback": ("hatch",),
    "saloon": ("sedan",),
    "estate": ("station wagon",),
    "timber": ("wood", "wooden"),
    "steel": ("metal",),
    "metal cladding": ("metal",),
    "brick": ("bricks",),
    "full": ("filled", "loaded"),
    "free": ("unoccupied", "empty", "vacant"),
    "occupied": ("taken", "in use"),
    "sitting": ("seated",),
    "cartons": ("carton", "cardboard boxes", "boxes"),
    "pallet of cartons": ("cartons", "cardboard boxes", "boxes"),
    "phone": ("mobile", "mobile phone"),
    "broom": ("brush",),
}
AttributeValues = Mapping[tuple[str, str], Sequence[str]]
"""The attribute values in the scenes, by category and attribute."""


def attribute_values(things: Sequence[SceneThing]) -> AttributeValues:
    """Return the attribute values of the given objects, by category and attribute."""
    values_by_key: dict[tuple[str, str], set[str]] = {}
    for thing in things:
        for key, value in thing.attributes.items():
            if isinstance(value, str) and value and " and " not in value:
                values_by_key.setdefault((thing.category, key), set()).add(value)
    return {key: sorted(values) for key, values in values_by_key.items()}


def answer_options(values: Sequence[str]) -> Options:
    """Return the values as answer options, with those synonyms that do not equal another value."""
    return {value: tuple(word for word in _SYNONYMS.get(value, ()) if word not in values) for value in values}


def options_with(value: str, values: Sequence[str], category: str) -> Options:
    """Return the answer options for a question whose correct answer is ``value``.

    Values with the same meaning share an option, such as "road" and "road bicycle", or "iron" and "cast iron".
    """
    same: dict[str, set[str]] = {value: set()}
    for other in values:
        equivalent = next((name for name in same if _is_equivalent(name, other, category)), other)
        same.setdefault(equivalent, set()).update({other, other.removesuffix(f" {category}")} - {equivalent})
    return {name: (*words, *sorted(same[name] - {*words})) for name, words in answer_options(list(same)).items()}


def _is_equivalent(one: str, other: str, category: str) -> bool:
    """Return whether two values mean the same because one only adds words to the other."""
    short, long = sorted((one.removesuffix(f" {category}"), other.removesuffix(f" {category}")), key=len)
    return short == long or long.endswith(f" {short}")


def drafts(place: TaskPlace, nouns: frozenset[str], values: AttributeValues, rng: random.Random) -> list[TaskDraft]:
    """Return drafts that ask for attributes of the objects at a place."""
    return [
        *_attribute_drafts(place, values), *_list_drafts(place, nouns, rng), *descriptor_pairs.drafts(place, nouns, rng),
    ]  # fmt: skip


def _attribute_drafts(place: TaskPlace, values: AttributeValues) -> Iterator[TaskDraft]:
    """Yield questions about one attribute of one object."""
    named = [*unique_things(place.truth, coloured=False, min_pixels=300), *named_things(place.truth, 300)]
    if not place.swept:
        named += list(extreme_things(place.truth, 300))
    for target in named:
        yield from _colour_drafts(place, target)
        yield from _clothes_drafts(place, target)
        yield from _state_drafts(place, target)
        yield from _other_attribute_drafts(place, target, values)


def _colour_drafts(place: TaskPlace, target: NamedThing) -> Iterator[TaskDraft]:
    colour = plain_colour(own_colour(target.thing.instance))
    in_name = {colour, str(target.thing.instance.attributes.get("colour"))} & set(target.name.split())
    if colour is not None and is_colour_visible(target.thing.instance) and not in_name:
        yield _choice_draft(place, target, "colour", Choice(value=colour, options=colour_options()), _COLOUR_FORMS)


def _clothes_drafts(place: TaskPlace, target: NamedThing) -> Iterator[TaskDraft]:
    """Yield questions about the colours of clothes and umbrellas."""
    facts = target.thing.instance.attributes
    for key, garment, verb in _GARMENTS:
        garment_colour = plain_colour(facts.get(key))
        if (
            garment_colour is not None
            and target.thing.pixels >= _GARMENT_PX
            and not {garment_colour, str(facts.get(key))} & set(target.name.split())
        ):
            forms = (
                (f"what colour {garment} is {{n}} {verb}?", f"what colour {garment} {{n}} is {verb}"),
                (
                    f"what is the colour of the {garment} that {{n}} is {verb}?",
                    f"the colour of the {garment} that {{n}} is {verb}",
                ),
            )
            yield _choice_draft(place, target, key, Choice(value=garment_colour, options=colour_options()), forms)


def _state_drafts(place: TaskPlace, target: NamedThing) -> Iterator[TaskDraft]:
    """Yield questions about the state of an object, such as open or closed."""
    facts = target.thing.instance.attributes
    state = facts.get("state")
    for pair in STATES:
        named = {word for value in pair for word in (value, *_SYNONYMS.get(value, ()))} & set(target.name.split())
        if {"lit", "unlit"} & set(pair) and "light" in facts and set(target.name.split()) & COLOUR_WORDS:
            continue  # its colour is that of its light, so its name reveals that it is lit
        min_pixels = _CONTENT_PX if {"full", "empty"} & set(pair) else _STATE_PX
        shows_state = (
            not target.thing.cut
            and target.thing.pixels >= min_pixels
            and target.thing.instance.category not in _INDISTINCT_STATE_CATEGORIES
        )
        if state in pair and not named and shows_state:
            # The order of the two states must be the same in every build, and vary between objects.
            first, second = pair[:: 1 if sum(map(ord, target.thing.instance.id)) % 2 else -1]
            forms = (
                (f"is {{n}} {first} or {second}?", f"whether {{n}} is {first} or {second}"),
                (f"what state is {{n}} in, {first} or {second}?", f"if {{n}} is {first} or {second}"),
            )
            yield _choice_draft(place, target, "state", Choice(value=str(state), options=answer_options(pair)), forms)


def _other_attribute_drafts(place: TaskPlace, target: NamedThing, values: AttributeValues) -> Iterator[TaskDraft]:
    """Yield questions about the kind, material and load of an object, and about what a person carries."""
    category = target.thing.instance.category
    for key, usual_forms in _ATTRIBUTE_FORMS.items():
        if (key == "kind" and category not in _RECOGNISABLE_KINDS) or (key == "material" and category in _PAINTED_CATEGORIES):
            continue
        scene_values = values.get((category, key), ())
        value = target.thing.instance.attributes.get(key)
        if (
            isinstance(value, str)
            and value in scene_values
            and len(choice := options_with(value, scene_values, category)) >= 2
            and target.thing.pixels >= (_CONTENT_PX if key == "load" else _STATE_PX)
            and value not in target.name.lower()
            and value not in _HAND_HIDDEN_OBJECTS
        ):
            forms = _SOLE_OBJECT_FORMS if key == "kind" and target.name == target.kind.category else usual_forms
            yield _choice_draft(place, target, key, Choice(value=value, options=choice), forms)


_COLOUR_FORMS = (
    ("what colour is {n}?", "what colour {n} is"),
    ("what is the colour of {n}?", "the colour of {n}"),
    ("which colour does {n} have?", "which colour {n} has"),
)
_GARMENTS = (
    ("vest", "hi-vis vest", "wearing"),
    ("helmet", "helmet", "wearing"),
    ("coat", "coat", "wearing"),
    ("jacket", "jacket", "wearing"),
    ("umbrella", "umbrella", "holding"),
)
"""The attribute, the noun and the verb of each garment."""

_GARMENT_PX = 500  # minimum number of pixels of a person for questions about clothes

_STATE_PX, _CONTENT_PX = 1200, 2500
"""Minimum number of pixels of an object for questions about its state or material, and about its contents."""

_INDISTINCT_STATE_CATEGORIES = frozenset(
    {"gate", "shop", "kiosk", "charging point", "dock light", "taxi sign", "chimney", "gatehouse"}
)
"""Categories whose state is shown only by a notice, a small lamp or a part that is hard to see."""

_HAND_HIDDEN_OBJECTS = frozenset({"phone"})
"""Carried objects that the hand hides."""

_PAINTED_CATEGORIES = frozenset({"door", "barrier"})
"""Categories whose material is hidden by paint."""

_RECOGNISABLE_KINDS = frozenset({"lorry", "bus", "bicycle", "van", "shop", "container"})
"""Categories whose kinds people can tell apart from any side. Estate cars and off-road cars, for example, are too similar."""

_SOLE_OBJECT_FORMS = (
    ("what kind of {c} can you see?", "what kind of {c} you can see"),
    ("which type of {c} is there?", "which type of {c} is there"),
)
_ATTRIBUTE_FORMS: dict[str, tuple[tuple[str, str], ...]] = {
    "kind": (
        ("what kind of {c} is {n}?", "what kind of {c} {n} is"),
        ("which type of {c} is {n}?", "which type of {c} {n} is"),
    ),
    "material": (
        ("what is {n} made of?", "what {n} is made of"),
        ("what material is {n} made of?", "what material {n} is made of"),
    ),
    "carrying": (
        ("what is {n} carrying?", "what {n} is carrying"),
        ("what does {n} have in their hands?", "what {n} is holding"),
    ),
    "load": (("what is on {n}?", "what is on {n}"), ("what does {n} hold?", "what {n} holds")),
}


def _choice_draft(place: TaskPlace, target: NamedThing, key: str, expected: Choice, forms: Sequence[tuple[str, str]]) -> TaskDraft:
    words = {"n": target.with_the, "c": target.kind.category}
    question = Question(tuple((d.format(**words), i.format(**words)) for d, i in forms))
    item = place.truth.item(target.thing, expected.value)
    return TaskDraft(
        category="descriptor",
        question_type=key,
        key=f"{key}:{target.thing.instance.id}",
        place=place,
        expected=expected,
        question=question,
        evidence=(evidence_view(place, expected, target.words, [item], whole=target.positional and not place.swept),),
        perception_calls=(query_call(question.forms[0][0], place),),
        tags=("attribute", key, scope_of(place)),
        answer_key=expected.value,
    )


def _list_drafts(place: TaskPlace, nouns: frozenset[str], rng: random.Random) -> Iterator[TaskDraft]:
    """Yield questions about which of four kinds are there."""
    present = [kind for kind, _ in category_counts(place.truth)]
    absent = [kind for kind in absent_kinds(place.truth, nouns) if kind.colour is None]
    rng.shuffle(present)
    absent = scene_kinds_first(place, absent, rng)
    for number in (2, 3, 1):
        if len(present) < number or len(absent) < 4 - number:
            continue
        chosen_present, chosen_absent = present[:number], absent[: 4 - number]
        candidates = [*chosen_present, *chosen_absent]
        rng.shuffle(candidates)
        names = [with_article(singular_noun(kind)) for kind in candidates]
        expected = NameSet(
            value=tuple(singular_noun(k) for k in chosen_present), options={singular_noun(k): () for k in candidates}
        )
        items = [place.truth.item(t, True) for k in chosen_present for t in (place.truth.all_of(k) or ())[:1]]
        listed = join_names(names, "or")
        yield TaskDraft(
            category="descriptor",
            question_type="which-of",
            key=f"which-of:{'/'.join(sorted(singular_noun(k) for k in candidates))}",
            place=place,
            expected=expected,
            question=Question(
                (
                    (f"which of these can be seen: {listed}?", f"which of these can be seen: {listed}"),
                    (f"what of the following is there: {listed}?", f"what of the following is there: {listed}"),
                )
            ),
            evidence=(evidence_view(place, expected, object_words(*candidates), items, whole=True),),
            perception_calls=tuple(query_call(f"are there any {plural_noun(k)}?", place) for k in candidates),
            tags=("list",),
            object_count=4,
            answer_key="/".join(expected.value),
        )
