"""Resolve preset names and pronouns, and decide whether questions are about the current view or the whole scene."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from scope_ptz.english import listing
from scope_ptz.english.numerals import ORDINALS
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.binding.asked_things import asked_thing
from scope_ptz.planner.grammar.binding.counting_steps import CountingSteps
from scope_ptz.planner.grammar.binding.earlier_comparison import (
    earlier_winners,
    left_view_won,
)
from scope_ptz.planner.grammar.binding.earlier_moves.commands import standing_command
from scope_ptz.planner.grammar.binding.earlier_moves.continuations import commands_of
from scope_ptz.planner.grammar.binding.elliptic_questions import asks_colour, completed_question, item_of
from scope_ptz.planner.grammar.binding.embedded_questions import direct_question
from scope_ptz.planner.grammar.binding.focus import OF_THEM, PLURAL, foci_of, referent
from scope_ptz.planner.grammar.binding.followups import is_other
from scope_ptz.planner.grammar.binding.names import UnresolvedError
from scope_ptz.planner.grammar.binding.narrowing import without_contradicted
from scope_ptz.planner.grammar.binding.noun_heads import has_one, names_several
from scope_ptz.planner.grammar.binding.offtopic import is_about_the_scene
from scope_ptz.planner.grammar.binding.plain_questions import plain_question
from scope_ptz.planner.grammar.binding.preset_matching import match_preset
from scope_ptz.planner.grammar.binding.question_pronouns import (
    is_impersonal,
    names_other_one,
    with_noun_for_one,
    with_other_one,
    with_referents,
    without_anticipation,
)
from scope_ptz.planner.grammar.binding.question_text import (
    bare_comparison,
    bare_superlative,
    how_many_predicate,
    is_about_the_future,
    is_answered_by_counts,
    is_request_to_describe,
    split_at_preset,
    two_questions,
    with_subject,
)
from scope_ptz.planner.grammar.binding.unknowable import why_not_about_the_scene
from scope_ptz.planner.grammar.binding.whereabouts import report_of_last_following, thing_that_went
from scope_ptz.planner.grammar.execution.answer_sentences import noun
from scope_ptz.planner.grammar.parsing.looks.closeups import FILLS_THE_VIEW
from scope_ptz.planner.grammar.parsing.loops import FOLLOWS_FOR_A_TIME

_THE_THING_AND_IT = re.compile(r"\bthe \w+.*\b(it|they|them)\b")
_RELATIVE_POSITION = re.compile(
    r"(?:(?:just|only|slightly|a (?:bit|little|touch|tad)|right|directly) )*"
    r"((?:to the )?(?:left|right) of|above|below|under|underneath|beneath|over|beyond|past|behind|beside|next to|in front of) \w",
    re.IGNORECASE,
)

_NUMBERED_ONE = re.compile(rf"\b(?:{'|'.join(ORDINALS)}|last) one$", re.IGNORECASE)

_LOOKS = (
    ast.Count,
    ast.Ask,
    ast.Read,
    ast.ZoomTo,
    ast.If,
    ast.Loop,
    ast.AtPlaces,
    ast.WhichPreset,
    ast.FirstWith,
    ast.Compare,
    ast.Track,
    ast.Snap,
)
"""Steps that can find something, to which "if so" can refer."""


_MOVES = (ast.Move, ast.Home, ast.GoToPreset, ast.GoThere, ast.Back, ast.ZoomTo, ast.Track, ast.AtPlaces, ast.Loop, ast.Repeat)


@dataclass(slots=True)
class Resolver(CountingSteps):
    """Resolves the names in the steps of one instruction.

    Attributes:
        must_not_move: Whether the camera must not move.
        has_moved: Whether an earlier step of the instruction moves the camera.
        has_looked: Whether an earlier step looks for something, so that "if so" refers to what it found.
    """

    has_moved: bool = False
    has_looked: bool = False
    must_not_move: bool = False

    def bind(self, steps: Sequence[ast.Step]) -> tuple[ast.Step, ...]:
        """Return the steps with all names resolved.

        Raises:
            UnresolvedError: A name is unclear, and the user must be asked.
        """
        out: list[ast.Step] = []
        for step in steps:
            bound = self._bind(self._completed(step, out))
            self.has_looked = self.has_looked or isinstance(step, _LOOKS)
            self.has_moved = self.has_moved or isinstance(step, _MOVES)
            again = bool(out) and [_target(s) for s in bound] == [_target(out[-1])] != [""]
            out.extend([] if again else bound)  # "find it, zoom in on it" is one request
        return tuple(out)

    def _completed(self, step: ast.Step, before: Sequence[ast.Step]) -> ast.Step:
        """Complete a step that lacks a verb, as in "read the left sign and then the right one", or that tests the last count."""
        last = before[-1] if before else None
        if (
            isinstance(step, ast.If)
            and isinstance(last, ast.Count)
            and (answered := _answered_by(step.condition, last)) is not None
        ):
            return replace(step, condition=answered)
        bare = isinstance(step, ast.GoToPreset) and step.how == "bare" and step.ref.has_article
        if not bare or not isinstance(step, ast.GoToPreset) or (self.presets and self.find_place(step.ref)):
            return step
        thing = ast.Thing(re.sub(r"^(the|an?) ", "", step.ref.name), definite=True)
        if isinstance(last, ast.Read):
            return ast.Read(thing)
        if isinstance(last, ast.ZoomTo):
            return ast.ZoomTo(thing)
        return ast.Count((thing,)) if isinstance(last, ast.Count) else step

    # Steps -------------------------------------------------------------------------------------------------------------
    def _bind(self, step: ast.Step) -> Sequence[ast.Step]:
        if isinstance(step, ast.Unclear):
            raise UnresolvedError(step.question)
        if isinstance(step, ast.Sweep):
            self.whole_scene = True
            return [step]
        if isinstance(
            step, ast.Move | ast.Home | ast.GoToPreset | ast.GoThere | ast.Back | ast.AtPlaces | ast.WhichPreset | ast.FirstWith
        ):
            self.whole_scene = False
        method = getattr(self, f"_{type(step).__name__.lower()}", None)
        return method(step) if method else [step]

    def _home(self, step: ast.Home) -> Sequence[ast.Step]:
        return [ast.Back(to_start=True)] if step.is_start and self._can_return_to_start() else [step]

    def _back(self, step: ast.Back) -> Sequence[ast.Step]:
        return [step if not step.to_start or self._can_return_to_start() else ast.Back()]

    def _can_return_to_start(self) -> bool:
        """Return whether "the start" means the beginning of the conversation, and not that of the instruction or home."""
        return bool(self.conversation) and not self.has_moved

    def _gotopreset(self, step: ast.GoToPreset) -> Sequence[ast.Step]:
        ref = step.ref
        if step.how == "show" and (one := _NUMBERED_ONE.search(ref.name)) is not None and foci_of(self.conversation[-1:]):
            return self._zoomto(ast.ZoomTo(ast.Thing(one[0], definite=True)))  # "show me the first one" of the workers just listed
        if ref.is_first_view and self._can_return_to_start():
            return [ast.Back(to_start=True)]
        preset = self.find_place(ref) if self.presets is not None or step.how in {"go", "use"} or ref.explicit else None
        if step.how == "look" and not ref.explicit and "-" not in ref.name:  # a name with several words can only be the preset's
            return [ast.ZoomTo(self.thing(ast.Thing(ref.name, definite=True)))]
        if step.how == "show" and not ref.explicit and preset is None:
            return [ast.ZoomTo(self.thing(ast.Thing(ref.name)))]
        if step.how == "bare" and preset is None and ref.has_article and self.conversation:
            is_definite = ref.name.lower().startswith("the ")
            return self._whatabout(ast.WhatAbout(ast.Thing(re.sub(r"^(the|an?) ", "", ref.name), definite=is_definite)))
        if step.how == "bare" and preset is None and not ref.explicit:
            raise UnresolvedError(f"I did not understand '{ref.name}'. Please say it another way, or name one of the presets.")
        return [ast.GoToPreset(self.place(ref))]

    def _gothere(self, step: ast.GoThere) -> Sequence[ast.Step]:
        if self.has_compared and step.wanted == self.compared_for:
            return [replace(step, wanted="")]
        if step.wanted in {"more", "fewer"}:
            return [ast.GoToPreset(ast.PresetRef(self._preset_with(step.wanted), explicit=True))]
        if self.has_compared:
            return [step]
        if (winners := earlier_winners(self.conversation, self.presets or ())) is not None:
            if len(winners) != 1:
                raise UnresolvedError(f"Where is 'there'? {listing(winners, 'and')} show the same number.")
            return [ast.GoToPreset(ast.PresetRef(winners[0], explicit=True))]
        if left_view_won(self.conversation, self.presets or ()):
            return [ast.Back()]
        if step.wanted:
            raise UnresolvedError("Where shall I go? Please name a preset, or say what I shall zoom in on.")
        if not self.preset:
            raise UnresolvedError("Where is 'there'? Please name a preset.")
        return [ast.GoToPreset(ast.PresetRef(self.preset, explicit=True))]

    def _snap(self, step: ast.Snap) -> Sequence[ast.Step]:
        if step.of is None:
            return [step]
        if step.of.text and self.presets and match_preset(step.of.text, self.presets):
            return [ast.GoToPreset(self.place(ast.PresetRef(step.of.text))), replace(step, of=None)]
        return [replace(step, of=self.thing(step.of))]

    def _count(self, step: ast.Count) -> Sequence[ast.Step]:
        self.has_counted = True
        return [replace(step, things=tuple(self.thing(t) for t in step.things), view=self._view(step.view))]

    def _ask(self, step: ast.Ask) -> Sequence[ast.Step]:
        if self.has_counted and is_answered_by_counts(step.question):
            return []
        if self.topic and (predicate := how_many_predicate(step.question)):
            return self._count(ast.Count((ast.Thing(pronoun="them", predicate=predicate),), step.view))
        if comparison := bare_comparison(step.question):
            return self._bind(self._earlier_comparison(comparison))
        if went := thing_that_went(step.question):
            if report := report_of_last_following(went, self.conversation):
                return [ast.Reply(report)]
            step = replace(step, question=f"where is {went}?")
        if is_request_to_describe(step.question):
            return [ast.Ask("Describe the scene.", self._view(step.view))]
        if not is_about_the_scene(f"{step.question} {self.topic if 'time' in step.question else ''}"):
            raise UnresolvedError(why_not_about_the_scene(step.question))
        if (two := two_questions(step.question)) is not None:
            return [*self._ask(replace(step, question=two[0])), *self._ask(ast.Ask(two[1], step.view))]
        if is_about_the_future(step.question, embedded=step.embedded):
            raise UnresolvedError("I cannot wait for something to happen. Shall I look for it now?")
        if self.foci and not self.antecedent:
            step = replace(step, question=completed_question(step.question, self.foci[-1]))
        asked, close_up = plain_question(step.question)
        question, place = self._question_and_place(direct_question(asked) if step.embedded else asked)
        widening = self._to_group_view() if names_other_one(question) else []
        question = self._with_names(question)
        asked_about = asked_thing(question)
        self.antecedent = asked_about.description if asked_about else self.antecedent
        zoom = [ast.ZoomTo(self.thing(ast.Thing(close_up, definite=True)))] if close_up and not self.must_not_move else []
        otherwise_at = self.place(step.otherwise_at) if step.otherwise_at and not self.must_not_move else None
        return [*place, *widening, *zoom, ast.Ask(question, self._view(step.view), otherwise_at=otherwise_at)]

    def _with_names(self, question: str) -> str:
        """Return a question with its pronouns and "one" replaced by what they refer to.

        After a thing has been named in the same instruction, a question that names another one keeps its pronoun.
        """
        if (rank := bare_superlative(question)) and (group := self._group()):
            return f"which {noun(group, 1)} is {rank}?"
        question = with_other_one(question, lambda named: self._other(named) if self.foci else "")
        question = with_noun_for_one(without_anticipation(with_subject(question)), self._referent_of_ones)
        return (
            question
            if self.antecedent and _THE_THING_AND_IT.search(question)
            else with_referents(question, lambda pronoun: self._item(question, pronoun) or self._asked(question, pronoun))
        )

    def _asked(self, question: str, pronoun: str) -> str:
        """Return what a pronoun in a question refers to; after "which doors are open?", "are any closed?" is about all."""
        described = self.referent_in_question(pronoun)
        return without_contradicted(described, question) if pronoun == OF_THEM else described

    def _item(self, question: str, pronoun: str) -> str:
        """Return what the people spoken of wear or carry, if a question asks for its colour or says "it"; else nothing."""
        last = self.foci[-1] if self.foci and not self.antecedent else None
        is_meant = pronoun == "it" or (pronoun in PLURAL and asks_colour(question))
        return item_of(last) if last is not None and is_meant else ""

    def _group(self) -> str:
        """Return the description of the things that were named last, if they may be several; otherwise nothing."""
        if self.antecedent or not self.foci:
            return self.antecedent if names_several(self.antecedent) else ""
        last = self.foci[-1]
        return last.description if names_several(last.description) else ""

    def _referent_of_ones(self, pronoun: str) -> str:  # noqa: ARG002 - has the signature of a referent
        last = self.foci[-1] if self.foci and not self.antecedent else None
        return last.whole if last is not None and last.whole and last.number == 0 else self.topic  # the taxis, if none is white

    def _question_and_place(self, question: str) -> tuple[str, list[ast.Step]]:
        """Split a question that ends with a preset ("... at gate?") into the question and a step that goes to the preset."""
        if (split := split_at_preset(question, self.presets or ())) is None:
            return question, []
        self.preset, self.whole_scene = split[1], False
        return split[0], [ast.GoToPreset(ast.PresetRef(self.preset, explicit=True))]

    def _rescope(self, step: ast.Rescope) -> Sequence[ast.Step]:  # noqa: ARG002 - all methods for steps have this signature
        raise UnresolvedError("What shall I look for there?")

    def _report(self, step: ast.Report) -> Sequence[ast.Step]:
        is_about_earlier = step.calculation == "total" and not self.has_counted and self.conversation
        return self._total(ast.Total(())) if is_about_earlier else [step]

    def _forbid(self, step: ast.Forbid) -> Sequence[ast.Step]:
        self.must_not_move = self.must_not_move or step.any_move
        return [step]

    def _mention(self, step: ast.Mention) -> Sequence[ast.Step]:
        self.thing(step.thing)
        return []

    def _read(self, step: ast.Read) -> Sequence[ast.Step]:
        return [ast.Read(self.thing(step.thing), self._view(step.view))]

    def _zoomto(self, step: ast.ZoomTo) -> Sequence[ast.Step]:
        if re.search(r"\b\d[\d.]* ?(?:x|times|%|percent)$", step.thing.text):
            raise UnresolvedError(FILLS_THE_VIEW)
        if re.match(
            r"(?:preset|saved view|stored view|saved position|stored position|bookmark)s?\b", step.thing.text, re.IGNORECASE
        ):
            known = ", ".join(self.presets or ()) or "none"
            raise UnresolvedError(f"I do not know that preset. Presets: {known}. Which one do you mean?")
        if relative := _RELATIVE_POSITION.match(step.thing.text):
            raise UnresolvedError(f"I can centre on a thing, not on what is {relative[1]} it. By how many degrees shall I move?")
        if step.thing.pronoun in {"it", "that"} and not self.antecedent and self._is_about_presets():
            return self._gothere(ast.GoThere("winner"))  # "show me that one" after "which preset has the most?"
        if step.thing.pronoun in {"they", "them", "these", "those"} and not (self.antecedent or step.thing.predicate):
            found = referent(self.foci, step.thing.pronoun)
            if found is not None and (found.number or 0) > 1:
                return self._zooms_on_group("both")  # one close-up does not show them all
        if step.thing.pronoun in {"one", "both"} and self.topic:
            return self._zooms_on_group(step.thing.pronoun)
        widening = self._to_group_view() if has_one(step.thing.text) or is_other(step.thing.text) else []
        return [*widening, ast.ZoomTo(self.thing(step.thing))]

    def _is_about_presets(self) -> bool:
        """Return whether the last turn answered which preset has the most."""
        return earlier_winners(self.conversation, self.presets or ()) is not None

    def _track(self, step: ast.Track) -> Sequence[ast.Step]:
        return [replace(step, thing=self.thing(step.thing))]

    def _doagain(self, step: ast.DoAgain) -> Sequence[ast.Step]:
        command = standing_command(commands_of(self.conversation, self.presets or ()))
        if command is not None and not any(isinstance(s, ast.DoAgain | ast.Unclear) for s in command.steps):
            return self.bind(command.steps * (step.times or 1))
        raise UnresolvedError("What shall I do again?")

    # Nested steps ------------------------------------------------------------------------------------------------------
    def _repeat(self, step: ast.Repeat) -> Sequence[ast.Step]:
        return [replace(step, body=self.bind(step.body))]

    def _eachtime(self, step: ast.EachTime) -> Sequence[ast.Step]:
        return self.bind(step.body)

    def _loop(self, step: ast.Loop) -> Sequence[ast.Step]:
        if any(isinstance(inner, ast.Track) for inner in step.body):
            raise UnresolvedError(FOLLOWS_FOR_A_TIME)
        for inner in step.body:
            named = (
                inner.things[0] if isinstance(inner, ast.Count) else inner.thing if isinstance(inner, ast.ZoomTo) else ast.Thing()
            )
            self.antecedent = named.text or self.antecedent
        until = self.condition(step.until)
        return [replace(step, until=until, body=self.bind(step.body), otherwise=self.bind(step.otherwise))]

    def _if(self, step: ast.If) -> Sequence[ast.Step]:
        for inner in step.then:
            if isinstance(inner, ast.ZoomTo | ast.Track | ast.Read) and inner.thing.text:
                self.antecedent = inner.thing.text
                break
        condition = self.condition(step.condition)
        self.has_looked = True
        return [ast.If(condition, self.bind(step.then), self.bind(step.otherwise))]

    def _atplaces(self, step: ast.AtPlaces) -> Sequence[ast.Step]:
        if isinstance(step.body[0] if step.body else None, ast.WhichPreset):
            return self.bind(
                [replace(s, places=s.places or step.places) if isinstance(s, ast.WhichPreset) else s for s in step.body]
            )
        places = self._places(step.places)
        out: list[ast.Step] = []
        for place in places:
            self.preset = place.name
            body = self.bind(step.body)
            out += [*([] if body[:1] == (ast.GoToPreset(place),) else [ast.GoToPreset(place)]), *body]
        return out

    def _sameat(self, step: ast.SameAt) -> Sequence[ast.Step]:
        if not (body := self._last_question()):
            if not step.or_go or len(step.places) != 1:
                raise UnresolvedError("What shall I do there?")
            return [ast.GoToPreset(self.place(step.places[0]))]
        return self._atplaces(ast.AtPlaces(step.places, tuple(body)))

    def condition(self, condition: ast.Condition) -> ast.Condition:
        """Return a condition with its names resolved."""
        if isinstance(condition, ast.Seen):
            return replace(condition, thing=self.thing(condition.thing), view=self._view(condition.view))
        if isinstance(condition, ast.Readable):
            return ast.Readable(self.thing(condition.thing))
        if isinstance(condition, ast.Statement) and not condition.subject.text and is_impersonal(f"it {condition.predicate}"):
            return replace(condition, subject=ast.Thing("it"))
        if isinstance(condition, ast.Statement) and not condition.subject.text and not self.topic and self.preset:
            self.antecedent = self.preset.replace("-", " ")  # "go to the yard, and if it is empty, go home"
        if isinstance(condition, ast.Statement):
            return replace(condition, subject=self.thing(condition.subject))
        if isinstance(condition, ast.Outnumbers):
            return replace(condition, first=self.thing(condition.first), second=self.thing(condition.second))
        if isinstance(condition, ast.Answered):
            if not self.has_looked:
                raise UnresolvedError("What does 'if so' refer to? Please name what I shall look for first.")
            return condition
        if isinstance(condition, ast.PresetOutnumbers):
            places = self.place(condition.first), self.place(condition.second)
            return replace(condition, thing=self.thing(condition.thing), first=places[0], second=places[1])
        if isinstance(condition, ast.Negated):
            return ast.Negated(self.condition(condition.part))
        joined = replace(condition, parts=tuple(self.condition(part) for part in condition.parts))
        if all(isinstance(part, ast.Seen) for part in joined.parts):
            self.antecedent, self.foci = "", ()  # "if you find a person or a dog, zoom in on it" does not say on which one
        return joined


def _answered_by(condition: ast.Condition, count: ast.Count) -> ast.Condition | None:
    """Return the condition that reuses a count of the same objects: "check for smoke, and if there is smoke, ..."."""
    if not isinstance(condition, ast.Seen) or [thing.text for thing in count.things] != [condition.thing.text]:
        return None
    if condition.view not in (None, count.view):
        return None
    answers: dict[ast.Quantity, ast.Condition] = {
        ast.Quantity(): ast.Answered(), ast.Quantity("==", 0): ast.Negated(ast.Answered())
    }  # fmt: skip
    return answers.get(condition.quantity)


def _target(step: ast.Step) -> str:
    """Return the description of what a step zooms in on; empty for other steps."""
    return step.thing.text if isinstance(step, ast.ZoomTo) else ""
