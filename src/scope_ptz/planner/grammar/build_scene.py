"""Builders for the rules about places, things, questions, conditions and comparisons."""

# ruff: noqa: ARG002 - the methods of rules share one signature

from __future__ import annotations

import re
from typing import Any

from scope_ptz.planner.grammar.syntax import (
    Ask,
    BeforeAfter,
    CameraState,
    Compare,
    Condition,
    Count,
    GoPreset,
    GoThere,
    Help,
    Holds,
    Home,
    Joined,
    ListPresets,
    Negated,
    Outnumbers,
    PresetRef,
    PresetWins,
    Quantity,
    Read,
    Readable,
    Seen,
    Snap,
    Step,
    Sweep,
    Thing,
    Track,
    Unclear,
    WhatAbout,
    WhichPreset,
    ZoomTo,
)
from scope_ptz.planner.grammar.trees import Node, Rules
from scope_ptz.tools.arguments import View

_SCOPES = {"now", "full", "scene"}
_ALL_AROUND = re.compile(r"\b(whole|entire|full) (scene|area|site|panorama|place|surroundings)\b", re.IGNORECASE)
_NOUNS = frozenset({"CAMERA", "PICTURE", "WHO", "PRESETWORD", "CIRCLE", "SURROUND", "LEVEL", "STEPS", "HOME", "WIDE"})
_DURATIONS = {"seconds", "minutes", "part_minute", "minute_and_part", "minutes_seconds", "hours"}


class SceneRules(Rules):
    # Descriptions ------------------------------------------------------------------------------------------------------
    def np(self, node: Node) -> Thing:
        words = node.branches("words")[0]
        determiner = any(self.words_of(leaf).split()[0] in {"the", "that", "this", "these", "those"} for leaf in node.leaves("DET"))
        leaves = words.all_leaves()
        odd = not any(leaf.kind == "WORD" or self.lexemes[leaf.index].kinds & _NOUNS for leaf in leaves)
        return Thing(self.text(leaves), definite=determiner, odd=odd)

    def thing(self, node: Node) -> Thing:
        made: Thing = self.visit(node.branches()[0])
        return made

    subject = thing

    def pronoun(self, node: Node) -> Thing:
        return Thing()

    def _things(self, node: Node) -> tuple[Thing, ...]:
        return tuple(self.visit(b) for b in node.branches("np", "thing", "pronoun", "subject"))

    def _thing(self, node: Node) -> Thing:
        things = self._things(node)
        return things[0] if things else Thing()

    def _view(self, node: Node) -> View | None:
        names = [b.name for b in node.branches() if b.name in _SCOPES]
        return "current" if "now" in names else "full" if "full" in names else None

    # Things ------------------------------------------------------------------------------------------------------------
    def fill_with(self, node: Node) -> Step:
        """ "Zoom in until the truck fills the frame" is what zooming in on it does."""
        return ZoomTo(self._thing(node))

    def zoom_to(self, node: Node) -> Step:
        return ZoomTo(self._thing(node))

    def also(self, node: Node) -> Step:
        """ "Zoom in on the bench, then on the bin": the verb is the one before."""
        leaves = node.branches("free_name")[0].all_leaves()
        return GoPreset(PresetRef(self._free_name(node), determined=leaves[0].kind == "DET"), "bare")

    def track(self, node: Node) -> Step:
        durations = [self.visit(b) for b in node.branches() if b.name in _DURATIONS]
        if durations and not 0 < durations[0] <= 600:
            return Unclear("I can follow something for at most 600 seconds. For how long shall I follow it?")
        return Track(self._thing(node), durations[0] if durations else 10.0)

    track_after = track

    def seconds(self, node: Node) -> float:
        return self.number(node) if node.has("NUM") else 1.0

    def minutes(self, node: Node) -> float:
        return 60.0 * (self.number(node) if node.has("NUM") else 1.0)

    def part_minute(self, node: Node) -> float:
        return 60.0 * self.fraction(node)

    def minute_and_part(self, node: Node) -> float:
        return 60.0 + self.part_minute(node)

    def minutes_seconds(self, node: Node) -> float:
        minutes, seconds = (self.lexemes[leaf.index].value for leaf in node.leaves("NUM"))
        return 60.0 * minutes + seconds

    def hours(self, node: Node) -> float:
        return 3600.0 * (self.number(node) if node.has("NUM") else 1.0)

    def snap(self, node: Node) -> Step:
        return Snap(max(1, min(round(self.number(node)), 50)) if node.has("NUM") else 1)

    def picture_of(self, node: Node) -> Step:
        if node.has("SNAP") and any("PICTURE" in self.lexemes[leaf.index].kinds for leaf in node.all_leaves()[1:]):
            return Unclear("Of what shall I take pictures, and how many?")
        return Snap(1, self._thing(node))

    # Places ------------------------------------------------------------------------------------------------------------
    def _preset(self, node: Node, how: Any) -> Step:
        return GoPreset(self.visit(node.branches()[-1]), how)

    def go_preset(self, node: Node) -> Step:
        return self._preset(node, "go")

    def show_preset(self, node: Node) -> Step:
        return self._preset(node, "show")

    def look_preset(self, node: Node) -> Step:
        return self._preset(node, "look")

    def bare_preset(self, node: Node) -> Step:
        return self._preset(node, "bare")

    def go_there(self, node: Node) -> Step:
        return GoThere()

    def named(self, node: Node) -> PresetRef:
        said = bool(node.leaves("PRESETWORD")) or not node.leaves("DET")
        return PresetRef(self.text(node.leaves("PRESETNAME")), sure=said)

    def numbered(self, node: Node) -> PresetRef:
        return PresetRef(self.text(node.all_leaves()), number=round(self.number(node)), sure=True)

    def marked(self, node: Node) -> PresetRef:
        return PresetRef(self._free_name(node), sure=True)

    def unmarked(self, node: Node) -> PresetRef:
        return PresetRef(self._free_name(node), determined=self.text(node.all_leaves()).lower().startswith(("the ", "a ", "an ")))

    def _free_name(self, node: Node) -> str:
        inner = node.branches("marked_name") or [node]
        return self.text(inner[0].branches("free_name")[0].branches("words")[0].all_leaves())

    def every_place(self, node: Node) -> tuple[PresetRef, ...]:
        return ()

    def place_list(self, node: Node) -> tuple[PresetRef, ...]:
        return tuple(self.visit(b) for b in node.branches())

    def home(self, node: Node) -> Step:
        return Home()

    def list_presets(self, node: Node) -> Step:
        return ListPresets()

    def go_winner(self, node: Node) -> Step:
        winner = node.branches()[0]
        return WhichPreset(self._thing(winner), self._wish(winner), self._places(winner), go=True)

    def _wish(self, node: Node) -> Any:
        return next((b.name for b in node.branches("more", "fewer")), "fewer" if node.has("LESSER", "FEWERTHAN") else "more")

    def _places(self, node: Node) -> tuple[PresetRef, ...]:
        return tuple(
            ref
            for b in node.branches("every_place", "place_list", "named", "numbered", "marked", "unmarked")
            for ref in self._refs(b)
        )

    def _refs(self, node: Node) -> tuple[PresetRef, ...]:
        made = self.visit(node)
        return made if isinstance(made, tuple) else (made,)

    # Counting and asking -----------------------------------------------------------------------------------------------
    def count(self, node: Node) -> Step:
        return Count(self._things(node), self._view(node))

    def count_pronoun(self, node: Node) -> Step:
        return Count((Thing(),), self._view(node))

    def count_those(self, node: Node) -> Step:
        """ "How many cars are in the left lane" or "... are red": the description with what is said of it."""
        thing = self._thing(node)
        leaves = node.branches("words")[0].all_leaves()
        rest = self.text(leaves)
        if not thing.text:
            return Count((Thing(f"{rest} ones"),), self._view(node))
        adjective = " " not in rest and leaves[0].kind == "WORD" and not rest.endswith("ing")
        return Count((Thing(f"{rest} {thing.text}" if adjective else f"{thing.text} {rest}"),), self._view(node))

    def count_parts(self, node: Node) -> Step:
        """ "How many windows does the building have"."""
        part, whole = self._things(node)[:2]
        return Count((Thing(f"{part.text} of the {whole.text}"),), self._view(node))

    def what_about(self, node: Node) -> Step:
        return WhatAbout(self._thing(node))

    def read(self, node: Node) -> Step:
        return Read(self._thing(node), self._view(node))

    def read_all(self, node: Node) -> tuple[Step, ...]:
        return tuple(Read(thing) for thing in self._things(node))

    def read_what(self, node: Node) -> Step:
        return Ask(f"what is {self.text(node.branches('words')[0].all_leaves())}?")

    def read_pronoun(self, node: Node) -> Step:
        return Read(Thing())

    def ask(self, node: Node) -> Step:
        leaves = node.all_leaves()
        skip = 1 if leaves[0].kind == "TELL" and len(leaves) > 1 and leaves[1].kind != "TO" else 0
        end = self.lexemes[leaves[-1].index].end
        question = self.text(leaves[skip:])
        views = {kind for leaf in leaves for kind in self.lexemes[leaf.index].kinds}
        view: View | None = (
            "current" if "NOWSCOPE" in views else "full" if "FULLSCOPE" in views or _ALL_AROUND.search(question) else None
        )
        return Ask(question + ("?" if self.source[end : end + 3].lstrip().startswith("?") else ""), view)

    def camera_state(self, node: Node) -> Step:
        return CameraState()

    def help(self, node: Node) -> Step:
        return Help()

    def sweep_for(self, node: Node) -> tuple[Step, ...]:
        return (Sweep(), Count((self._thing(node),), "full"))

    # Conditions --------------------------------------------------------------------------------------------------------
    def seen(self, node: Node) -> Condition:
        quantity = next(
            (q for b in node.branches() if isinstance(q := self.visit(b) if b.name not in {"np", *_SCOPES} else None, Quantity)),
            Quantity(),
        )
        return Seen(self._thing(node), quantity, self._view(node))

    seen_pronoun = seen
    seen_swapped = seen

    def unseen(self, node: Node) -> Condition:
        return Seen(self._thing(node), Quantity("==", 0), self._view(node))

    unseen_pronoun = unseen

    def unseen_both(self, node: Node) -> Condition:
        return Joined(tuple(Seen(thing, Quantity("==", 0), self._view(node)) for thing in self._things(node)), "all")

    def not_so_many(self, node: Node) -> Condition:
        return Negated(Seen(self._thing(node), self.visit(node.branches("quantity_said")[0].branches()[0]), self._view(node)))

    def readable(self, node: Node) -> Condition:
        return Readable(self._thing(node))

    def holds(self, node: Node) -> Condition:
        return Holds(self._thing(node), self.text(node.branches("words")[0].all_leaves()))

    def holds_not(self, node: Node) -> Condition:
        return Holds(self._thing(node), self.text(node.branches("words")[0].all_leaves()), wanted=False)

    def says(self, node: Node) -> Condition:
        said = self.text(node.branches("words")[0].all_leaves())
        return Holds(self._thing(node), said, question=f"does the {self._thing(node).text} say {said}?")

    def preset_wins(self, node: Node) -> Condition:
        first, second = (self.visit(b) for b in node.branches("named", "numbered", "marked"))
        return PresetWins(self._thing(node), first, second, self._wish(node))

    def outnumbers(self, node: Node) -> Condition:
        first, second = self._things(node)[:2]
        return Outnumbers(first, second, self._wish(node))

    def all_of(self, node: Node) -> Condition:
        return Joined(tuple(self.visit(b) for b in node.branches()), "all")

    def any_of(self, node: Node) -> Condition:
        return Joined(tuple(self.visit(b) for b in node.branches()), "any")

    def _quantity(self, node: Node, operator: Any) -> Quantity:
        return Quantity(operator, self.number(node) if node.has("NUM") else 1)

    def at_least(self, node: Node) -> Quantity:
        return self._quantity(node, ">=")

    def no_more_than(self, node: Node) -> Quantity:
        return self._quantity(node, "<=")

    def more_than(self, node: Node) -> Quantity:
        return self._quantity(node, ">")

    def fewer_than(self, node: Node) -> Quantity:
        return self._quantity(node, "<")

    def exactly(self, node: Node) -> Quantity:
        return self._quantity(node, "==")

    def several(self, node: Node) -> Quantity:
        return Quantity(">=", 2)

    def any_number(self, node: Node) -> Quantity:
        return Quantity()

    # Comparison --------------------------------------------------------------------------------------------------------
    def which_preset(self, node: Node) -> Step:
        return WhichPreset(self._thing(node), self._wish(node), self._places(node))

    def preset_with(self, node: Node) -> Step:
        return WhichPreset(self._thing(node), "more", self._places(node), any_of=True)

    preset_than = more_at = compare_at = compare_at_last = which_preset

    def compare_things(self, node: Node) -> Step:
        first, second = self._things(node)[:2]
        return Compare(first, second, self._wish(node), self._view(node))

    def compare_where(self, node: Node) -> Step:
        thing = self.visit(node.branches("np")[0]).text
        first = self.text(node.branches("near_words")[0].all_leaves())
        side = node.branches("side")[0]
        second = self.text(side.all_leaves())
        if not side.branches("near_words"):
            second = f"{first.split(' ')[0]} {second}"
        return Compare(Thing(f"{thing} {first}"), Thing(f"{thing} {second}"), self._wish(node), self._view(node))

    def before_after(self, node: Node) -> Step:
        moves = self.visit(node.branches("move")[0])
        return moves if isinstance(moves, Unclear) else BeforeAfter(self._thing(node), (moves,), self._wish(node))

    reveals = before_after
