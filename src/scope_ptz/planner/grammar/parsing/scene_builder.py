"""Build steps about presets, objects and questions from the parse tree."""

# ruff: noqa: ARG002 - all rule methods share one signature

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    CameraState,
    Count,
    GoThere,
    GoToPreset,
    Help,
    Home,
    ListPresets,
    Mention,
    PresetRef,
    Read,
    Rescope,
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
from scope_ptz.planner.grammar.parsing.tree_nodes import Node, TreeVisitor

SCOPES = {"now", "full", "scene"}
_ALL_AROUND = re.compile(r"\b(whole|entire|full) (scene|area|site|panorama|place|surroundings)\b", re.IGNORECASE)
# Lexeme kinds of words that can name an object, besides unknown words.
_NOUNS = frozenset({"CAMERA", "PICTURE", "WHO", "PRESETWORD", "CIRCLE", "SURROUND", "LEVEL", "STEPS", "HOME", "WIDE"})
_SCOPE_WORDS = frozenset({"FULLSCOPE", "NOWSCOPE"})
# Parts of descriptions with their replacements: relative clauses become phrases, and other function words are dropped.
_RELATIVE = (
    (re.compile(r"\b(?:(?:who|that|which) )?(?:are|is|were|was)(?:n['’]?t| not)\b", re.IGNORECASE), "not"),
    (
        re.compile(
            r"\b(?:who|that|which) (?:don['’]?t|do not|doesn['’]?t|does not|have not|haven['’]?t) (?:have|wear)\b", re.IGNORECASE
        ),
        "without",
    ),
    (re.compile(r"\b(?:who|that|which)(?: (?:are|is)|['’](?:re|s)) (?=\w)", re.IGNORECASE), ""),
    (re.compile(r"(?<!\bthat)(?<!\bwho)(?<!\bwhich) (?:have|has) (?=\w)", re.IGNORECASE), " with "),
    (re.compile(r"^(?:me|us) (?:all )?(?:the )?", re.IGNORECASE), ""),
    (re.compile(r"^(?:currently )?visible (?=\w)", re.IGNORECASE), ""),
    (re.compile(r" (?:what|that)$", re.IGNORECASE), ""),
)

if TYPE_CHECKING:
    from scope_ptz.tools.arguments import View
_ASKING = re.compile(r"(?:what|where|which|who|why|how|is|are|does|do)(?:['’]s)?\b", re.IGNORECASE)
_ARTICLE_IN_PHRASE = re.compile(r"^(?:the|this|that) (?=\w+ ?\w)", re.IGNORECASE)
_DURATIONS = {"seconds", "minutes", "part_minute", "minute_and_part", "minutes_seconds", "hours"}


class SceneBuilder(TreeVisitor):
    """Visitor that builds references to presets and objects, and the steps that use them."""

    # Descriptions ------------------------------------------------------------------------------------------------------
    def np(self, node: Node) -> Thing:
        parts = node.branches("words", "relative")
        definite = any(self.words_of(leaf).split()[0] in {"the", "that", "this", "these", "those"} for leaf in node.leaves("DET"))
        leaves = parts[0].all_leaves()
        not_an_object = not any(leaf.kind == "WORD" or self.lexemes[leaf.index].kinds & _NOUNS for leaf in leaves)
        text = described(self.text([leaf for part in parts for leaf in part.all_leaves()]))
        bare = _ARTICLE_IN_PHRASE.sub("", text)  # in "the site office", "the site" is one lexeme
        return Thing(bare, definite=definite or bare != text, not_an_object=not_an_object)

    def thing(self, node: Node) -> Thing:
        result: Thing = self.visit(node.branches()[0])
        return result

    subject = thing

    def pronoun(self, node: Node) -> Thing:
        return Thing()

    def _things(self, node: Node) -> tuple[Thing, ...]:
        return tuple(self.visit(b) for b in node.branches("np", "thing", "pronoun", "subject"))

    def _thing(self, node: Node) -> Thing:
        things = self._things(node)
        return things[0] if things else Thing()

    def _view(self, node: Node) -> View | None:
        names = [b.name for b in node.branches() if b.name in SCOPES]
        return "full" if "full" in names else "current" if "now" in names else None

    # Things ------------------------------------------------------------------------------------------------------------
    def fill_with(self, node: Node) -> Step:
        """Build "zoom in until the truck fills the frame", which is the same as zooming in on it."""
        return ZoomTo(self._thing(node))

    def zoom_to(self, node: Node) -> Step:
        return ZoomTo(self._thing(node))

    def also(self, node: Node) -> Step:
        """Build the second part of "zoom in on the bench, then on the bin", which has no verb.

        The resolver applies the verb of the previous step.
        """
        leaves = node.branches("free_name")[0].all_leaves()
        return GoToPreset(PresetRef(self._free_name(node), has_article=leaves[0].kind == "DET"), "bare")

    def track(self, node: Node) -> Step:
        durations = [self.visit(b) for b in node.branches() if b.name in _DURATIONS]
        if durations and not 0 < durations[0] <= 600:
            return Unclear("I can follow something for at most 600 seconds. How long should I follow it?")
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
            return Unclear("What should I take pictures of, and how many?")
        return Snap(1, self._thing(node))

    # Places ------------------------------------------------------------------------------------------------------------
    def _preset(self, node: Node, how: Any) -> Step:
        return GoToPreset(self.visit(node.branches()[-1]), how)

    def go_preset(self, node: Node) -> Step:
        return self._preset(node, "go")

    def show_preset(self, node: Node) -> Step:
        return self._preset(node, "show")

    def look_preset(self, node: Node) -> Step:
        return self._preset(node, "look")

    def bare_preset(self, node: Node) -> Step:
        return self._preset(node, "bare")

    def use_preset(self, node: Node) -> Step:
        return self._preset(node, "use")

    def go_there(self, node: Node) -> Step:
        return GoThere()

    def named(self, node: Node) -> PresetRef:
        certain = bool(node.leaves("PRESETWORD")) or not node.leaves("DET")
        return PresetRef(self.text(node.leaves("PRESETNAME")), explicit=certain)

    def numbered(self, node: Node) -> PresetRef:
        return PresetRef(self.text(node.all_leaves()), number=round(self.number(node)), explicit=True)

    def marked(self, node: Node) -> PresetRef:
        return PresetRef(self._free_name(node), explicit=True)

    def unmarked(self, node: Node) -> PresetRef:
        return PresetRef(self._free_name(node), has_article=self.text(node.all_leaves()).lower().startswith(("the ", "a ", "an ")))

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
        return WhichPreset(self._thing(winner), self._comparison(winner), self._places(winner), go=True)

    def _comparison(self, node: Node) -> Any:
        return next((b.name for b in node.branches("more", "fewer")), "fewer" if node.has("LESSER", "FEWERTHAN") else "more")

    def _places(self, node: Node) -> tuple[PresetRef, ...]:
        return tuple(
            ref
            for b in node.branches("every_place", "place_list", "named", "numbered", "marked", "unmarked")
            for ref in self._refs(b)
        )

    def _refs(self, node: Node) -> tuple[PresetRef, ...]:
        result = self.visit(node)
        return result if isinstance(result, tuple) else (result,)

    # Counting and asking -----------------------------------------------------------------------------------------------
    def count(self, node: Node) -> Step | tuple[Step, ...]:
        """Build a count. If the last of several descriptions is a question, it becomes a separate step."""
        *things, last = self._things(node)
        if things and _ASKING.match(last.text):
            return (Count(tuple(things), self._view(node)), Ask(last.text + "?", self._view(node)))
        return Count((*things, last), self._view(node))

    def count_pronoun(self, node: Node) -> Step:
        return Count((Thing(),), self._view(node))

    def count_those(self, node: Node) -> Step:
        """Build "how many cars are in the left lane" or "... are red" as a count of a longer description."""
        thing = self._thing(node)
        leaves = node.branches("words")[0].all_leaves()
        rest = self.text(leaves)
        negated = node.has("NOT") or re.search(
            r"n['’]?t$", " ".join(self.words_of(leaf) for leaf in node.leaves("BE") + node.leaves("DO"))
        )
        if not thing.text:
            return Count((Thing(f"{'not ' if negated else ''}{rest} ones"),), self._view(node))
        if any(re.match(r"ha(?:s|ve|sn|ven)\b", self.words_of(leaf)) for leaf in node.leaves("BE")):
            return Count((Thing(f"{thing.text} {'without' if negated else 'with'} {rest}"),), self._view(node))
        adjective = " " not in rest and leaves[0].kind == "WORD" and not rest.endswith("ing") and not negated
        text = f"{rest} {thing.text}" if adjective else f"{thing.text} {'not ' if negated else ''}{rest}"
        return Count((Thing(described(text)),), self._view(node))

    def count_between(self, node: Node) -> Step:
        return Count((Thing(f"{self._thing(node).text} {self.text(node.branches('between')[0].all_leaves())}"),), self._view(node))

    def count_parts(self, node: Node) -> Step:
        """Build "how many windows does the building have"."""
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
        lead = [leaf for leaf in leaves[:4] if leaf.kind in _SCOPE_WORDS or (leaf.kind == "COMMA" and leaf is not leaves[0])]
        asking = leaves[len(lead) :] if leaves[: len(lead)] == lead else leaves
        skip = next((i for i, leaf in enumerate(asking) if leaf.kind not in {"TELL", "CANYOU", "GIVE", "SHOW"}), 0)
        skip = skip if any(leaf.kind != "CANYOU" for leaf in asking[:skip]) else 0
        embedded = skip > 0
        end = self.lexemes[leaves[-1].index].end
        question = self.text(asking[skip:] if embedded else leaves)
        if embedded and re.search(r"\b(if|whether)$", self.words_of(asking[skip - 1])):
            question = f"if {question}"  # "see if" is one lexeme
        views = {kind for leaf in leaves for kind in self.lexemes[leaf.index].kinds}
        full = "FULLSCOPE" in views or _ALL_AROUND.search(question)
        view: View | None = "full" if full else "current" if "NOWSCOPE" in views else None
        return Ask(question + ("?" if self.source[end : end + 3].lstrip().startswith("?") else ""), view, embedded)

    def rescope(self, node: Node) -> Step:
        return Rescope(self._view(node) or "current")

    def mention(self, node: Node) -> Step:
        return Mention(self._thing(node))

    def camera_state(self, node: Node) -> Step:
        return CameraState()

    def help(self, node: Node) -> Step:
        return Help()

    def sweep_for(self, node: Node) -> tuple[Step, ...]:
        return (Sweep(), Count((self._thing(node),), "full"))


def described(text: str) -> str:
    """Return a description without function words and without the verb of its relative clause.

    For example "people that aren't wearing helmets" becomes "people not wearing helmets".
    """
    for pattern, plain in _RELATIVE:
        text = pattern.sub(plain, text)
    return " ".join(text.split())
