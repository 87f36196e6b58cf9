"""Combine the clauses of an instruction: conditions with their branches, loops with their bodies, and the rest in order."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.conditions import Answered, Condition, Negated, Quantity, Seen
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtIntervals,
    AtPlaces,
    Count,
    DoAgain,
    EachTime,
    GoToPreset,
    If,
    Linked,
    Loop,
    Mention,
    Move,
    Read,
    Repeat,
    Snap,
    Step,
    Track,
    Unclear,
    ZoomTo,
)
from scope_ptz.planner.grammar.parsing.asides import (
    elliptical_condition,
    is_ability,
    is_courtesy,
    is_need,
    is_news,
    is_reason,
    is_shared_knowledge,
    is_wish,
)
from scope_ptz.planner.grammar.parsing.branches import bound_of
from scope_ptz.planner.grammar.parsing.calculations import calculated_afterwards
from scope_ptz.planner.grammar.parsing.compose import axis_of, compose
from scope_ptz.planner.grammar.parsing.loops import Loops
from scope_ptz.planner.grammar.parsing.parts.clause import (
    DIRECTIONS,
    MOTION_VERBS,
    VERBS,
    Clause,
    NotUnderstoodError,
    Source,
    trimmed,
)
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of, places_of
from scope_ptz.planner.grammar.parsing.parts.statements import is_event
from scope_ptz.planner.grammar.parsing.restatements import says_again, says_size_again
from scope_ptz.planner.grammar.parsing.topics import topic_count, topic_step

_SEARCHING = frozenset({"look_for", "search_for", "have_a_look_for", "take_a_look_for"})
_LOOKS = (Ask, Count, Read, Snap)
"""Steps that are carried out at each of several presets visited one by one."""

_TOO_MUCH = "(FILLER|LITTLE|LOT|PRON|BE|DET|AMOUNTISH)* too (LOT|LITTLE|much|FREE|ADVERB|CLOSER|WIDER|tight|UP|DOWN)"
"""A comment on the move before: "left 20, too far, back 5"."""

_WANTS_A_LOOK = "(DET)? FREE{1,2} (wants|needs|WRAPPER|TAKE-S|SHOW-S) (to)? (DET)? (look|see|SEE|FREE look|SHOW)"
"""A reason for the move before: "tilt down 10, the foreman wants a look at the pit"."""

_NO_MORE = (
    "(FILLER|AND|BUT|DASH|just)* (not|no|NOT|NONE|NEGATED|nothing) (MORE|more|further) (than that)? (FILLER)*|no_more (FILLER)*"
)
"""A comment on the amount of the move before: "left 20, not more"."""

_REACHED = (
    "(it|them|one|PRON)|SELF (HAVEV|have|got|SEE|FIND|find) (found|got)? (it|them|one|PRON)|(it|PRON) (BE) (VISIBLE|found|NOW)+"
)
"""Words after "when" for the end of the loop before: "pan left until you see a van. When you have it, ..."."""

_PERIODS = "(shift|day|week|watch|month|season|term|play|round)"
_TIME_OF_DAY = f"(FILLER)* (DET)? (end|start|beginning|middle|close) of (DET|my|our|SELF)* ({_PERIODS}|FREE {_PERIODS}) (FILLER)*"
"""Words that only say what time it is: "end of shift, go home"."""

_WHICH_FIRST = Unclear("Which of the two shall I do first?")
_SAME_MOVE = Unclear("Is that part of the same move, or another one? Please give each move its amount.")


class Sentences(Loops):
    """Reads a list of clauses from left to right."""

    def steps(self) -> list[Step]:
        """Return the steps of all clauses."""
        out: list[Step] = []
        at_once: list[Step] = []  # since the last "then" or the last sentence
        while self.next < len(self.clauses):
            start, linked = self.next, self._linked()
            out = _merged(compose(linked, out))
            if self.clauses[start].link in {"then", "."}:
                at_once = []
            at_once += [each.step for each in linked]
            is_one_move = any(x.has("ATSAMETIME") for clause in self.clauses[start : self.next] for x in clause.lexemes)
            axes = [axis_of(part) for step in at_once if isinstance(step, Move) for part in step.parts]
            if is_one_move and len(set(axes)) < len(axes):
                return [Unclear("That asks for two moves on the same axis at once. Which one shall I make?")]
        return calculated_afterwards(out)

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
            case "WHEN" | "AFTER" if self._follows_loop() and full_match(_REACHED, clause.lexemes):
                return [Linked("then", step) for step in self._block([])]
            case "WHEN" | "AFTER" if (place := _arrival(self.reader.source, clause)) is not None:
                return [Linked(clause.link, place), *(Linked("then", step) for step in self._block([]))]
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

    def _follows_loop(self) -> bool:
        """Return whether the clause before this one is the end of a loop: "until you see a van"."""
        return self.next > 1 and self.clauses[self.next - 2].marker in {"UNTIL", "WHILE"}

    # Main clauses ------------------------------------------------------------------------------------------------------
    def _main(self, clause: Clause) -> list[Linked]:
        """Return the steps of a main clause, with what follows it: "until ...", "if ...", "before ..."."""
        after = self._peek()
        if self._adds_nothing(clause, after):
            return []
        if times := self._times_of_all(clause):
            return [Linked(clause.link, times)]
        if (condition := elliptical_condition(self.reader.source, clause, after)) is not None:
            is_told = not clause.is_question and match_start("SOMEONE BE", clause.lexemes)
            if is_told and isinstance(condition, Seen) and after is not None and search("them|him|her|it|PRON", after.lexemes):
                self.last = Mention(condition.thing)  # "someone is at the door - zoom in on them"
                return [Linked(clause.link, self.last)]
            return [Linked(clause.link, self._branches(condition, replace(clause, lexemes=(), marker="IF")))]
        if (count := topic_count(self.reader.source, clause, after)) is not None:
            self._take()
            clause, after = count, self._peek()
        elif (topic := topic_step(self.reader.source, clause, after)) is not None:
            self.last, takes_next = topic
            if takes_next:
                self._take()
            return [Linked(clause.link, self.last)]
        before = self.last
        steps = self._read(clause)
        if (
            clause.link == ","
            and says_again(before, steps)
            and not any(x.has("AGAINWORD") or (x.has("ANOTHER") and x.word != "it") or x.word == "more" for x in clause.lexemes)
        ):
            return [Linked("then", _SAME_MOVE)]
        if after is not None and after.opener is not None and after.opener.word.startswith("if_there"):
            steps = tuple(_presence(clause, step) for step in steps)
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
        there = steps[0] if len(steps) == 1 and isinstance(steps[0], AtPlaces) and _begins_at_place(clause) else None
        done = there.body if there is not None and there.body else steps
        if after.marker in {"UNTIL", "WHILE"} and self._is_place(clause):
            return self._ended(clause, steps)  # "at the gate, until you see a van, pan right 10"
        if after.marker == "UNTIL" or (after.marker == "WHILE" and after.link in {"", ","}):
            return [Linked(clause.link, _with_body(there, self._loop(clause, done)))]
        if (bound := bound_of(after)) is not None and (until := self._peek(1)) is not None and until.marker == "UNTIL":
            self._take()
            loop = self._loop(clause, steps)
            return [Linked(clause.link, replace(loop, bound=bound) if isinstance(loop, Loop) else loop)]
        is_too_hard = all(isinstance(step, Ask | Read) for step in steps) and bool(steps) and is_ability(after.lexemes)
        if after.marker == "IF" and (is_courtesy(after.lexemes) or is_too_hard):
            self._take()
            return self._ended(clause, steps)
        if after.marker == "IF" and is_need(after.lexemes):
            return self._as_needed(clause, steps)
        if after.marker in {"WHEN", "AFTER"} and steps and (place := _arrival(self.reader.source, after)) is not None:
            self._take()
            return [Linked(clause.link, place), *(Linked("then", step) for step in steps)]
        if after.marker in {"IF", "UNLESS", "WHEN"} and after.link in {"", ","} and steps and self._is_trailing(clause):
            self._take()
            return [Linked(clause.link, _with_body(there, self._trailing(after, done)))]
        if after.marker in {"IFSO", "IFNOT"} and after.link == "" and not after.lexemes and steps:
            self._take()
            answered: Condition = Answered() if after.marker == "IFSO" else Negated(Answered())
            return [Linked(clause.link, If(answered, tuple(steps)))]
        if after.marker in {"BEFORE", "AFTER"} and (ordered := self._with_order(clause, steps, before)) is not None:
            return ordered
        if after.marker == "REASON" and after.link in {"", ",", "and"}:
            self._take()
        return self._ended(clause, steps)

    def _adds_nothing(self, clause: Clause, after: Clause | None) -> bool:
        """Return whether a clause only gives a reason, opens the next clause, or says again how far the last move went."""
        if (
            clause.link in {",", "and", "."}
            and self.next > 1
            and (is_reason(clause.lexemes) or is_news(clause) or is_shared_knowledge(clause))
        ):
            return True
        is_move_next = after is not None and after.link == "," and not after.marker and after.lexemes[0].has(*MOTION_VERBS)
        wants_a_look = full_match(f"(FILLER)* ({_WANTS_A_LOOK}) (FILLER|COMMA)*", clause.lexemes)
        if is_move_next and (is_wish(clause.lexemes) or wants_a_look):
            return True  # "I need to see the door, pan left 20", "the foreman wants a look, pan left 20"
        words = [x.word for x in clause.lexemes if not x.has("FILLER", "COMMA")]
        if self.next == 1 and words == ["right"] and after is not None and _is_full_sentence(after):
            return True  # "right, count the cars"
        if self.next == 1 and after is not None and full_match(_TIME_OF_DAY, clause.lexemes):
            return True
        if len(self.clauses) > 1 and clause.link in {",", "."} and full_match(_TOO_MUCH, clause.lexemes):
            return True
        if clause.link in {",", "and", "."} and isinstance(self.last, Move) and full_match(_NO_MORE, clause.lexemes):
            return True
        if clause.link != "," or not isinstance(self.last, Move):
            return False
        return says_size_again(self.last, clause) or bool(match_start(_WANTS_A_LOOK, clause.lexemes))

    def _with_order(self, clause: Clause, steps: tuple[Step, ...], before: Step | None) -> list[Linked] | None:
        """Return the steps of a clause and of the "before ..." or "after ..." that follows it; None if the two are separate.

        Args:
            clause: The clause.
            steps: Its steps.
            before: The step before them.
        """
        after, later = self.clauses[self.next], self._peek(1)
        if after.marker == "BEFORE" and is_event(after.lexemes):
            self._take()
            return self._ended(clause, steps)  # "take a picture before the bus leaves"
        leads = later is not None and later.link == "," and not later.marker
        if after.link == "and" and leads:
            return self._ended(clause, steps)  # "take a picture, and after panning left, go home"
        if after.link not in {"", ",", "and"} or not steps:
            return None
        self._take()
        if after.link == "and" and later is not None and later.link == "and" and not later.marker:
            return [Linked(clause.link, _WHICH_FIRST)]  # "pan left and after you zoom in take a picture"
        if after.link == "," and leads:
            return [Linked(clause.link, _WHICH_FIRST)]  # "take a picture, after panning left, go home"
        if (unclear := _adverbial_order(after)) is not None:
            return [Linked(clause.link, unclear)]
        other = self.reader.read(after.lexemes)
        if before is not None and isinstance(steps[0], DoAgain):
            steps = (before,)  # "count the cars now, and again after panning left"
        first, second = (steps, other) if after.marker == "BEFORE" else (other, steps)
        return [Linked(clause.link, s) for s in first] + [Linked("then", s) for s in second]

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
                r"(FILLER|(do|execute|perform|carry_out|run) (DET following|this|that|it)?|REPEAT|REPEAT SELF)* "
                r"((?P<number>NUM) X|X (?P<number>NUM)|(?P<twice>TWICE)|"
                r"(?P<thrice>THRICE)) "
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

    # Order -------------------------------------------------------------------------------------------------------------
    def _ordered(self, clause: Clause) -> list[Linked]:
        """Return the steps of "before going home take a picture" and "after panning left, zoom in"."""
        if clause.marker == "BEFORE" and is_event(clause.lexemes):
            return []  # "before I forget, take a picture"
        other = self.reader.read(clause.lexemes)
        if self._peek() is None:
            raise NotUnderstoodError(clause.lexemes)
        block = self._block([])
        if clause.marker == "BEFORE":
            return [Linked("then", s) for s in (*block, *other)]
        return [Linked("then", s) for s in (*other, *block)]


def _begins_at_place(clause: Clause) -> bool:
    """Return whether a clause begins with the preset at which all of it is done: "at the gate, take a picture"."""
    place = "(DET? PRESET PRESETNOUN?|EVERY PRESETNOUN)"
    return match_start(f"(FILLER|COMMA)* (at|in|from|on) {place} COMMA", clause.lexemes) is not None


def _with_body(there: AtPlaces | None, step: Step) -> Step:
    """Return a step, to be carried out at places if there are any: "at the gate, take a picture if there is a van"."""
    return step if there is None else replace(there, body=(step,))


def _adverbial_order(clause: Clause) -> Unclear | None:
    """Return the question about "take a picture, after go home", in which "after" may stand for "afterwards"."""
    if clause.opener is None or clause.opener.word not in {"after", "before"} or not clause.link:
        return None
    is_imperative = any(x.has(*VERBS) and verb_form(x.word) == "base" for x in clause.lexemes[:1])
    return _WHICH_FIRST if is_imperative else None


def _arrival(source: Source, clause: Clause) -> GoToPreset | None:
    """Return the step that goes to the preset at which a clause says to arrive: "once you're at the gate"."""
    match = full_match(
        "(SELF|CAMERA|it|DET CAMERA)* ((BE|CARRY|get_to|reach|reached|arrive) (at|on|to|in)?|at|on|in) (?P<place>_+)",
        clause.lexemes,
    )
    place = place_of(source, match["place"]) if match else None
    return GoToPreset(place) if place is not None else None


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


def _merged(steps: list[Step]) -> list[Step]:
    """Merge "go to A if there is" and "to B if there is not" into one condition with two branches."""
    if len(steps) < 2:
        return steps
    first, second = steps[-2], steps[-1]
    if isinstance(first, If) and isinstance(second, If) and not first.otherwise and _denies(first.condition, second.condition):
        return [*steps[:-2], replace(first, otherwise=second.then)]
    if (
        isinstance(first, If)
        and isinstance(second, If)
        and first.condition == Answered()
        and second.condition == Negated(Answered())
        and not first.otherwise
    ):
        return [*steps[:-2], replace(first, otherwise=second.then)]
    return steps


def _presence(clause: Clause, step: Step) -> Step:
    """Return the count for "look for a skateboard, and if there is one, ...", which only asks whether there is one."""
    if isinstance(step, AtPlaces) and len(step.body) == 1:
        return replace(step, body=(_presence(clause, step.body[0]),))
    is_search = isinstance(step, ZoomTo) and any(x.word in _SEARCHING for x in clause.lexemes[:3])
    return Count((step.thing,)) if is_search and isinstance(step, ZoomTo) and not step.thing.definite else step


def _denies(condition: Condition, other: Condition) -> bool:
    """Return whether a condition is that nothing is seen of what the condition before it looks for: "if none is visible"."""
    if not isinstance(condition, Seen) or not isinstance(other, Seen) or condition.quantity != Quantity():
        return False
    return other.quantity == Quantity("==", 0) and other.thing.text in {"", condition.thing.text}
