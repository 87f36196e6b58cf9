"""Combine the clauses of an instruction: conditions with their branches, loops with their bodies, and the rest in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.conditions import Answered, Condition, Negated, PresetOutnumbers, Quantity, Seen
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtIntervals,
    AtPlaces,
    Bound,
    Count,
    DoAgain,
    EachTime,
    FirstWith,
    Forbid,
    GoToPreset,
    If,
    Linked,
    Loop,
    Mention,
    Move,
    Read,
    Repeat,
    Report,
    Snap,
    Step,
    Track,
    Turn,
    Unclear,
    Zoom,
    ZoomTo,
)
from scope_ptz.planner.grammar.parsing.asides import (
    elliptical_condition,
    is_courtesy,
    is_need,
    is_reason,
    is_wish,
)
from scope_ptz.planner.grammar.parsing.clause_reading import ClauseReading
from scope_ptz.planner.grammar.parsing.compose import compose
from scope_ptz.planner.grammar.parsing.conditions import condition_of
from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, MOTION_VERBS, Clause, NotUnderstoodError, Source, trimmed
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import places_of
from scope_ptz.planner.grammar.parsing.parts.scopes import place_after
from scope_ptz.planner.grammar.parsing.reader import bare_clause

_PLACE_WITH = "(?P<place>_+?) (has|have|got|shows) (?P<rest>(ATLEAST|MORETHAN|FEWERTHAN|ATMOST|EXACTLY|ANY|NONE) _+|people)"
"""A condition about a preset, such as "the gate has fewer than 3 cars"."""

_LOOKS = (Ask, Count, Read, Snap)
"""Steps that are carried out at each of several presets visited one by one."""

_CENTRED = "(?P<thing>_+?) BE (CENTREWORD|in (DET)? (centre|center|middle|CENTREWORD) (of DET (PICTURE|VIEWNOUN|frame))?) (FILLER)*"
"""The end of a turn that puts a thing in the middle, such as "the van is in the centre of the picture"."""

_SAME_MOVE = Unclear("Is that part of the same move, or another one? Please give each move its amount.")


class Sentences(ClauseReading):
    """Reads a list of clauses from left to right."""

    def steps(self) -> list[Step]:
        """Return the steps of all clauses."""
        out: list[Step] = []
        while self.next < len(self.clauses):
            out = _merged(compose(self._linked(), out))
        is_one_move = any(x.has("ATSAMETIME") for clause in self.clauses for x in clause.lexemes)
        axes = [part.axis for step in out if isinstance(step, Move) for part in step.parts if not isinstance(part, Zoom)]
        if is_one_move and len(set(axes)) < len(axes):
            return [Unclear("That asks for two moves on the same axis at once. Which one shall I make?")]
        return out

    def _linked(self) -> list[Linked]:
        """Return the linked steps of the next clause, with the clauses that belong to it."""
        clause = self._take()
        match clause.marker:
            case "":
                return self._main(clause)
            case "WHILE" | "UNTIL":
                return [Linked(clause.link, self._loop_ahead(clause))]
            case "IF" if is_courtesy(clause.lexemes):
                return []
            case "IF" | "WHEN" | "UNLESS":
                return [Linked(clause.link, self._conditional(clause))]
            case "IFSO":
                return [Linked(clause.link, self._branches(Answered(), clause))]
            case "IFNOT":
                return [Linked(clause.link, self._branches(Negated(Answered()), clause))]
            case "BEFORE" | "AFTER":
                return self._ordered(clause)
            case "REASON":
                return []
        raise NotUnderstoodError(clause.lexemes)

    # Main clauses ------------------------------------------------------------------------------------------------------
    def _main(self, clause: Clause) -> list[Linked]:
        """Return the steps of a main clause, with what follows it: "until ...", "if ...", "before ..."."""
        after = self._peek()
        if clause.link in {",", "and", "."} and self.next > 1 and is_reason(clause.lexemes):
            return []
        if (
            after is not None
            and after.link == ","
            and not after.marker
            and is_wish(clause.lexemes)
            and after.lexemes[0].has(*MOTION_VERBS)
        ):
            return []  # "I need to see the door, pan left 20"
        if (
            self.next == 1
            and [x.word for x in clause.lexemes if not x.has("FILLER", "COMMA")] == ["right"]
            and after is not None
            and _is_full_sentence(after)
        ):
            return []  # "right, count the cars"
        if times := self._times_of_all(clause):
            return [Linked(clause.link, times)]
        if (condition := elliptical_condition(self.reader.source, clause, after)) is not None:
            is_told = not clause.is_question and match_start("SOMEONE BE", clause.lexemes)
            if is_told and isinstance(condition, Seen) and after is not None and search("them|him|her|it|PRON", after.lexemes):
                self.last = Mention(condition.thing)  # "someone is at the door - zoom in on them"
                return [Linked(clause.link, self.last)]
            return [Linked(clause.link, self._branches(condition, replace(clause, lexemes=(), marker="IF")))]
        before = self.last
        steps = self._read(clause)
        if (
            clause.link == ","
            and _says_again(before, steps)
            and not any(x.has("AGAINWORD", "ANOTHER") or x.word == "more" for x in clause.lexemes)
        ):
            return [Linked("then", _SAME_MOVE)]
        if (tour := self._tour(clause, steps)) is not None:
            return tour
        if (
            steps
            and isinstance(steps[0], AtIntervals)
            and not isinstance(before, Move)
            and after is not None
            and after.link == "and"
            and not after.marker
        ):
            moves = self.reader.read(self._take().lexemes)
            if len(moves) == 1 and isinstance(moves[0], Move):
                return [Linked(clause.link, replace(steps[0], move=moves[0]))]
            raise NotUnderstoodError(after.lexemes)
        if after is None:
            return self._ended(clause, steps)
        if after.marker == "UNTIL" or (after.marker == "WHILE" and after.link in {"", ","}):
            return [Linked(clause.link, self._loop(clause, steps))]
        if (bound := _bound_of(after)) is not None and (until := self._peek(1)) is not None and until.marker == "UNTIL":
            self._take()
            loop = self._loop(clause, steps)
            return [Linked(clause.link, replace(loop, bound=bound) if isinstance(loop, Loop) else loop)]
        if after.marker == "IF" and is_courtesy(after.lexemes):
            self._take()
            return self._ended(clause, steps)
        if after.marker == "IF" and is_need(after.lexemes):
            return self._as_needed(clause, steps)
        if after.marker in {"IF", "UNLESS", "WHEN"} and after.link in {"", ","} and steps and self._is_trailing():
            self._take()
            return [Linked(clause.link, self._trailing(after, steps))]
        if after.marker in {"IFSO", "IFNOT"} and after.link == "" and not after.lexemes and steps:
            self._take()
            answered: Condition = Answered() if after.marker == "IFSO" else Negated(Answered())
            return [Linked(clause.link, If(answered, tuple(steps)))]
        if after.marker in {"BEFORE", "AFTER"} and after.link in {"", ",", "and"} and steps:
            self._take()
            other = self.reader.read(after.lexemes)
            if before is not None and isinstance(steps[0], DoAgain):
                steps = (before,)  # "count the cars now, and again after panning left"
            first, second = (steps, other) if after.marker == "BEFORE" else (other, steps)
            return [Linked(clause.link, s) for s in first] + [Linked("then", s) for s in second]
        if after.marker == "REASON" and after.link in {"", ",", "and"}:
            self._take()
        return self._ended(clause, steps)

    def _tour(self, clause: Clause, steps: tuple[Step, ...]) -> list[Linked] | None:
        """Return the steps of a clause that visits presets one by one, with what is to be done at each; None for other clauses."""
        if not steps or not all(isinstance(step, GoToPreset) for step in steps):
            return None
        size = 0  # of the list of presets that the clause begins
        while (other := self._peek(size)) is not None and _lists_place(self.reader.source, other):
            size += 1
        listed = self.clauses[self.next : self.next + size]
        act = self._peek(size)
        is_each = any(x.has("EVERY") for x in clause.lexemes)
        is_in_turn = any(x.has("INTURN") for part in (clause, *listed) for x in part.lexemes)
        links = {",", "and", ":", "then"} if is_each else {",", "and", ":"} if is_in_turn else set[str]()
        if len(steps) + size < 2 or act is None or act.marker or act.link not in links:
            return None
        visits = list(steps)
        for _ in range(size):
            visits += self._read(self._take())
        each = list(self._read(self._take()))  # "look at each of gate and yard and count the people there"
        if any(isinstance(step, Move | ZoomTo | Track) for step in each):
            return [Linked(clause.link, Unclear("Shall I do that at each of them, or only at the last one?"))]
        if not all(isinstance(step, _LOOKS) for step in each):
            return [*self._ended(clause, tuple(visits)), *(Linked(act.link, step) for step in each)]
        rest: list[Step] = []
        while not rest and (more := self._peek()) is not None and more.link == "and" and not more.marker:
            steps = self._read(self._take())
            (each if all(isinstance(step, _LOOKS) for step in steps) else rest).extend(steps)
        return [*self._ended(clause, tuple(visits)), Linked(",", EachTime(tuple(each))), *(Linked("and", step) for step in rest)]

    def _times_of_all(self, clause: Clause) -> Step | None:
        """Return the repetition of "three times: pan left 20 and count the cars"."""
        match = full_match(
            (
                r"(FILLER|do DET following|REPEAT|REPEAT SELF)* ((?P<number>NUM) X|(?P<twice>TWICE)|(?P<thrice>THRICE)) "
                r"(COMMA|FILLER|do this|INTURN)*"
            ),
            clause.lexemes,
        )
        after = self._peek()
        if not match or clause.link not in {"", "."} or after is None or after.link not in {":", ","}:
            return None
        times = round(match["number"][0].value) if match["number"] else 2 if match.has("twice") else 3
        body: list[Step] = []
        while self.next < len(self.clauses) and (not body or self.clauses[self.next].link not in {"."}):
            body = compose(self._linked(), body)
        return Repeat(tuple(body), max(1, min(times, 50)))

    # Conditions --------------------------------------------------------------------------------------------------------
    def _condition(self, clause: Clause) -> tuple[Condition, tuple]:  # type: ignore[type-arg]
        """Return the condition of a clause, and the presets at which it is tested."""
        condition = condition_of(self.reader.source, clause.lexemes)
        places: tuple = ()  # type: ignore[type-arg]
        rest, found = place_after(self.reader.source, clause.lexemes)
        owner = full_match(_PLACE_WITH, clause.lexemes)
        if owner and (owners := places_of(self.reader.source, owner["place"])):
            rest, found = tuple(owner["rest"]), owners
        inner = condition_of(self.reader.source, rest) if found and rest and not isinstance(condition, PresetOutnumbers) else None
        if owner and inner is None and found and (thing := thing_of(self.reader.source, owner["rest"])) is not None:
            inner = Seen(thing)  # "the gate has people"
        if inner is not None and found is not None:
            condition, places = inner, found
        if condition is None or (isinstance(condition, Seen) and condition.thing.text in {"something", "anything"}):
            raise NotUnderstoodError(clause.lexemes)  # "until something moves" describes nothing that a picture shows
        if clause.marker == "UNLESS" or clause.marker == "NEVER":
            condition = Negated(condition)
        return condition, places

    def _conditional(self, clause: Clause) -> Step:
        condition, places = self._condition(clause)
        step = self._branches(condition, clause)
        return AtPlaces(places, (step,)) if places and isinstance(step, If) else step

    def _branches(self, condition: Condition, clause: Clause) -> Step:
        """Return the condition with the clauses that follow it as its branches."""
        then: list[Step] = []
        if clause.marker in {"IFSO", "IFNOT"} and clause.lexemes:
            then = compose([Linked("", s) for s in self.reader.read(clause.lexemes, asked=clause.is_question)], then)
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
        """Return steps with those of the clauses up to the end of the sentence or the next "otherwise"."""
        while (clause := self._peek()) is not None:
            if _bound_of(clause) is not None and steps:
                break
            if clause.marker == "IFNOT" or (clause.link == "." and steps) or (clause.marker == "IFSO" and steps):
                break
            if clause.marker in {"IF", "UNLESS"} and steps and clause.link in {",", "and", ".", "then"}:
                break
            steps = compose(self._linked(), steps)
        return steps

    def _trailing(self, clause: Clause, steps: tuple[Step, ...]) -> Step:
        """Return "take a picture if ...", with the "otherwise" that may follow."""
        condition, places = self._condition(clause)
        otherwise: list[Step] = []
        after = self._peek()
        if after is not None and after.marker == "IFNOT":
            self._take()
            if after.lexemes:
                otherwise = compose([Linked("", s) for s in self.reader.read(after.lexemes)], otherwise)
            otherwise = self._block(otherwise)
        step = If(condition, tuple(compose([Linked("and", s) for s in steps], [])), tuple(otherwise))
        return AtPlaces(places, (step,)) if places else step

    # Loops -------------------------------------------------------------------------------------------------------------
    def _loop(self, clause: Clause, steps: tuple[Step, ...]) -> Step:
        """Return the loop of a clause and the "until ..." that follows it."""
        until = self._take()
        is_turn = full_match("(KEEP|FILLER|CAMERA|DET)* (PAN|TURN|PAN-ING|TURN-ING) (AROUND|FILLER|CAMERA|DET)*", clause.lexemes)
        if is_turn and self._peek() is None and (centred := full_match(_CENTRED, until.lexemes)):
            thing = thing_of(self.reader.source, centred["thing"])
            if thing is not None and thing.text:
                return ZoomTo(thing)  # "pan until the excavator is in the middle"
        condition, places = self._condition(until)
        if places or not steps:
            raise NotUnderstoodError(until.lexemes)
        if (
            isinstance(steps[0], AtPlaces)
            and not steps[0].body
            and isinstance(condition, Seen)
            and condition.quantity == Quantity()
        ):
            return FirstWith(condition.thing, steps[0].places)  # "go round the presets, stopping as soon as you see a wheelchair"
        if isinstance(steps[0], Unclear) and full_match(
            "(KEEP|FILLER|CAMERA|it|DET)* (PAN|TURN|SCAN|PAN-ING|TURN-ING|SCAN-ING) (AROUND|FILLER|CAMERA|DET)*", clause.lexemes
        ):
            steps = (Move((Turn("pan", 1),)),)  # "pan until ..." pans right
        if all(isinstance(step, Forbid | Report) for step in steps):
            return Unclear("I cannot wait for something to happen. Shall I look for it now?")
        if until.marker == "WHILE":
            condition = Negated(condition)
        bound: Bound | None = None
        while (after := self._peek()) is not None and (found := _bound_of(after)) is not None:
            self._take()
            bound = found
        otherwise: list[Step] = []
        if after is not None and after.marker == "IFNOT":
            self._take()
            if after.lexemes:
                otherwise = compose([Linked("", s) for s in self.reader.read(after.lexemes)], otherwise)
            otherwise = self._block(otherwise)
        return Loop(tuple(steps), condition, bound, tuple(otherwise))

    def _loop_ahead(self, clause: Clause) -> Step:
        """Return the loop of "while there are no cars, pan right 10"."""
        condition, places = self._condition(clause)
        body = self._block([])
        if places or not body:
            raise NotUnderstoodError(clause.lexemes)
        bound = _bound_of(after) if (after := self._peek()) is not None else None
        if bound is not None:
            self._take()
        return Loop(tuple(body), Negated(condition) if clause.marker == "WHILE" else condition, bound)

    # Order -------------------------------------------------------------------------------------------------------------
    def _ordered(self, clause: Clause) -> list[Linked]:
        """Return the steps of "before going home take a picture" and "after panning left, zoom in"."""
        other = self.reader.read(clause.lexemes)
        if self._peek() is None:
            raise NotUnderstoodError(clause.lexemes)
        block = self._block([])
        if clause.marker == "BEFORE":
            return [Linked("then", s) for s in (*block, *other)]
        return [Linked("then", s) for s in (*other, *block)]


def _is_full_sentence(clause: Clause) -> bool:
    """Return whether a clause is a sentence of its own, so that a word before it, such as "right,", is only an opener."""
    return (
        clause.link in {",", ".", ":"}
        and bool(clause.lexemes)
        and (
            clause.is_question or not clause.lexemes[0].has("NUM", "LITTLE", "LOT", "MORE", "AMOUNTISH", "DET", "PREP", *DIRECTIONS)
        )
    )


def _lists_place(source: Source, clause: Clause) -> bool:
    """Return whether a clause only names another preset of a list: "..., yard and reception"."""
    lexemes = trimmed(clause.lexemes, "INTURN", "FILLER", "COMMA")
    return clause.link in {",", "and"} and not clause.marker and not clause.is_question and bool(places_of(source, lexemes))


def _says_again(before: Step | None, steps: Sequence[Step]) -> bool:
    """Return whether a move goes the same way as the move before it: "pan left 10, ten degrees to the left".

    It may just be a rewording of that move, so it must not be carried out as a second one.
    """
    if not (isinstance(before, Move) and len(steps) == 1 and isinstance(steps[0], Move)):
        return False
    return bool(_ways(before) & _ways(steps[0]))


def _ways(move: Move) -> set[tuple[str, bool]]:
    """Return the axes that a move changes by an amount, each with the direction."""
    ways: set[tuple[str, bool]] = {(part.axis, part.sign > 0) for part in move.parts if isinstance(part, Turn)}
    for part in move.parts:
        if isinstance(part, Zoom) and part.kind in {"factor", "percent"}:
            ways.add(("zoom", part.value > (1 if part.kind == "factor" else 0)))
    return ways


def _merged(steps: list[Step]) -> list[Step]:
    """Merge "go to A if there is" and "to B if there is not" into one condition with two branches."""
    if len(steps) < 2:
        return steps
    first, second = steps[-2], steps[-1]
    if (
        isinstance(first, If)
        and isinstance(second, If)
        and first.condition == Answered()
        and second.condition == Negated(Answered())
        and not first.otherwise
    ):
        return [*steps[:-2], replace(first, otherwise=second.then)]
    return steps


def _bound_of(clause: Clause) -> Bound | None:
    """Return the limit of a loop that a clause states: "at most 8 times", "but stop after 5 tries"."""
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
