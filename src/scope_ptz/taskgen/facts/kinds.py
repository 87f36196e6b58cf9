"""Kinds of objects that a question can be about, and rules for objects that people might count as another kind.

For example, people disagree about whether a litter bin is a recycling bin. If a view contains an object that people could disagree
about, no task asks about that kind. Every expected number is therefore unambiguous.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from scope_ptz.simulator.models import SceneActor, SceneInstance

GROUPS: dict[str, frozenset[str]] = {
    "person": frozenset({
        "person", "worker", "pedestrian", "passenger", "shopper", "child", "guard", "busker", "stallholder", "waiter", "customer",
        "security guard", "street performer", "musician", "police officer", "banksman",
    }),
    "vehicle": frozenset({
        "car", "taxi", "van", "lorry", "bus", "pickup truck", "police car", "ambulance", "fire engine", "articulated lorry",
        "coach", "minibus", "truck",
    }),
}  # fmt: skip
"""Groups of categories by name, each with the categories that certainly belong to it."""

SIGNS = frozenset({
    "sign", "message sign", "arrow board", "board", "notice", "poster", "banner", "a-board", "shop sign", "no entry sign",
    "tram stop sign", "taxi sign", "menu board", "headline board", "map board", "timetable", "signpost", "price card",
    "departures board", "street name sign", "bus stop", "bus stop flag", "hanging sign", "information board", "warning sign",
    "notice board", "advertising column", "billboard", "bus stop sign", "wayfinding sign", "safety sign", "gantry", "plate",
    "traffic sign", "road sign", "street sign", "parking sign", "estate agent board", "for sale board", "label", "placard",
    "speed sign", "dock number", "bay number", "pavement board", "wall sign", "window notice", "door sign", "company board",
})  # fmt: skip
"""Categories that people could call a sign."""

TEXT_CATEGORIES = SIGNS | {"vending machine", "ticket machine", "dock number", "bay number"}
"""Categories that people recognise only from the side with the lettering."""

UNRECOGNISABLE_CATEGORIES = frozenset({
    "cabinet", "generator", "liquid container", "bike stand", "gas cage", "lane signal", "parking meter", "dock light",
    "camera pole",
})  # fmt: skip
"""Plain boxes, poles and lamps that people cannot recognise from a distance. No task asks about them."""

INCOMPLETE_CATEGORIES: Mapping[str, frozenset[str]] = {
    "highway-works": frozenset({"roller door", "door", "dock door", "window", "pallet"}),
    "station-square": frozenset({"awning"}),
    "freight-yard": frozenset({"roller door"}),
}
"""Categories for which the ground truth does not contain every visible object, by scene.

Some of these objects belong to the backdrop, to larger objects or to stacks, so people would disagree about their number.
"""

_CONFUSED_CATEGORIES: tuple[frozenset[str], ...] = (
    GROUPS["person"] | {"cyclist", "driver", "mannequin", "statue"},
    GROUPS["vehicle"] | {
        "tram", "train", "bicycle", "cargo bike", "motorcycle", "scooter", "trailer", "excavator", "roller", "forklift", "tractor",
        "tug", "terminal tractor", "reach stacker", "road sweeper", "cyclist", "locomotive", "wagon", "railway wagon", "vehicle",
        "shunter",
    },
    frozenset({"lorry", "truck", "pickup truck", "articulated lorry", "trailer", "van", "terminal tractor", "container lorry"}),
    frozenset({"bicycle", "cargo bike", "motorcycle", "scooter", "cyclist"}),
    SIGNS,
    frozenset({"car", "taxi", "police car"}),
    frozenset({"bus", "coach", "minibus"}),
    frozenset({"tram", "train", "locomotive", "wagon", "railway wagon"}),
    frozenset({"bin", "litter bin", "wheelie bin", "recycling bin", "post box", "grit bin", "bottle bank", "dustbin", "waste bin"}),
    frozenset({"bag", "backpack", "suitcase", "handbag", "rucksack", "bin bag", "shopping bag", "sack", "rubbish bag"}),
    frozenset({"planter", "flower pot", "plant pot", "flower bed", "flower box", "pot", "window box", "flower tub", "potted tree"}),
    frozenset({"flower bucket", "bucket", "pot"}),
    frozenset({"lamp post", "tram pole", "camera pole", "pole", "lamp", "lantern", "street lamp", "light tower", "floodlight",
               "lighting mast", "flagpole", "signpost", "traffic light", "floodlight mast", "light", "lighting tower",
               "bollard light", "wall lamp", "camera mast"}),
    frozenset({"bollard", "marker post", "post", "traffic post"}),
    frozenset({"kiosk", "market stall", "portable toilet", "stall", "stand", "gazebo", "tent", "ticket kiosk"}),
    frozenset({"crate", "box", "carton", "case", "parcel", "cardboard box", "pallet box", "package", "chest", "stillage"}),
    frozenset({"bench", "chair", "seat", "stool"}),
    frozenset({"awning", "canopy", "sunshade"}),
    frozenset({"parasol", "umbrella", "sunshade"}),
    frozenset({"hand cart", "luggage trolley", "trolley", "cart", "sack truck", "pallet truck", "roll cage", "pram", "pushchair",
               "shopping trolley", "wheelbarrow", "hand truck"}),
    frozenset({"barrier", "guardrail", "fence panel", "railing", "crash barrier", "concrete block", "fence", "gate", "boom gate",
               "barrier gate", "boom barrier", "pedestrian barrier", "barrier arm"}),
    frozenset({"traffic cone", "cone", "bollard"}),
    frozenset({"drum", "barrel", "oil drum", "keg", "cask", "cable drum", "tank"}),
    frozenset({"cabinet", "utility box", "electricity box", "junction box", "control box", "electrical cabinet", "green box"}),
    frozenset({"cabin", "portable toilet", "container", "shed", "hut", "gatehouse", "kiosk", "portable cabin",
               "site office", "office"}),
    frozenset({"container", "shipping container", "skip", "tank container", "swap body"}),
    frozenset({"pallet", "pallet stack", "stack of pallets", "stack"}),
    frozenset({"bird", "pigeon", "gull", "seagull", "crow", "sparrow"}),
    frozenset({"statue", "plinth", "fountain", "monument", "sculpture"}),
    frozenset({"drain", "manhole cover", "tree grate", "grate", "drain cover", "hatch", "gully"}),
    frozenset({"clock", "watch", "sundial"}),
    frozenset({"camera", "camera pole", "security camera", "camera mast"}),
    frozenset({"tree", "bush", "shrub", "potted tree", "topiary"}),
    frozenset({"forklift", "reach truck", "order picker", "forklift truck", "reach stacker", "telehandler"}),
    frozenset({"excavator", "digger", "backhoe", "loader", "wheel loader", "mini excavator", "bulldozer"}),
    frozenset({"door", "gate", "roller door", "dock door", "loading dock", "shutter", "dock"}),
    frozenset({"cup", "mug", "glass"}),
    frozenset({"box of fruit", "crate", "produce", "tray"}),
    frozenset({"ladder", "step ladder", "scaffolding"}),
    frozenset({"loaf", "cake", "ham", "produce"}),
    frozenset({"bus stop", "shelter", "bus shelter", "tram shelter", "cycle shelter", "smoking shelter"}),
    frozenset({"traffic light", "beacon", "belisha beacon", "lane signal", "dock light"}),
    frozenset({"manhole", "manhole cover", "drain"}),
    frozenset({"fire hydrant", "fire extinguisher", "fire point"}),
    frozenset({"phone", "phone box", "emergency phone"}),
)  # fmt: skip
"""Groups of categories that people confuse."""

_SIMILAR_COLOURS = (
    {"silver", "grey"}, {"silver", "white"}, {"orange", "yellow"}, {"orange", "red"}, {"cream", "white"}, {"buff", "yellow"},
    {"purple", "pink"}, {"beige", "cream"}, {"beige", "brown"}, {"grey", "black"}, {"navy", "black"}, {"navy", "blue"},
    {"ochre", "yellow"}, {"ochre", "orange"}, {"ochre", "brown"}, {"golden", "yellow"}, {"golden", "brown"}, {"tan", "brown"},
    {"tan", "beige"}, {"turquoise", "blue"}, {"turquoise", "green"}, {"teal", "blue"}, {"teal", "green"}, {"maroon", "red"},
    {"burgundy", "red"}, {"maroon", "brown"}, {"rust", "orange"}, {"rust", "brown"}, {"beige", "white"}, {"amber", "orange"},
    {"amber", "yellow"}, {"rust", "red"}, {"lilac", "purple"}, {"lilac", "pink"},
    {"cream", "grey"}, {"light", "grey", "white"}, {"khaki", "green"}, {"khaki", "brown"},
)  # fmt: skip
"""Sets of words. Two colours are similar if their words together include one of these sets."""

_OPEN_VEHICLES = frozenset(
    {"forklift", "reach truck", "tug", "terminal tractor", "roller", "motorcycle", "scooter", "bicycle", "cyclist"}
)
"""Categories of vehicles whose driver may be visible."""

_OTHER_NAMES = {"car": frozenset({"taxi", "cab"}), "bus": frozenset({"coach", "minibus"})}
"""Words in an object's name that some people would use instead of its category, by category."""

COLOUR_WORDS = frozenset({
    "white", "black", "grey", "silver", "red", "blue", "navy", "green", "yellow", "orange", "brown", "beige", "cream", "buff",
    "pink", "purple", "lilac", "turquoise", "teal", "gold", "golden", "amber", "maroon", "burgundy", "rust", "ochre", "tan",
    "khaki", "bronze",
})  # fmt: skip

SceneThing = SceneInstance | SceneActor


@dataclass(frozen=True)
class Kind:
    """A kind of object: a category or group of categories, optionally with a colour or one other attribute."""

    category: str
    colour: str | None = None
    attribute: tuple[str, str] | None = None

    def fits(self, thing: SceneThing) -> bool:
        """Return whether an object certainly belongs to this kind."""
        facts = thing.attributes
        return (
            not self._has_other_name(thing)
            and thing.category in GROUPS.get(self.category, {self.category})
            and (self.colour is None or own_colour(thing) == self.colour)
            and (self.attribute is None or str(facts.get(self.attribute[0])) == self.attribute[1])
        )

    def _has_other_name(self, thing: SceneThing) -> bool:
        """Return whether some people use another word for an object of this category, such as "taxi" for a car."""
        return thing.category == self.category and bool(
            _OTHER_NAMES.get(self.category, frozenset()) & set(thing.name.lower().split())
        )

    def may_be_driver_of(self, thing: SceneThing) -> bool:
        """Return whether a vehicle may have a visible driver who is of this kind but is not in the ground truth."""
        return self.category in GROUPS["person"] and thing.category in _OPEN_VEHICLES

    def is_ambiguous_with(self, thing: SceneThing) -> bool:
        """Return whether people could count an object as this kind, although it does not fit."""
        if self.fits(thing):
            return False
        if self._has_other_name(thing):
            return True
        if thing.category not in GROUPS.get(self.category, {self.category}):
            words, name = set(self.category.split()), set(f"{thing.category} {thing.name}".lower().split())
            confusable = any({self.category, thing.category} <= group for group in _CONFUSED_CATEGORIES)
            return words <= name or confusable or thing.category.split()[-1] == self.category
        if self.attribute is not None:
            return self.attribute[0] not in thing.attributes
        colour = own_colour(thing) or ""
        return (
            not colour or bool(set((self.colour or "").split()) & set(colour.split())) or are_similar_colours(self.colour, colour)
        )


def own_colour(thing: SceneThing) -> str | None:
    """Return an object's own colour; None if the colour is that of clothes or contents ("planter with red flowers")."""
    colour = thing.attributes.get("colour")
    if not isinstance(colour, str) or thing.category in GROUPS["person"] or not has_colour(thing):
        return None
    words = thing.name.lower().split()
    contents = next((words[index + 1 :] for index, word in enumerate(words) if word in _PREPOSITIONS), [])
    return None if set(colour.split()) & set(contents) else colour


def has_colour(thing: SceneThing) -> bool:
    """Return whether people would describe an object of this category by a single colour."""
    return thing.category not in _COLOURLESS_CATEGORIES


def is_colour_visible(thing: SceneThing) -> bool:
    """Return whether pictures show an object's colour and its name does not reveal the colour.

    Signs, striped objects and open doors do not show a single colour.
    """
    facts = thing.attributes
    is_striped = facts.get("pattern", "plain") != "plain"
    is_open_door = "door" in thing.category and facts.get("state", "closed") != "closed"
    name_reveals_colour = not _COLOURED_MATERIALS.isdisjoint(thing.name.lower().split())
    return thing.category not in SIGNS and not is_striped and not is_open_door and not name_reveals_colour


_COLOURED_MATERIALS = frozenset({"concrete", "aluminium", "steel", "galvanised", "timber", "wooden", "brick"})
"""Materials that reveal an object's colour when they occur in its name."""


_COLOURLESS_CATEGORIES = (SIGNS - {"shop sign", "pavement board", "hanging sign"}) | {
    "cyclist", "driver", "clock", "statue", "fox", "tram", "lorry", "articulated lorry", "charging point", "traffic light",
    "plate compactor", "belisha beacon",
}  # fmt: skip
"""Categories that people would not describe by the single colour in the ground truth."""

_PREPOSITIONS = frozenset({"of", "with", "in", "on", "for"})


def are_similar_colours(one: str | None, other: str) -> bool:
    """Return whether two colours are so similar that people disagree about which of them an object has."""
    words = {*(one or "").split(), *other.split()}
    return one is not None and any(words >= pair for pair in _SIMILAR_COLOURS)


COUNTED_STATES: tuple[tuple[str, str, str], ...] = (
    ("person", "state", "sitting"), ("chair", "state", "occupied"), ("chair", "state", "empty"), ("bench", "state", "empty"),
    ("parasol", "state", "open"), ("parasol", "state", "closed"), ("awning", "state", "open"), ("table", "state", "free"),
    ("crate", "state", "empty"), ("market stall", "state", "open"), ("worker", "vest", "orange"), ("worker", "vest", "yellow"),
    ("worker", "helmet", "white"), ("worker", "helmet", "yellow"), ("worker", "helmet", "blue"), ("taxi", "light", "lit"),
    ("skip", "state", "full"), ("skip", "state", "empty"), ("door", "state", "open"), ("dock door", "state", "open"),
    ("dock door", "state", "closed"), ("roller door", "state", "open"), ("roller door", "state", "closed"),
    ("lamp post", "state", "lit"), ("parking space", "state", "empty"), ("parking space", "state", "occupied"),
    ("umbrella", "state", "open"), ("container", "state", "open"),
)  # fmt: skip
"""States that are easy to recognise, so that objects with them can be counted: category, attribute and value."""


def kinds_in(things: Iterable[SceneThing]) -> list[Kind]:
    """Return the kinds to which the given objects belong, in a fixed order: categories with and without colour, groups, states."""
    objects = list(things)
    category_colours = {(t.category, c) for t in objects for c in (None, own_colour(t)) if c is None or " and " not in c}
    category_kinds = [Kind(category, colour) for category, colour in sorted(category_colours, key=str)]
    groups = [Kind(group) for group in GROUPS if Kind(group) not in category_kinds]
    present_groups = [kind for kind in groups if any(kind.fits(thing) for thing in objects)]
    states = [Kind(category, None, (key, value)) for category, key, value in COUNTED_STATES]
    return [*category_kinds, *present_groups, *(kind for kind in states if any(kind.fits(thing) for thing in objects))]
