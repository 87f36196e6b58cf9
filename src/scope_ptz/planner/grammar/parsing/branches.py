"""Read conditions with the clauses that are their branches."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace

from scope_ptz.planner.grammar.instruction_tree import (
    AtPlaces,
    Bound,
    Forbid,
    If,
    Linked,
    Step,
)
from scope_ptz.planner.grammar.instruction_tree.conditions import Condition, Negated, PresetOutnumbers, Quantity, Seen, Statement
from scope_ptz.planner.grammar.parsing.clause_reading import ClauseSequenceReader
from scope_ptz.planner.grammar.parsing.compose import compose
from scope_ptz.planner.grammar.parsing.conditions import condition_of, named_thing, without_happening
from scope_ptz.planner.grammar.parsing.parts.clause import Clause, NotUnderstoodError
from scope_ptz.planner.grammar.parsing.parts.courtesy import bare_clause
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.preset_refs import occupied_place, place_asked_about, places_of, without_inner_place
from scope_ptz.planner.grammar.parsing.parts.scopes import split_trailing_place

_PLACE_WITH = "(?P<place>_+?) (has|have|got|shows) (?P<rest>(ATLEAST|MORETHAN|FEWERTHAN|ATMOST|EXACTLY|ANY|NONE) _+|people)"
"""A condition about a preset, such as "the gate has fewer than 3 cars"."""


class BranchReader(ClauseSequenceReader):
    """Reads conditions, with the clauses to carry out when they are met and when they are not."""

    @abstractmethod
    def _linked(self) -> list[Linked]:
        """Return the linked steps of the next clause and of the clauses that belong to it."""

    def _condition(self, clause: Clause, *, is_trailing: bool = False) -> tuple[Condition, tuple]:  # type: ignore[type-arg]
        """Return the condition of a clause, and the presets at which it is tested."""
        clause = replace(clause, lexemes=without_happening(clause.lexemes))
        condition = condition_of(self.reader.source, clause.lexemes)
        if condition is None and clause.marker == "IF":
            condition = named_thing(self.reader.source, clause.lexemes)
        places: tuple = ()  # type: ignore[type-arg]
        rest, found = split_trailing_place(self.reader.source, clause.lexemes)
        owner = full_match(_PLACE_WITH, clause.lexemes)
        if owner and (owners := places_of(self.reader.source, owner["place"])):
            rest, found = tuple(owner["rest"]), owners
        lacking = full_match("(?P<place>_+?) BE (without|clear_of|free_of|clear of|free of) (?P<thing>_+)", clause.lexemes)
        if lacking and (owners := places_of(self.reader.source, lacking["place"])):
            thing = thing_of(self.reader.source, lacking["thing"])
            if thing is not None and thing.text:
                return Seen(thing, Quantity("==", 0)), owners  # "the bus stop is without buses"
        inner = (
            (condition_of(self.reader.source, rest) or named_thing(self.reader.source, rest))
            if found and rest and not isinstance(condition, PresetOutnumbers)
            else None
        )
        if (
            inner is None
            and found
            and rest
            and rest[-1].has("BE")
            and (thing := thing_of(self.reader.source, rest[:-1])) is not None
        ):
            inner = Seen(thing)  # "a van is at the gate"
        if owner and inner is None and found and (thing := thing_of(self.reader.source, owner["rest"])) is not None:
            inner = Seen(thing)  # "the gate has people"
        if owner and inner is None and found and isinstance(condition, Statement):
            places = found  # "the gate has a queue of over 10 cars"
        is_if = clause.marker in {"IF", "WHEN", "UNLESS"}
        source = replace(self.reader.source, has_moved=False) if is_trailing else self.reader.source
        if is_if and isinstance(condition, Statement) and (place := occupied_place(self.reader.source, clause.lexemes)) is not None:
            places = (place,)
        elif (
            is_if
            and isinstance(condition, Statement)
            and found is None
            and (named := place_asked_about(source, clause.lexemes)) is not None
        ):
            places = (named,)  # "if the bus bay is full"
        is_open = condition is None or isinstance(condition, Statement)
        if is_if and is_open and (inside := without_inner_place(self.reader.source, clause.lexemes)):
            inner_source, words, place = inside
            if isinstance(stated := condition_of(inner_source, words), Statement):
                condition, places = stated, (place,)  # "if the barrier at the crossing is up"
        if inner is not None and found is not None:
            condition, places = inner, found
        if condition is None or (isinstance(condition, Seen) and condition.thing.text in {"something", "anything"}):
            raise NotUnderstoodError(clause.lexemes)  # "until something moves" does not say what to look for
        if clause.marker == "UNLESS" or clause.marker == "NEVER":
            condition = Negated(condition)
        return condition, places

    def _conditional(self, clause: Clause) -> Step:
        condition, places = self._condition(clause)
        step = self._branches(condition, clause)
        return AtPlaces(places, (step,)) if places and isinstance(step, If) else step

    def _branches(self, condition: Condition, clause: Clause) -> Step:
        """Return the conditional step whose branches are the clauses that follow."""
        then: list[Step] = []
        if clause.marker in {"IFSO", "IFNOT"} and clause.lexemes:
            then = compose([Linked("", s) for s in self.reader.read(clause.lexemes, has_question_mark=clause.is_question)], then)
        then = self._block(then)
        otherwise: list[Step] = []
        after = self._peek()
        if after is not None and after.marker == "IFNOT" and clause.marker != "IFNOT":
            self._take()
            if after.lexemes:
                otherwise = compose([Linked("", s) for s in self.reader.read(after.lexemes)], otherwise)
            otherwise = self._block(otherwise)
        otherwise = [step for step in otherwise if not isinstance(step, Forbid)]
        if not then:
            raise NotUnderstoodError((clause.opener, *clause.lexemes) if clause.opener else clause.lexemes)
        return If(condition, tuple(then), tuple(otherwise))

    def _block(self, steps: list[Step]) -> list[Step]:
        """Return the given steps, followed by those of the clauses up to the next "otherwise" or the end of the sentence."""
        while (clause := self._peek()) is not None:
            if bound_of(clause) is not None and steps:
                break
            if clause.marker == "IFNOT" or (clause.link == "." and steps) or (clause.marker == "IFSO" and steps):
                break
            if clause.marker in {"IF", "UNLESS"} and steps and clause.link in {",", "and", ".", "then"}:
                break
            steps = compose(self._linked(), steps)
        return steps

    def _with_trailing_condition(self, clause: Clause, steps: tuple[Step, ...]) -> Step:
        """Return the step for "take a picture if ...", with the "otherwise" that may follow."""
        condition, places = self._condition(clause, is_trailing=True)
        otherwise: list[Step] = []
        after = self._peek()
        if after is not None and after.marker == "IFNOT":
            self._take()
            if after.lexemes:
                otherwise = compose([Linked("", s) for s in self.reader.read(after.lexemes)], otherwise)
            otherwise = self._block(otherwise)
        step = If(condition, tuple(compose([Linked("and", s) for s in steps], [])), tuple(otherwise))
        return AtPlaces(places, (step,)) if places else step


def bound_of(clause: Clause) -> Bound | None:
    """Return the loop limit that a clause states: "at most 8 times", "but stop after 5 tries"; None if it states none."""
    lexemes = bare_clause(clause.lexemes)
    if match := full_match(r"(ATMOST|FILLER|but|BUT|to|AMOUNTISH|for|or)* (?P<number>NUM) (DEG) (FILLER|INTURN|of turn)*", lexemes):
        return Bound(degrees=abs(match["number"][0].value)) if any(x.has("ATMOST") for x in lexemes) else None
    if match := full_match(
        (
            r"(ATMOST|up to|BUT|HALT|HALT-ING|after|FILLER|but|or|of)+ ((?P<number>NUM)|(?P<twice>TWICE)|"
            r"(?P<thrice>THRICE)|(?P<once>once)) (X|TRIES|STEPNOUN|TURNNOUN|FILLER|max|ATMOST|INTURN|PAN-S)*|"
            r"(?P<late>NUM) (X|TRIES|STEPNOUN) (max|ATMOST|maximum|FILLER)+"
        ),
        lexemes,
    ):
        number = match["number"] or match["late"]
        return Bound(
            moves=max(1, round(number[0].value) if number else 2 if match.has("twice") else 3 if match.has("thrice") else 1)
        )
    return None
