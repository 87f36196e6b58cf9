"""Builds noun phrases, as ``question_tree`` defines them, from parse trees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from lark import Token, Tree

from scope_ptz import english
from scope_ptz.perception.ground_truth.language import question_tree as s
from scope_ptz.perception.ground_truth.language.concepts import nouns_in

Children = list[Any]
"""The children of a node of the parse tree, already transformed."""


def tokens_of(children: Children, *kinds: str) -> list[Token]:
    """Return the tokens of some types."""
    return [c for c in children if isinstance(c, Token) and c.type in kinds]


def of_kind(children: Children, kind: type[Any]) -> list[Any]:
    """Return the children of a class."""
    return [c for c in children if isinstance(c, kind)]


def value_of(children: Children, kind: str) -> str | None:
    """Return the text of the first token of a type; None if there is none."""
    found = tokens_of(children, kind)
    return str(found[0]) if found else None


def descriptions(children: Children) -> list[s.Description]:
    """Return the descriptions among the children. A single noun phrase counts as one."""
    return [s.Description((c,)) if isinstance(c, s.Phrase) else c for c in children if isinstance(c, s.Phrase | s.Description)]


def tests_of(children: Children) -> tuple[s.Test, ...]:
    """Return the tests among the children, including those of a predicate."""
    found: list[s.Test] = []
    for child in children:
        if isinstance(child, _Predicate):
            found += child
        elif isinstance(child, s.Test):
            found.append(child)
    return tuple(found)


class _Predicate(tuple[s.Test, ...]):
    """The tests of "that is ..." or "is ...?"."""


class Core(tuple[str, ...]):
    """The words of a noun phrase."""


class Rank(tuple[s.OrderKey | None, int | None, int | None]):
    """The superlative, the ordinal and the amount of a noun phrase; each may be None."""


def _digits(token: Token) -> str:
    """Return a number in digits ("two": "2"); other words stay the same."""
    number = english.cardinal(str(token))
    return str(token) if number is None else str(number)


class NounPhrases:
    """Builds noun phrases and their modifiers. Each method builds the grammar rule, or the alias of a rule, of its name."""

    def build(self, rule: str, children: Children) -> Any:
        """Return the meaning of a rule. A rule without a method of its own is a plain node."""
        method = getattr(self, rule, None)
        return Tree(rule, children) if method is None else method(children)

    def description(self, c: Children) -> s.Description:
        return cast(s.Description, c[0])

    def anywhere(self, c: Children) -> s.Description:
        """Build "behind the barrier": everything that is there."""
        return s.Description((s.Phrase(("thing",), tests_of(c)),))

    def np_to(self, c: Children) -> s.Phrase:
        """Build "the closest cone to the van"."""
        *front, other = c
        phrase = self.np(front)
        key: s.OrderKey = phrase.order.key if phrase.order else "nearest"
        return replace(phrase, order=s.Order(key, s.Description((other,))))

    def nps(self, c: Children) -> s.Description:
        """Build a list. The last noun ("red or blue cars") and its modifiers ("cars and vans on the left") apply to all parts."""
        phrases: list[s.Phrase] = of_kind(c, s.Phrase)
        last = phrases[-1]
        spans = nouns_in(last.words)
        if not spans and len(phrases) == 2 and nouns_in(phrases[0].words) and not last.tests and tokens_of(c, "AND"):
            return s.Description((replace(phrases[0], tests=(*phrases[0].tests, s.Is(last.words))),))
        noun = last.words[spans[0][0] : spans[0][1]] if spans else ()
        phrases[:-1] = [
            replace(
                p,
                words=p.words if nouns_in(p.words) else (*p.words, *noun),
                tests=p.tests or (() if p.order else last.tests),
            )
            for p in phrases[:-1]
        ]
        return s.Description(tuple(phrases))

    def core(self, c: Children) -> Core:
        return Core(word for token in c for word in (_digits(token) if token.type == "NUM" else str(token)).split())

    def order(self, c: Children) -> Rank:
        key = cast("s.OrderKey | None", value_of(c, "SUP") or value_of(c, "CMP"))
        ordinal, amount = value_of(c, "ORD"), value_of(c, "NUM")
        return Rank((key, int(ordinal) if ordinal else None, english.cardinal(amount) if amount else None))

    def np(self, c: Children) -> s.Phrase:
        (core,) = of_kind(c, Core)
        return self._phrase(c, core)

    def np_of(self, c: Children) -> s.Phrase:
        """Build "the largest of the vehicles" or "the nearest"."""
        described = of_kind(c, s.Description)
        if not described:
            return self._phrase(c, Core(("thing",)))
        first = described[0].phrases[0]
        return self._phrase([*c, *first.tests], Core(first.words))

    def np_owned(self, c: Children) -> s.Phrase:
        """Build "the worker's helmet" as the helmet on the worker."""
        (owner,), (core,) = of_kind(c, s.Phrase), of_kind(c, Core)
        rest = [x for x in c if x is not owner and x is not core]
        return self._phrase([*rest, s.Relation("on", s.Description((owner,)))], core)

    def owner(self, c: Children) -> s.Phrase:
        return self.np(c)

    def _phrase(self, c: Children, core: Core) -> s.Phrase:
        tests = list(tests_of(c))
        order: s.Order | None = None
        ordinal: int | None = None
        number = value_of(c, "NUM")
        amount = english.cardinal(number) if number else None
        for key, nth, ranked_amount in of_kind(c, Rank):
            order = s.Order(key) if key else None
            ordinal = nth
            amount = ranked_amount or amount
        for test in [t for t in tests if isinstance(t, s.Order)]:
            order = test
            tests.remove(test)
        return s.Phrase(tuple(core), tuple(tests), order, ordinal, amount)

    def loose(self, c: Children) -> s.Test:
        words = tuple(str(t) for t in tokens_of(c, "W"))
        return s.Not(s.Is(words)) if tokens_of(c, "NOT") else s.Is(words)

    def adjective(self, c: Children) -> s.Test:
        words = s.Is((*(str(t) for t in tokens_of(c, "NUM")), *of_kind(c, Core)[0]))
        return s.Not(words) if tokens_of(c, "NOT") else words

    def not_test(self, c: Children) -> s.Not:
        return s.Not(tests_of(c)[0])

    def relation(self, c: Children) -> s.Relation:
        kind, _, preposition = str(c[0]).partition(":")
        return s.Relation(cast(s.RelationKind, kind), descriptions(c)[0], preposition)

    def either(self, c: Children) -> s.Any:
        return s.Any(tuple(self.relation([t, *descriptions(c)]) for t in tokens_of(c, "REL")))

    def limit(self, c: Children) -> s.Within:
        other = descriptions(c)
        beyond = bool(tokens_of(c, "BEYOND")) or value_of(c, "CMP") == "furthest"
        return s.Within(float(english.cardinal(value_of(c, "NUM") or "0") or 0), other[0] if other else None, beyond)

    def of(self, c: Children) -> s.Relation:
        return s.Relation("on", descriptions(c)[0], "of")

    def between(self, c: Children) -> s.Between:
        first, second = descriptions(c)
        return s.Between(first, second)

    def among(self, c: Children) -> s.Between:
        (both,) = descriptions(c)
        return s.Between(both, both)

    def region(self, c: Children) -> s.Region:
        return s.Region(tuple(cast(s.Side, str(t)) for t in tokens_of(c, "SIDE")), "half" in tokens_of(c, "PART"))

    def zone(self, c: Children) -> s.Region:
        return s.Region((cast(s.Side, str(c[0])),))

    def has(self, c: Children) -> s.Has:
        return s.Has(descriptions(c)[0])

    def wears(self, c: Children) -> s.Has:
        return s.Has(descriptions(c)[0], worn=True)

    def lacks(self, c: Children) -> s.Not:
        return s.Not(s.Has(descriptions(c)[0], worn=bool(tokens_of(c, "WEAR"))))

    def excepted(self, c: Children) -> s.Not:
        return s.Not(s.Any(tuple(s.Is(p.words) for p in descriptions(c)[0].phrases)))

    def measured(self, c: Children) -> s.Measured:
        return s.Measured(cast(s.OrderKey, value_of(c, "CMP")), descriptions(c)[0])

    def faces(self, c: Children) -> s.Faces:
        return s.Faces(cast(s.Side, str(tokens_of(c, "SIDE")[0])))

    def says(self, c: Children) -> s.Says:
        literal = value_of(c, "TEXT") or " ".join(x for core in of_kind(c, Core) for x in core)
        return s.Says(tuple(english.letters(literal).split()))

    def ordered(self, c: Children) -> s.Order:
        reference = descriptions(c)
        return s.Order(cast(s.OrderKey, value_of(c, "SUP")), reference[0] if reference else None)

    def from_side(self, c: Children) -> s.Order:
        return s.Order(cast(s.OrderKey, value_of(c, "SIDE")))

    def that(self, c: Children) -> _Predicate:
        return _Predicate(tests_of(c))

    def predicate(self, c: Children) -> _Predicate:
        """Build a predicate. If its tests are joined by "or", one of them must hold; otherwise all must hold."""
        tests = tests_of(c)
        return _Predicate((s.Any(tests),) if tokens_of(c, "OR") and len(tests) > 1 else tests)

    predicate_at = that
