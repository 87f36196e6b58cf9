"""Resolve short follow-ups to earlier turns: "and the blue one?", "what about the left one?", "and in the right half?"."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace

from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.question_parser import parse_question
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.asked_things import with_other_predicate, with_other_thing
from scope_ptz.planner.grammar.binding.earlier_comparison import comparison_of_turn
from scope_ptz.planner.grammar.binding.focus import PLURAL, foci_of, latest_counts, like_to_know, things_named, which_one
from scope_ptz.planner.grammar.binding.followups import is_adjective, is_other
from scope_ptz.planner.grammar.binding.names import NUMBER_PLATES, Names, UnresolvedError
from scope_ptz.planner.grammar.binding.narrowing import is_region, narrowed, with_region_noun
from scope_ptz.planner.grammar.binding.noun_heads import has_one, head_noun, is_same_kind, names_person, names_several
from scope_ptz.planner.grammar.binding.pairs import members_of
from scope_ptz.planner.grammar.binding.pending_questions import pending_step, with_thing
from scope_ptz.planner.grammar.binding.preset_matching import match_exactly
from scope_ptz.planner.grammar.execution.answer_sentences import noun

_ONE = re.compile(r"\bone\b", re.IGNORECASE)


@dataclass(slots=True)
class FollowUpSteps(Names):
    """Resolves the steps that repeat the last look of the conversation for something else."""

    @abstractmethod
    def _bind(self, step: ast.Step) -> Sequence[ast.Step]:
        """Return the steps that a step stands for, with all names resolved."""

    @abstractmethod
    def _count(self, step: ast.Count) -> Sequence[ast.Step]:
        """Return a count with its names resolved."""

    def _zooms_on_group(self, pronoun: str) -> Sequence[ast.Step]:
        """Return the close-ups of "zoom in on one of them", for which any will do, and of "both", one after the other.

        Raises:
            UnresolvedError: There are several, and not exactly two, of which the camera can show only one.
        """
        last = self.foci[-1] if self.foci else None
        if last is None or self.antecedent:
            raise UnresolvedError(f"Which {noun(self.topic, 1)} do you mean?")
        if pronoun == "both" and (index := self._pair_with(last.description)) is not None and self._is_still_meant(index):
            one, other = (ast.Thing(thing, definite=True) for thing in members_of(self.foci[index]))
            self.antecedent = other.text
            return [*self._to_group_view(), ast.ZoomTo(one), ast.WiderView(), ast.ZoomTo(other)]
        named = things_named(self.conversation)[-2:]
        if pronoun == "both" and len(named) == 2 and last.one.lower() == named[1].lower():
            one, other = (ast.Thing(thing, definite=True) for thing in named)
            self.antecedent = other.text
            return [*self._to_group_view(), ast.ZoomTo(one), ast.WiderView(), ast.ZoomTo(other)]
        if pronoun == "both":
            group = next((f for f in reversed(self.foci) if f.is_several and is_same_kind(f.description, last.description)), None)
            raise UnresolvedError("Which two things do you mean? Please name them." if group is None else which_one(group))
        self.antecedent = noun(last.description, 1) if last.is_several else last.one
        return [ast.ZoomTo(ast.Thing(self.antecedent, definite=True))]

    def _is_still_meant(self, pair: int) -> bool:
        """Return whether everything that was looked at since two things were found is one of them, so that "both" means these."""
        later, kind = self.foci[pair + 1 :], self.foci[pair].description
        members = self.foci[pair].members
        return all(is_same_kind(focus.description, kind) or focus.description in members for focus in later)

    def _to_group_view(self) -> Sequence[ast.Step]:
        """Return the step that returns from a close-up to the view in which several things were seen, if one of them is meant.

        After a close-up, "the other one" is outside the picture. Things that were seen in the close-up itself are still there.
        """
        close_ups = [i for i, focus in enumerate(self.foci) if focus.look in {"zoom_to_object", "track_object"}]
        if self.antecedent or not close_ups or any(focus.is_several for focus in self.foci[close_ups[-1] + 1 :]):
            return []
        return [ast.WiderView()]

    def _whatabout(self, step: ast.WhatAbout) -> Sequence[ast.Step]:
        if step.thing.text and self.presets and (name := match_exactly(step.thing.text, self.presets)):
            return [ast.GoToPreset(ast.PresetRef(name, explicit=True)), *self._last_question()]
        pending, topic = pending_step(self.conversation, self.presets or ()), self.topic
        if step.thing.predicate and is_region(step.thing.predicate) and not pending:
            if not self.foci and not self._last_question():
                raise UnresolvedError("What would you like to know about that part of the picture?")
            if self._asked_what_is_seen():
                return [ast.Ask(f"what can you see {step.thing.predicate}?", "current")]
        if self.foci and self._is_region_without_noun(step.thing):
            step = ast.WhatAbout(ast.Thing(predicate=step.thing.text))
        if step.thing.predicate and (counted := self._count_before_moves(step.thing.predicate)):
            return self._count(ast.Count((ast.Thing(narrowed(counted, step.thing.predicate)),)))
        if step.thing.predicate and not pending and len(counted_together := self._counted_together()) > 1:
            return self._count(ast.Count(tuple(ast.Thing(narrowed(each, step.thing.predicate)) for each in counted_together)))
        if step.thing.text.lower() in NUMBER_PLATES and not pending:
            return [ast.Read(self.thing(step.thing), self._view(None))]
        if self.foci and not pending and (rephrased := with_other_predicate(self.foci[-1].question, step.thing)):
            return self._bind(ast.Ask(rephrased))
        if (tour := self._tour_for(step.thing)) is not None:
            return self._bind(tour)
        described = self._with_noun_if_bare(step.thing)
        is_pursuit = bool(self.foci) and self.foci[-1].look == "track_object"  # the next thing is followed from where the camera is
        is_among = (has_one(described.text) or is_other(described.text)) and not is_pursuit
        widening = self._to_group_view() if is_among else []
        thing = self.thing(described)
        if not self.conversation:
            return self._count(ast.Count((thing,)))
        if isinstance(pending, ast.ZoomTo) and step.thing.pronoun in PLURAL:
            raise UnresolvedError(which_one(self.foci[-1]) if self.foci else "Which one do you mean? Please describe it.")
        if pending is not None:
            return self._bind(with_thing(pending, thing.text))
        if self.foci and self.foci[-1].look in {"count_objects", "named"} and _ONE.search(step.thing.text):
            raise UnresolvedError(like_to_know(thing.text))  # a count says nothing about one thing
        if step.thing.pronoun == "both" and self.foci and self.foci[-1].look in {"count_objects", "query_answer"}:
            raise UnresolvedError(f"What shall I do with the {thing.text}?")
        if self._says_nothing_about(described, thing):
            return self._count(ast.Count((thing,)))
        return [*widening, self._last_look_at(thing, topic)]

    def _tour_for(self, named: ast.Thing) -> ast.Step | None:
        """Return the question "which presets show ...?" of the last turn about another thing: "and forklifts?"; None for others."""
        if not self.conversation or not named.text or has_one(named.text) or is_other(named.text):
            return None
        last = comparison_of_turn(self.conversation, self.presets or ()) if self.conversation[-1].exchanges else None
        return replace(last, thing=named) if last is not None and last.thing.text else None

    def _says_nothing_about(self, named: ast.Thing, thing: ast.Thing) -> bool:
        """Return whether the last look does not say what to do with a thing that is named by its own noun, so that it is counted.

        That is so for several things after a close-up of one, and after a move for things of another kind: "what about the cars?"
        does not ask for their price because that of the soup was asked for elsewhere.
        """
        last = self.foci[-1] if self.foci else None
        if (
            last is None
            or not named.text
            or has_one(named.text)
            or is_other(named.text)
            or is_same_kind(thing.text, last.description)
        ):
            return False
        if last.look in {"zoom_to_object", "track_object"}:
            return names_several(thing.text)
        has_moved = bool(self.conversation) and not foci_of(self.conversation[-1:])
        return has_moved and last.look == "query_answer" and not isinstance(parse_question(last.question), tree.Exists)

    def _asked_what_is_seen(self) -> bool:
        """Return whether the last look of the conversation was the question what there is to see, which names no thing."""
        last = self._last_question()[:1]
        asked = parse_question(last[0].question) if last and isinstance(last[0], ast.Ask) else None
        return (
            isinstance(asked, tree.Describe) and asked.what is None and not any(isinstance(t, tree.Relation) for t in asked.tests)
        )

    def _counted_together(self) -> tuple[str, ...]:
        """Return the things of several kinds that the last turn counted: cars and vans; nothing if it did anything else."""
        counted = latest_counts(self.conversation[-1:])
        kinds = {noun(head_noun(each), 1) for each in counted}
        return counted if len(kinds) == len(counted) > 1 else ()

    def _with_noun_if_bare(self, thing: ast.Thing) -> ast.Thing:
        """Add the last noun to an adjective: "and the farthest?" after "which car is nearest?" means the farthest car."""
        if " " in thing.text or not self.foci or not is_adjective(thing.text.lower()):
            return thing
        if not thing.definite:
            return ast.Thing(predicate=thing.text)  # "and blue?"
        return replace(thing, text=f"{thing.text} one")

    def _count_before_moves(self, predicate: str) -> str:
        """Return the description of the last count, to which "and in the left half?" refers once the camera has been moved.

        Directly after a question, it repeats the question for a part of the picture. Later on, a question that was asked between
        the count and the move is no longer meant. The description is empty if there is no such count.
        """
        has_moved = bool(self.conversation) and not foci_of(self.conversation[-1:])
        if not has_moved or not is_region(predicate) or not self.foci or self.foci[-1].look != "query_answer":
            return ""
        counts = (focus for focus in reversed(self.foci) if focus.look == "count_objects")
        counted = next(counts, None)
        same = counted is not None and noun(head_noun(counted.description), 1) == noun(head_noun(self.foci[-1].description), 1)
        return counted.description if counted is not None and same else ""

    def _is_region_without_noun(self, thing: ast.Thing) -> bool:
        """Return whether "the bottom right one" is a part of the picture, because the last look was at such a part."""
        description = self.foci[-1].description
        return bool(thing.text) and with_region_noun(thing.text, description) != thing.text

    def _last_look_at(self, thing: ast.Thing, topic: str) -> ast.Step:
        """Return the last count, question, close-up or pursuit, of another thing.

        Args:
            thing: The other thing.
            topic: What the last look was about.
        """
        last = self.foci[-1] if self.foci else None
        match last.look if last else "count_objects":
            case "zoom_to_object":
                return ast.ZoomTo(thing)
            case "track_object":
                return ast.Track(thing, self._last_duration_s())
            case "query_answer" if last is not None:
                question = with_other_thing(last.question, thing.text)
                verb = "are" if names_several(thing.text) else "is"
                is_person = names_person(topic)
                return ast.Ask(question or f"{'Who' if is_person else 'What'} {verb} the {thing.text}?", self._view(None))
            case _:
                return ast.Count((thing,), self._view(None))

    def _last_duration_s(self) -> float:
        """Return for how many seconds the last pursuit of the conversation lasted."""
        outcomes = [o for turn in self.conversation for exchange in turn.exchanges for o in exchange.outcomes]
        durations = (o.call.arguments.get("duration_s") for o in reversed(outcomes) if o.call.name == "track_object")
        return float(next((duration for duration in durations if duration), ast.Track(ast.Thing()).seconds))

    def _last_question(self) -> list[ast.Step]:
        """Return the last count or question of the conversation as a step."""
        for turn in reversed(self.conversation):
            for exchange in reversed(turn.exchanges):
                for outcome in reversed(exchange.outcomes):
                    if outcome.call.name == "count_objects":
                        return [ast.Count((ast.Thing(str(outcome.call.arguments["description"])),), "current")]
                    if outcome.call.name == "query_answer":
                        return [ast.Ask(str(outcome.call.arguments["question"]), "current")]
        return []
