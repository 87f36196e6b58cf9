"""Resolve the names in an instruction: what pronouns and "one" refer to, and which presets are meant."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.earlier_comparison import EarlierCount, counts_at_presets, last_preset
from scope_ptz.planner.grammar.binding.focus import (
    OF_THEM,
    PERSONAL,
    PLURAL,
    WHICH_ONE,
    Focus,
    foci_of,
    in_plural,
    referent,
    things_named,
    which_one,
)
from scope_ptz.planner.grammar.binding.followups import is_adjective
from scope_ptz.planner.grammar.binding.narrowing import is_region, is_worn, narrowed, with_noun, with_region_noun
from scope_ptz.planner.grammar.binding.noun_heads import (
    bare_noun,
    has_one,
    head_noun,
    is_ranked,
    is_same_kind,
    may_name_person,
    names_person,
    names_several,
    names_vehicle,
    with_ones_replaced,
)
from scope_ptz.planner.grammar.binding.pairs import (
    compared_one,
    members_of,
    names_neighbour,
    neighbour_of,
    other_of,
    pair_in,
    taken_of,
)
from scope_ptz.planner.grammar.binding.preset_matching import match_preset, plausible_name
from scope_ptz.planner.grammar.execution.answer_sentences import noun

if TYPE_CHECKING:
    from scope_ptz.planner.base import PastTurn
    from scope_ptz.tools.arguments import View

_NOT_OBJECTS = frozenset({"nothing", "around", "everywhere", "there", "here", "away", "about"})
_OTHER = re.compile(r"other(?:s| (?P<noun>\w+))", re.IGNORECASE)
_OBJECT_PRONOUN = re.compile(
    r"\b(?:of|to|behind|beside|near|above|below|under|on|in|by|around|with|opposite|from|than) (?P<pronoun>it|him|her|them)$",
    re.IGNORECASE,
)


NUMBER_PLATES = frozenset(
    {"plate", "number plate", "licence plate", "license plate", "registration plate", "registration", "registration number"}
)
"""Names of the part of a vehicle that identifies it."""


class UnresolvedError(Exception):
    """A name cannot be resolved. The message is the question to ask the user."""


@dataclass(slots=True)
class Names:
    """Resolves the names of one instruction.

    Attributes:
        presets: The camera's presets; None if they are unknown, so that names are accepted as written.
        conversation: The earlier turns, to which pronouns may refer.
        antecedent: The description in this instruction that a pronoun refers to; empty if it has named no thing yet.
        preset: The preset that "there" refers to.
        whole_scene: Whether questions are about the whole scene instead of the current view.
        foci: What the earlier turns were about, oldest first; empty once this instruction leaves open what a pronoun refers to.
        earlier_counts: The counts that earlier turns made at presets, oldest first.
    """

    presets: tuple[str, ...] | None
    conversation: tuple[PastTurn, ...] = ()
    antecedent: str = ""
    preset: str = ""
    whole_scene: bool = False
    foci: tuple[Focus, ...] = ()
    earlier_counts: Sequence[EarlierCount] = field(default_factory=tuple)

    def __post_init__(self) -> None:
        self.foci = foci_of(self.conversation)
        self.preset = last_preset(self.conversation)
        self.earlier_counts = counts_at_presets(self.conversation)

    @property
    def topic(self) -> str:
        """The description of the thing that was named last, in this instruction or before; empty if there is none."""
        return self.antecedent or (self.foci[-1].description if self.foci else "")

    def referent(self, pronoun: str) -> str:
        """Return the description that a pronoun refers to; empty if nothing has been named yet.

        Args:
            pronoun: The pronoun in lower case; empty for a thing that is left out, as in "how many?".

        Raises:
            UnresolvedError: The pronoun may refer to several things, or to a person although none has been named.
        """
        if self.antecedent and (pronoun not in PERSONAL or may_name_person(self.antecedent)):
            return self.antecedent
        if not self.foci:
            return ""
        found = referent(self.foci, pronoun)
        if found is None:
            raise UnresolvedError(f"Who do you mean by '{pronoun}'? Please name the person.")
        if pronoun == OF_THEM:
            return found.whole or (in_plural(found.description) if names_person(found.description) else found.description)
        if not pronoun or pronoun in PLURAL:
            return found.description
        if found.is_several:
            raise UnresolvedError(which_one(found))
        return found.one

    def _place_just_visited(self) -> str:
        """Return the place whose preset the last turn went to, without looking for anything; empty if it did something else.

        Only the name of a known kind of place can be what "it" refers to: "car park", but not "overview".
        """
        calls = [o.call for exchange in self.conversation[-1].exchanges for o in exchange.outcomes] if self.conversation else []
        if [call.name for call in calls] != ["go_to_preset"]:
            return ""
        name = str(calls[0].arguments["name"]).replace("-", " ")
        return name if bare_noun(name) == name and lexicon().concept(name) is not None else ""

    def referent_in_question(self, pronoun: str) -> str:
        """Return the description that a pronoun in a question refers to; "it" may be the place that was gone to just before.

        Raises:
            UnresolvedError: The pronoun may refer to several things, or to a person although none has been named.
        """
        place = self._place_just_visited() if pronoun == "it" and not self.antecedent else ""
        return place or self.referent(pronoun)

    def thing(self, thing: ast.Thing) -> ast.Thing:
        """Return a reference to an object with its pronouns resolved, and remember it for later pronouns."""
        if thing.text.lower() in _NOT_OBJECTS:
            raise UnresolvedError(f"What shall I look for {thing.text}?")
        if thing.not_an_object and not (has_one(thing.text) and self.topic):
            raise UnresolvedError(f"I did not understand '{thing.text}'. Which thing do you mean?")
        if has_one(thing.text) and (thing.text.endswith((" one", " ones")) or thing.text.startswith("ones ")) and not self.topic:
            raise UnresolvedError(f"Which things do you mean by '{thing.text}'?")
        if (other := _OTHER.fullmatch(thing.text)) is not None and thing.definite and self.foci:
            self.antecedent = self._other(other["noun"] or "")
            return ast.Thing(self.antecedent, definite=True)
        if (compared := self._compared(thing.text)) is not None:
            self.antecedent = compared
            return ast.Thing(compared, definite=True)
        if self.foci and not self.antecedent and (neighbour := neighbour_of(thing.text, self.foci[-1].one)):
            self.antecedent = neighbour
            return ast.Thing(neighbour, definite=True)
        if names_neighbour(thing.text) and self.topic:
            raise UnresolvedError(f"Which {noun(bare_noun(self.topic), 1)} do you mean? Please describe it.")
        if self.antecedent and not thing.definite and is_adjective(thing.text.lower()):
            self.antecedent = narrowed(self.antecedent, thing.text)  # "how many barrels are blue and how many red?"
            return replace(thing, text=self.antecedent)
        if thing.text:
            text = self._with_owner(replace(thing, text=self._with_object(self._with_noun(thing.text))))
            self.antecedent = text
            return replace(thing, text=text)
        self._ask_about_none(thing)
        if not (description := self._narrowed_group(thing)):
            if thing.pronoun in PERSONAL:
                raise UnresolvedError(f"Who do you mean by '{thing.pronoun}'? Please name the person.")
            word = thing.pronoun if thing.pronoun and self.conversation else "it"
            raise UnresolvedError(f"What do you mean by '{word}'? Please name the thing.")
        predicate = with_region_noun(thing.predicate, description)
        self.antecedent = narrowed(description, predicate) if predicate else description
        return ast.Thing(self.antecedent, definite=True)

    def _compared(self, text: str) -> str | None:
        """Return which of two things that the last look compared is "the nearer one"; None for other words.

        Raises:
            UnresolvedError: The answer did not say which one is nearer.
        """
        compared = compared_one(self.foci[-1], text) if self.foci and not self.antecedent and text else None
        if compared == "":
            one, other = self.foci[-1].compared
            raise UnresolvedError(f"{WHICH_ONE}2 do you mean: the {one} or the {other}?")
        return compared

    def _ask_about_none(self, thing: ast.Thing) -> None:
        """Ask what a pronoun means directly after an answer that there is no such thing: "zoom in on him".

        Raises:
            UnresolvedError: The last turn found none.
        """
        last = foci_of(self.conversation[-1:])[-1:]
        if self.antecedent or not self.foci or not thing.pronoun or thing.predicate or not last or last[0].number != 0:
            return
        kind = "Who" if thing.pronoun in PERSONAL else "What"
        named = "person" if kind == "Who" else "thing"
        raise UnresolvedError(f"{kind} do you mean by '{thing.pronoun}'? I found no {last[0].one}. Please name the {named}.")

    def _narrowed_group(self, thing: ast.Thing) -> str:
        """Return the description of the things that a pronoun or a predicate is about.

        "How many are sitting?" is about all the people, although those with helmets were counted last. "In the left half" is a
        part of the picture, so it is about what was counted last.
        """
        if not thing.predicate or thing.pronoun in {"those", "these"}:
            return self.referent(thing.pronoun)
        last = self.foci[-1] if self.foci else None
        if not self.antecedent and not thing.pronoun and last is not None and last.look == "query_answer":
            return last.description  # "and on the right?" after a question about a sign
        described = self.referent(OF_THEM)
        if self.antecedent or not self.foci or not is_region(thing.predicate):
            return described
        found = referent(self.foci, OF_THEM)
        return found.description if found is not None else described

    def _other(self, named: str) -> str:
        """Return the description of "the other one": of two things that were named, the one that is not looked at now.

        Args:
            named: The noun after "other": "dog", "one", or nothing in "the others".

        Raises:
            UnresolvedError: It is not clear which thing is meant.
        """
        current = self.antecedent or self.foci[-1].description
        kind = head_noun(noun(current if named in {"", "one", "ones"} else named, 1))
        things = dict.fromkeys(thing.lower() for thing in things_named(self.conversation))
        others = [thing for thing in things if thing != current.lower()]
        group = next((f for f in reversed(self.foci) if f.is_several and is_same_kind(f.description, current)), None)
        is_of_many = group is not None and (group.number or 0) > 2
        last = self.foci[-1]
        if last.is_chosen and not self.antecedent:
            is_of_many = (self.foci[-2].number or 0) > 2  # the camera chose it among several
        is_kind = not is_of_many and (named == "one" or (len(others) == 1 and head_noun(others[0]) == kind))
        if is_kind and len(others) == 1 and current.lower() in things:
            return others[0]
        is_several = named in {"", "ones"} or names_several(named)
        if is_several and not self.antecedent and isinstance(parse_question(self.foci[-1].question), tree.Read):
            return noun(bare_noun(current), 2)  # the other signs are read with all of them
        if not is_several and (other := self._other_of_two(current, "" if named == "one" else named)):
            return other
        which = f"Which other {noun(bare_noun(current) if named in {'', 'one', 'ones'} else named, 2 if is_several else 1)}"
        how = "Please describe them." if is_several else "For example, the left one, the right one or the nearest one."
        raise UnresolvedError(f"{which} do you mean? {how}")

    def _other_of_two(self, current: str, kind: str) -> str:
        """Return the other one of two things that were counted or listed; empty if there are no two.

        Args:
            current: What is spoken of now.
            kind: The noun after "other"; empty for "the other one".

        Raises:
            UnresolvedError: It is not clear which of the two is meant.
        """
        index = self._pair_with(current, kind)
        if index is None:
            return ""
        pair = self.foci[index]
        taken = taken_of(self.foci, index, self.antecedent)
        if taken and (other := other_of(pair, taken)):
            return other
        one, other = members_of(pair)
        raise UnresolvedError(f"{WHICH_ONE}2 do you mean: the {one} or the {other}?")

    def _pair_with(self, current: str, kind: str = "") -> int | None:
        """Return the index of the two things to which what is spoken of now belongs; None if it belongs to no two."""
        latest = pair_in(self.foci)
        if not kind and latest is not None and (current in self.foci[latest].members or latest == len(self.foci) - 1):
            return latest
        return pair_in(self.foci, kind or current)

    def _with_noun(self, text: str) -> str:
        """Replace "one" with the last noun: after cars, "the nearest one" means the nearest car."""
        if not has_one(text):
            return text
        if not self.antecedent:
            one = self._ones(text)
            is_group = any(focus.description == one and focus.is_several for focus in self.foci[-2:])
            return with_noun(text, one, is_group=is_group)
        antecedent = self.antecedent
        prepositions = r" (?:on|in|at|by|with|without|near|behind) "
        parts = re.split(rf"{prepositions}| (?:not )?\w+ing ", antecedent)
        is_in_phrase = len(parts) > 1 and re.search(rf"{prepositions}[\w ]*\bones?\b", text) is not None
        head = parts[-1 if is_in_phrase else 0].split(" ")[-1]  # after cars on the red bridge: "cars on the blue one"
        return with_ones_replaced(text, lambda one: noun(head, 2 if one == "ones" else 1)) if head else text

    def _ones(self, text: str) -> str:
        """Return the earlier description to which "one" refers: of a person for "the one with the blue helmet"."""
        wears = is_worn(text)
        meant = [focus for focus in self.foci if not focus.is_chosen]  # "the left one" is one of those among which the camera chose
        people = (focus.description for focus in reversed(meant) if names_person(focus.description))
        return next(people, self.topic) if wears else meant[-1].description if meant else self.topic

    def _with_object(self, text: str) -> str:
        """Replace a pronoun after a preposition by an earlier thing: "man next to it" becomes "man next to the van"."""
        match = _OBJECT_PRONOUN.search(text)
        if match is None or self.antecedent or not self.foci:
            return text
        described = self.referent(match["pronoun"].lower())
        if text.lower().startswith(f"{described.lower()} "):  # "stall next to the stall" would describe the stall itself as well
            raise UnresolvedError(f"Which other {described} do you mean? Please describe it.")
        return f"{text[: match.start('pronoun')]}the {described}"

    def _with_owner(self, thing: ast.Thing) -> str:
        """Return the description of a part of an earlier thing: "its sign" becomes "sign of the post office"."""
        if thing.text.lower() in NUMBER_PLATES and not self.antecedent and (owner := self._owner_of_plate()):
            return f"{thing.text} of the {owner}"
        if not thing.owner or self.antecedent or not self.foci:
            return thing.text
        return f"{thing.text} of the {self.referent(thing.owner)}"

    def _owner_of_plate(self) -> str:
        """Return the one vehicle that was looked at last, whose number plate is meant; empty if it is not clear which one.

        After a close-up of the farthest car, that car is in the middle of the picture, and another one may now be the farthest.
        """
        last = self.foci[-1] if self.foci else None
        has_moved = bool(self.conversation) and not foci_of(self.conversation[-1:])
        if last is None or has_moved or last.is_several or not names_vehicle(last.one):
            return ""
        is_centred = last.look == "zoom_to_object" and is_ranked(last.one)
        return f"{bare_noun(last.one)} in the middle" if is_centred else last.one

    def place(self, ref: ast.PresetRef) -> ast.PresetRef:
        """Return a reference with the exact name of the preset that it means."""
        preset = self.find_place(ref)
        if preset is None:
            if self.presets is None:
                raise UnresolvedError(f"I did not understand '{ref.name}' as the name of a preset. Which one do you mean?")
            known = ", ".join(self.presets) or "none"
            raise UnresolvedError(f"There is no preset '{ref.name}'. Presets: {known}. Which one do you mean?")
        self.preset = preset
        return ast.PresetRef(preset, explicit=True)

    def find_place(self, ref: ast.PresetRef) -> str | None:
        """Return the name of the preset that a reference means; None if there is no such preset."""
        if self.presets is None:
            if not ref.explicit and not plausible_name(ref.name):
                return None
            return ref.name if ref.number is None else ref.name.replace(" ", "-")
        named = match_preset(ref.name, self.presets)
        if named or ref.number is None:
            return named
        index = ref.number - 1 if ref.number > 0 else len(self.presets) + ref.number
        return self.presets[index] if 0 <= index < len(self.presets) else None

    def _places(self, refs: tuple[ast.PresetRef, ...]) -> tuple[ast.PresetRef, ...]:
        if not refs:
            if not self.presets:
                raise UnresolvedError("Which presets do you mean? I know of none.")
            return tuple(ast.PresetRef(name, explicit=True) for name in self.presets)
        return tuple(self.place(ref) for ref in refs)

    def _view(self, view: View | None) -> View:
        return view or ("full" if self.whole_scene else "current")
