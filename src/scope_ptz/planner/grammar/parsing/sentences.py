"""Combine the clauses of an instruction: conditions with their branches, loops with their bodies, and the rest in order."""

from __future__ import annotations

from dataclasses import replace

from scope_ptz.english.grammar.parts_of_speech import verb_form
from scope_ptz.planner.grammar.instruction_tree import (
    Ask,
    AtIntervals,
    AtPlaces,
    Count,
    DoAgain,
    GoToPreset,
    If,
    Linked,
    Loop,
    Mention,
    Move,
    Read,
    Snap,
    Step,
    Thing,
    Track,
    Unclear,
    ZoomTo,
)
from scope_ptz.planner.grammar.instruction_tree.conditions import Answered, Condition, Negated, Quantity, Seen
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.asides import (
    drops_everything,
    elliptical_condition,
    is_ability_condition,
    is_courtesy_condition,
    is_necessity_condition,
    is_withdrawal_statement,
    plainly_takes_back,
    takes_back,
)
from scope_ptz.planner.grammar.parsing.branches import bound_of
from scope_ptz.planner.grammar.parsing.calculations import with_later_calculations
from scope_ptz.planner.grammar.parsing.compose import axis_of, compose
from scope_ptz.planner.grammar.parsing.parts.clause import (
    VERBS,
    Clause,
    NotUnderstoodError,
    Source,
    command_of,
)
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.preset_refs import place_of
from scope_ptz.planner.grammar.parsing.parts.scopes import split_trailing_place
from scope_ptz.planner.grammar.parsing.parts.statements import is_event
from scope_ptz.planner.grammar.parsing.purposes import purpose_of_move
from scope_ptz.planner.grammar.parsing.remarks import adds_nothing
from scope_ptz.planner.grammar.parsing.restatements import is_reason_for_zoom, repeats_previous_move
from scope_ptz.planner.grammar.parsing.topics import topic_count, topic_step
from scope_ptz.planner.grammar.parsing.tours import TourReader
from scope_ptz.planner.grammar.parsing.turns_in_steps import in_single_move, is_single_move

_SEARCHING = frozenset({"look_for", "search_for", "have_a_look_for", "take_a_look_for"})
_REACHED = (
    "(it|them|one|PRON)|SELF (HAVEV|have|got|SEE|FIND|find) (found|got)? (it|them|one|PRON)|(it|PRON) (BE) (VISIBLE|found|NOW)+"
)
"""Words after "when" that refer to the end of the previous loop: "pan left until you see a van. When you have it, ..."."""

_IF_THERE_IS = frozenset({
    "if_there_is", "if_there_are", "if_there_is_one", "if_there_are_any", "if_you_see_one", "if_you_see_any", "if_you_find_one",
    "if_you_find_any", "if_you_spot_one", "if_you_spot_any",
})  # fmt: skip
"""Conditions that ask for the thing that the command before them names: "zoom in on the bus if there is one"."""

_WHICH_FIRST = Unclear("Which of the two shall I do first?")
_IN_ANY_CASE = Unclear("Shall I do the last part in any case, or only if I do not do the first?")
_WITHDRAWN = Unclear("Shall I do that, or not?")
_NOTHING_LEFT = Unclear("All right, I do nothing. What shall I do instead?")
"""The answer to a single command that is plainly taken back: "follow the bus. Actually, don't"."""

_SAME_MOVE = Unclear("Is that part of the same move, or another one? Please give each move its amount.")


class SentenceReader(TourReader):
    """Reads all clauses of an instruction from left to right."""

    def steps(self) -> list[Step]:
        """Return the steps of all clauses."""
        out: list[Step] = []
        at_once: list[Step] = []  # steps since the last "then" or full stop
        while self.next_index < len(self.clauses):
            start, linked = self.next_index, self._linked()
            if any(is_single_move(x) for clause in self.clauses[start : self.next_index] for x in clause.lexemes):
                linked = [replace(each, step=in_single_move(each.step)) for each in linked]
            out = _with_merged_conditions(compose(linked, out))
            if self.clauses[start].link in {"then", "."}:
                at_once = []
            at_once += [each.step for each in linked]
            is_one_move = any(x.has("ATSAMETIME") for clause in self.clauses[start : self.next_index] for x in clause.lexemes)
            axes = [axis_of(part) for step in at_once if isinstance(step, Move) for part in step.parts]
            if is_one_move and len(set(axes)) < len(axes):
                return [Unclear("That asks for two moves on the same axis at once. Which one shall I make?")]
        return with_later_calculations(out)

    def _linked(self) -> list[Linked]:
        """Return the linked steps of the next clause and of the clauses that belong to it."""
        clause = self._take()
        match clause.marker:
            case "" if self._takes_back(clause):
                return [Linked(clause.link, _NOTHING_LEFT if self._takes_all_back(clause) else _WITHDRAWN)]
            case "" if adds_nothing(clause, self._peek(), self.last_step, is_first=self.next_index == 1):
                return []
            case "":
                return self._main_clause(clause)
            case _ if _is_meanwhile(clause):
                return []
            case "WHILE" | "UNTIL":
                return [Linked(clause.link, self._loop_ahead(clause))]
            case "IF" if is_courtesy_condition(clause.lexemes):
                return []
            case "WHEN" | "AFTER" if self._follows_search() and full_match(_REACHED, clause.lexemes):
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

    def _takes_back(self, clause: Clause) -> bool:
        """Return whether a clause takes back or forbids another one: "I changed my mind", or "no, don't" at the end."""
        after = self._peek()
        is_last = self.next_index > 1 and (after is None or after.link == "." or drops_everything(clause))
        return (len(self.clauses) > 1 and is_withdrawal_statement(clause)) or (is_last and takes_back(clause))

    def _takes_all_back(self, clause: Clause) -> bool:
        """Return whether a clause plainly takes back the only command before it, and nothing follows."""
        is_only = len(self.clauses) == 2 and self.next_index == 2 and not self.clauses[0].marker
        return is_only and plainly_takes_back(clause)

    def _follows_search(self) -> bool:
        """Return whether the previous clause looks for something: "until you see a van", "find the van"."""
        ends_loop = self.next_index > 1 and self.clauses[self.next_index - 2].marker in {"UNTIL", "WHILE"}
        return ends_loop or isinstance(self.last_step, ZoomTo)

    # Main clauses ------------------------------------------------------------------------------------------------------
    def _main_clause(self, clause: Clause) -> list[Linked]:
        """Return the steps of a main clause, with what follows it: "until ...", "if ...", "before ..."."""
        after = self._peek()
        if times := self._repeated_list(clause):
            return [Linked(clause.link, times)]
        if (condition := elliptical_condition(self.reader.source, clause, after)) is not None:
            return self._elliptical(clause, after, condition)
        if (count := topic_count(self.reader.source, clause, after)) is not None:
            self._take()
            clause, after = count, self._peek()
        elif (topic := topic_step(self.reader.source, clause, after)) is not None:
            self.last_step, takes_next = topic
            if takes_next:
                self._take()
            return [Linked(clause.link, self.last_step)]
        before = self.last_step
        steps = self._read(clause)
        if (aside := self._aside(clause, steps, before, after)) is not None:
            return aside
        if (
            clause.link == ","
            and repeats_previous_move(before, steps)
            and not any(x.has("AGAINWORD") or (x.has("ANOTHER") and x.word != "it") or x.word == "more" for x in clause.lexemes)
        ):
            return [Linked("then", _SAME_MOVE)]
        if after is not None and after.opener is not None and after.opener.word.startswith("if_there"):
            steps = tuple(_as_presence_count(clause, step) for step in steps)
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
            return self._linked_steps(clause, steps)
        there = steps[0] if len(steps) == 1 and isinstance(steps[0], AtPlaces) and _begins_at_place(clause) else None
        done = there.body if there is not None and there.body else steps
        if after.marker in {"UNTIL", "WHILE"} and self._is_place(clause):
            return self._linked_steps(clause, steps)  # "at the gate, until you see a van, pan right 10"
        is_while = after.marker == "WHILE" and after.link in {"", ","} and not _is_meanwhile(after)
        if after.marker == "UNTIL" or is_while:
            return [Linked(clause.link, _with_body(there, self._loop(clause, done)))]
        if (bound := bound_of(after)) is not None and (until := self._peek(1)) is not None and until.marker == "UNTIL":
            self._take()
            loop = self._loop(clause, steps)
            return [Linked(clause.link, replace(loop, bound=bound) if isinstance(loop, Loop) else loop)]
        is_too_hard = all(isinstance(step, Ask | Read) for step in steps) and bool(steps) and is_ability_condition(after.lexemes)
        is_polite = after.marker == "IF" and (is_courtesy_condition(after.lexemes) or is_too_hard)
        if is_polite or _is_meanwhile(after):
            self._take()
            return self._linked_steps(clause, steps)
        if after.marker == "IF" and is_necessity_condition(after.lexemes):
            return self._steps_if_needed(clause, steps)
        if after.marker in {"WHEN", "AFTER"} and steps and (place := _arrival(self.reader.source, after)) is not None:
            self._take()
            return [Linked(clause.link, place), *(Linked("then", step) for step in steps)]
        if after.marker in {"IF", "UNLESS", "WHEN"} and after.link in {"", ","} and steps and self._is_trailing(clause):
            return [Linked(clause.link, self._with_condition(there, done))]
        if after.marker in {"IFSO", "IFNOT"} and after.link == "" and not after.lexemes and steps:
            self._take()
            named = next((thing for step in steps if (thing := _sought_in(step)) is not None), None)
            is_about_named = named is not None and after.opener is not None and after.opener.word in _IF_THERE_IS
            met: Condition = Seen(named) if is_about_named and named is not None else Answered()
            answered: Condition = met if after.marker == "IFSO" else Negated(Answered())
            return [Linked(clause.link, If(answered, tuple(steps)))]
        if after.marker in {"BEFORE", "AFTER"} and (ordered := self._with_order(clause, steps, before)) is not None:
            return ordered
        if after.marker == "REASON" and after.link in {"", ",", "and"}:
            self._take()
        return self._linked_steps(clause, steps)

    def _aside(self, clause: Clause, steps: tuple[Step, ...], before: Step | None, after: Clause | None) -> list[Linked] | None:
        """Return the steps of a clause that only belongs to a move beside it or lists pictures; None for other clauses."""
        if (clause.link == "," and is_reason_for_zoom(before, steps, clause)) or self._lists_pictures(steps):
            return []
        if (purpose := purpose_of_move(self.reader, clause, steps, before, after)) is None:
            return None
        self.last_step = before or purpose
        if isinstance(purpose, ZoomTo):
            self._take()  # "let me see the digger, zoom in"
        return [Linked(clause.link, purpose)]

    def _elliptical(self, clause: Clause, after: Clause | None, condition: Condition) -> list[Linked]:
        """Return the steps for a condition without "if" and its branches: "more than five vans at the gate? Then go home"."""
        is_report = not clause.is_question and match_start("SOMEONE BE", clause.lexemes)
        if is_report and isinstance(condition, Seen) and after is not None and search("them|him|her|it|PRON", after.lexemes):
            self.last_step = Mention(condition.thing)  # "someone is at the door - zoom in on them"
            return [Linked(clause.link, self.last_step)]
        rest, places = split_trailing_place(self.reader.source, clause.lexemes)
        inner = elliptical_condition(self.reader.source, replace(clause, lexemes=rest), after) if places and rest else None
        branches = self._branches(inner or condition, replace(clause, lexemes=(), marker="IF"))
        return [Linked(clause.link, branches if inner is None else AtPlaces(places or (), (branches,)))]

    def _with_condition(self, there: AtPlaces | None, steps: tuple[Step, ...]) -> Step:
        """Return steps with the condition that follows them, to be carried out at places if there are any."""
        condition = self._take()
        if condition.marker == "UNLESS" and (later := self._peek()) is not None and later.link == "then":
            return _IN_ANY_CASE  # "pan left unless there is a van, then pan right"
        return _with_body(there, self._with_trailing_condition(condition, steps))

    def _with_order(self, clause: Clause, steps: tuple[Step, ...], before: Step | None) -> list[Linked] | None:
        """Return the steps of a clause and of the "before ..." or "after ..." that follows it; None if the two are separate.

        Args:
            clause: The clause.
            steps: Its steps.
            before: The step before them.
        """
        after, later = self.clauses[self.next_index], self._peek(1)
        if after.marker == "BEFORE" and is_event(after.lexemes):
            self._take()
            return self._linked_steps(clause, steps)  # "take a picture before the bus leaves"
        leads = later is not None and later.link == "," and not later.marker
        if after.link == "and" and leads:
            return self._linked_steps(clause, steps)  # "take a picture, and after panning left, go home"
        if after.link not in {"", ",", "and"} or not steps:
            return None
        self._take()
        if after.link == "and" and later is not None and later.link == "and" and not later.marker:
            return [Linked(clause.link, _WHICH_FIRST)]  # "pan left and after you zoom in take a picture"
        if after.link == "," and leads:
            return [Linked(clause.link, _WHICH_FIRST)]  # "take a picture, after panning left, go home"
        if (unclear := _adverbial_order(after)) is not None:
            return [Linked(clause.link, unclear)]
        other = self.reader.read(_as_command(after.lexemes))
        if before is not None and isinstance(steps[0], DoAgain):
            steps = (before,)  # "count the cars now, and again after panning left"
        first, second = (steps, other) if after.marker == "BEFORE" else (other, steps)
        return [Linked(clause.link, s) for s in first] + [Linked("then", s) for s in second]

    # Order -------------------------------------------------------------------------------------------------------------
    def _ordered(self, clause: Clause) -> list[Linked]:
        """Return the steps of "before going home take a picture" and "after panning left, zoom in"."""
        if clause.marker == "BEFORE" and is_event(clause.lexemes):
            return []  # "before I forget, take a picture"
        other = self.reader.read(_as_command(clause.lexemes))
        if self._peek() is None:
            raise NotUnderstoodError(clause.lexemes)
        block = self._block([])
        if clause.marker == "BEFORE":
            return [Linked("then", s) for s in (*block, *other)]
        return [Linked("then", s) for s in (*other, *block)]


def _as_command(lexemes: tuple[Lexeme, ...]) -> tuple[Lexeme, ...]:
    """Return a clause with its initial participle as a command: "count the cars" for "(after you have) counted the cars"."""
    command = command_of(lexemes[0])
    return lexemes if command is None else (command, *lexemes[1:])


def _is_meanwhile(clause: Clause) -> bool:
    """Return whether a "while" clause says what the speaker does meanwhile: "while I make a brew"."""
    if clause.marker != "WHILE":
        return False
    seen = ("SEE", "SEE-ING", "VISIBLE", "VIEWNOUN", "PICTURE", "NUM", "PRESET", "HOME", "DEG", "NOT")
    return bool(clause.lexemes) and clause.lexemes[0].word in {"i", "we"} and not any(x.has(*seen) for x in clause.lexemes)


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
    """Return the step that goes to the preset at which the camera must first arrive: "once you're at the gate"."""
    match = full_match(
        "(SELF|CAMERA|it|DET CAMERA)* ((BE|CARRY|get_to|reach|reached|arrive) (at|on|to|in)?|at|on|in) (?P<place>_+)",
        clause.lexemes,
    )
    place = place_of(source, match["place"]) if match else None
    return GoToPreset(place) if place is not None else None


def _with_merged_conditions(steps: list[Step]) -> list[Step]:
    """Merge "go to A if there is" and "to B if there is not" into one condition with two branches."""
    if len(steps) < 2:
        return steps
    first, second = steps[-2], steps[-1]
    if isinstance(first, If) and isinstance(second, If) and not first.otherwise and _denies(first.condition, second.condition):
        return [*steps[:-2], replace(first, otherwise=second.then)]
    if (
        isinstance(first, If)
        and isinstance(second, If)
        and isinstance(first.condition, Answered | Seen)
        and second.condition == Negated(Answered())
        and not first.otherwise
    ):
        return [*steps[:-2], replace(first, otherwise=second.then)]
    return steps


def _sought_in(step: Step) -> Thing | None:
    """Return the thing that a step zooms in on, follows or reads, if the step names it."""
    if isinstance(step, AtPlaces):
        return next((thing for inner in step.body if (thing := _sought_in(inner)) is not None), None)
    thing = step.thing if isinstance(step, ZoomTo | Track | Read) else step.of if isinstance(step, Snap) else None
    return thing if thing is not None and thing.text else None


def _as_presence_count(clause: Clause, step: Step) -> Step:
    """Return a search as a count if only the presence matters: "look for a skateboard, and if there is one, ..."."""
    if isinstance(step, AtPlaces) and len(step.body) == 1:
        return replace(step, body=(_as_presence_count(clause, step.body[0]),))
    is_search = isinstance(step, ZoomTo) and any(x.word in _SEARCHING for x in clause.lexemes[:3])
    return Count((step.thing,)) if is_search and isinstance(step, ZoomTo) and not step.thing.definite else step


def _denies(condition: Condition, other: Condition) -> bool:
    """Return whether a condition is the opposite of the previous one: "if none is visible" after "if you see a van"."""
    if not isinstance(condition, Seen) or not isinstance(other, Seen) or condition.quantity != Quantity():
        return False
    return other.quantity == Quantity("==", 0) and other.thing.text in {"", condition.thing.text}
