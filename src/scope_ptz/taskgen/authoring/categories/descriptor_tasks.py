"""Descriptors: colour, clothing, state, material and kind of one thing; whether something is there; what of a list is there."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence

from scope_ptz.bench.tasks.expected import Choice, NameSet, Options
from scope_ptz.taskgen.authoring.categories import descriptor_pairs
from scope_ptz.taskgen.authoring.categories.counting_tasks import absent, likely_first, plain_counts
from scope_ptz.taskgen.authoring.drafts import Draft, Question, ask, scope_of, view
from scope_ptz.taskgen.authoring.noun_phrases import about, article, colour_options, listing, many_of, noun_of, plain_colour
from scope_ptz.taskgen.authoring.object_names import Named, by_name, ends, singles
from scope_ptz.taskgen.authoring.task_places import Place
from scope_ptz.taskgen.facts.kinds import COLOUR_WORDS, Thing, colour_shows, own_colour

STATES: tuple[tuple[str, ...], ...] = (
    ("open", "closed"), ("lit", "unlit"), ("full", "empty"), ("occupied", "free"), ("occupied", "empty"), ("standing", "sitting"),
)  # fmt: skip
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
Values = Mapping[tuple[str, str], Sequence[str]]
"""(category, attribute) -> every value that it takes in the scenes."""


def values_of(things: Sequence[Thing]) -> Values:
    found: dict[tuple[str, str], set[str]] = {}
    for thing in things:
        for key, value in thing.attributes.items():
            if isinstance(value, str) and value and " and " not in value:
                found.setdefault((thing.category, key), set()).add(value)
    return {key: sorted(said) for key, said in found.items()}


def options(values: Sequence[str]) -> Options:
    """Each value with further words for it that are not those of another one."""
    return {value: tuple(word for word in _SYNONYMS.get(value, ()) if word not in values) for value in values}


def one_of(value: str, values: Sequence[str], category: str) -> Options:
    """Options of which ``value`` is right. What scenes say in more words elsewhere is no option of its own: a "road bicycle" is a
    "road" one, and "cast iron" is iron."""
    same: dict[str, set[str]] = {value: set()}
    for other in values:
        like = next((known for known in same if _is_same(known, other, category)), other)
        same.setdefault(like, set()).update({other, other.removesuffix(f" {category}")} - {like})
    return {name: (*words, *sorted(same[name] - {*words})) for name, words in options(list(same)).items()}


def _is_same(one: str, other: str, category: str) -> bool:
    """Whether two values say the same, one of them in more words."""
    short, long = sorted((one.removesuffix(f" {category}"), other.removesuffix(f" {category}")), key=len)
    return short == long or long.endswith(f" {short}")


def drafts(place: Place, nouns: frozenset[str], values: Values, rng: random.Random) -> list[Draft]:
    return [
        *_attributes(place, values), *_lists(place, nouns, rng), *descriptor_pairs.drafts(place, nouns, rng),
    ]  # fmt: skip


def _attributes(place: Place, values: Values) -> Iterator[Draft]:
    named = [*singles(place.sight, coloured=False, min_pixels=300), *by_name(place.sight, 300)]
    if not place.swept:
        named += list(ends(place.sight, 300))
    for one in named:
        facts = one.thing.instance.attributes
        colour = plain_colour(own_colour(one.thing.instance))
        if (
            colour is not None
            and colour_shows(one.thing.instance)
            and not {colour, str(facts.get("colour"))} & set(one.name.split())
        ):
            yield _choice(
                place,
                one,
                "colour",
                Choice(value=colour, options=colour_options()),
                (
                    ("what colour is {n}?", "what colour {n} is"),
                    ("what is the colour of {n}?", "the colour of {n}"),
                    ("which colour does {n} have?", "which colour {n} has"),
                ),
            )
        for key, garment, verb in (
            ("vest", "hi-vis vest", "wearing"),
            ("helmet", "helmet", "wearing"),
            ("coat", "coat", "wearing"),
            ("jacket", "jacket", "wearing"),
            ("umbrella", "umbrella", "holding"),
        ):
            worn = plain_colour(facts.get(key))
            if worn is not None and one.thing.pixels >= 500 and not {worn, str(facts.get(key))} & set(one.name.split()):
                yield _choice(
                    place,
                    one,
                    key,
                    Choice(value=worn, options=colour_options()),
                    (
                        (f"what colour {garment} is {{n}} {verb}?", f"what colour {garment} {{n}} is {verb}"),
                        (
                            f"what is the colour of the {garment} that {{n}} is {verb}?",
                            f"the colour of the {garment} that {{n}} is {verb}",
                        ),
                    ),
                )
        state = facts.get("state")
        for pair in STATES:
            told = {word for value in pair for word in (value, *_SYNONYMS.get(value, ()))} & set(one.name.split())
            if {"lit", "unlit"} & set(pair) and "light" in facts and set(one.name.split()) & COLOUR_WORDS:
                continue  # "the green charging point" is one that is lit
            least = _INSIDE_PX if {"full", "empty"} & set(pair) else _STATE_PX
            shows = not one.thing.cut and one.thing.pixels >= least and one.thing.instance.category not in _STATE_HARDLY_SHOWS
            if state in pair and not told and shows:
                # Not always the same one first, but each time the same.
                first, second = pair[:: 1 if sum(map(ord, one.thing.instance.id)) % 2 else -1]
                yield _choice(
                    place,
                    one,
                    "state",
                    Choice(value=str(state), options=options(pair)),
                    (
                        (f"is {{n}} {first} or {second}?", f"whether {{n}} is {first} or {second}"),
                        (f"what state is {{n}} in, {first} or {second}?", f"if {{n}} is {first} or {second}"),
                    ),
                )
        for key, ask_it in _KINDS.items():
            category = one.thing.instance.category
            if (key == "kind" and category not in _OF_KINDS) or (key == "material" and category in _MATERIAL_HARDLY_SHOWS):
                continue
            known = values.get((category, key), ())
            value = facts.get(key)
            if (
                isinstance(value, str)
                and value in known
                and len(choice := one_of(value, known, category)) >= 2
                and one.thing.pixels >= (_INSIDE_PX if key == "load" else _STATE_PX)
                and value not in one.name.lower()
                and value not in _HELD_AT_THE_FACE
            ):
                forms = _ONLY_ONE if key == "kind" and one.name == one.kind.category else ask_it
                yield _choice(place, one, key, Choice(value=value, options=choice), forms)


_STATE_PX, _INSIDE_PX = 1200, 2500
"""What a thing does or is made of is seen on no fewer pixels, nor what is in it."""

_STATE_HARDLY_SHOWS = frozenset({"gate", "shop", "kiosk", "charging point", "dock light", "taxi sign", "chimney", "gatehouse"})
"""Of these a notice or a small lamp says how they are, or which part of them would have to move is hard to see."""

_HELD_AT_THE_FACE = frozenset({"phone"})
"""The hand hides it."""

_MATERIAL_HARDLY_SHOWS = frozenset({"door", "barrier"})
"""Painted or coloured all over."""

_OF_KINDS = frozenset({"lorry", "bus", "bicycle", "van", "shop", "container"})
"""Of these people know kinds apart, from whatever side: not an estate from an off-roader."""

_ONLY_ONE = (
    ("what kind of {c} can you see?", "what kind of {c} you can see"),
    ("which type of {c} is there?", "which type of {c} is there"),
)
_KINDS: dict[str, tuple[tuple[str, str], ...]] = {
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


def _choice(place: Place, one: Named, key: str, expected: Choice, forms: Sequence[tuple[str, str]]) -> Draft:
    words = {"n": one.the, "c": one.kind.category}
    asked = Question(tuple((d.format(**words), i.format(**words)) for d, i in forms))
    item = place.sight.item(one.thing, expected.value)
    return Draft(
        category="descriptor",
        kind=key,
        key=f"{key}:{one.thing.instance.id}",
        place=place,
        expected=expected,
        question=asked,
        evidence=(view(place, expected, one.words, [item], whole=one.place and not place.swept),),
        looks=(ask(asked.forms[0][0], place),),
        tags=("attribute", key, scope_of(place)),
        reads=expected.value,
    )


def _lists(place: Place, nouns: frozenset[str], rng: random.Random) -> Iterator[Draft]:
    """Which of four are there."""
    here = [kind for kind, _ in plain_counts(place.sight)]
    gone = [kind for kind in absent(place.sight, nouns) if kind.colour is None]
    rng.shuffle(here)
    gone = likely_first(place, gone, rng)
    for number in (2, 3, 1):
        if len(here) < number or len(gone) < 4 - number:
            continue
        chosen, rest = here[:number], gone[: 4 - number]
        four = [*chosen, *rest]
        rng.shuffle(four)
        names = [article(noun_of(kind)) for kind in four]
        expected = NameSet(value=tuple(noun_of(k) for k in chosen), options={noun_of(k): () for k in four})
        items = [place.sight.item(t, True) for k in chosen for t in (place.sight.of(k) or ())[:1]]
        listed = listing(names, "or")
        yield Draft(
            category="descriptor",
            kind="which-of",
            key=f"which-of:{'/'.join(sorted(noun_of(k) for k in four))}",
            place=place,
            expected=expected,
            question=Question(
                (
                    (f"which of these can be seen: {listed}?", f"which of these can be seen: {listed}"),
                    (f"what of the following is there: {listed}?", f"what of the following is there: {listed}"),
                )
            ),
            evidence=(view(place, expected, about(*four), items, whole=True),),
            looks=tuple(ask(f"are there any {many_of(k)}?", place) for k in four),
            tags=("list",),
            weight=4,
            reads="/".join(expected.value),
        )
