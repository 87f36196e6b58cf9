"""Build the noun phrases of ``question_tree`` from parse trees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from scope_ptz import english
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.typed_tokens import Token

Children = list[Any]
"""The nodes that were built for the children of a parse tree node, or their tokens."""


def tokens_of(children: Children, *kinds: str) -> list[Token]:
    """Return the tokens of the given types among the children."""
    return [c for c in children if isinstance(c, Token) and c.type in kinds]


def instances_of(children: Children, kind: type[Any]) -> list[Any]:
    """Return the children that are instances of a class."""
    return [c for c in children if isinstance(c, kind)]


def value_of(children: Children, kind: str) -> str | None:
    """Return the text of the first token of a type; None if there is none."""
    tokens = tokens_of(children, kind)
    return str(tokens[0]) if tokens else None


def descriptions(children: Children) -> list[tree.Description]:
    """Return the descriptions among the children. A single noun phrase counts as one."""
    return [
        tree.Description((c,)) if isinstance(c, tree.Phrase) else c
        for c in children
        if isinstance(c, tree.Phrase | tree.Description)
    ]


def tests_of(children: Children) -> tuple[tree.Test, ...]:
    """Return the tests among the children, including those of a predicate."""
    tests: list[tree.Test] = []
    for child in children:
        if isinstance(child, _Predicate):
            tests += child
        elif isinstance(child, tree.Test):
            tests.append(child)
    return tuple(tests)


_ADJECTIVES = english.COLOURS | {
    "big",
    "small",
    "large",
    "tall",
    "dark",
    "light",
    "bright",
    "other",
    "left",
    "right",
    "open",
    "closed",
}
"""Words that can follow an article without a noun: "the red or the blue car"."""

_DEFINITE_DETERMINERS = frozenset(
    {"the", "these", "those", "its", "their", "his", "her", "your", "my", "both", "all of the", "all the"}
)


class _Predicate(tuple[tree.Test, ...]):
    """The tests of a relative clause ("that is ...") or of a question ("is ...?")."""


def _with_shared_reference(tests: tuple[tree.Test, ...]) -> tuple[tree.Test, ...]:
    """Return the alternatives of "to the left or to the right of the van", in which the van belongs to both."""
    match tests:
        case (
            tree.Region(sides=("left" | "right" as side,), half=False),
            tree.Relation(kind="left" | "right", other=other) as last,
        ):
            return tree.Relation(side, other), last
        case _:
            return tests


class Core(tuple[str, ...]):
    """The words of a noun phrase."""


class Rank(tuple[tree.OrderKey | None, int | None, int | None]):
    """The superlative, the ordinal and the amount of a noun phrase; each may be None."""


def _digits(token: Token) -> str:
    """Return a number in digits ("two": "2"); other words stay the same."""
    number = english.cardinal(str(token))
    return str(token) if number is None else str(number)


class NounPhrases:
    """A builder of noun phrases and their modifiers. Each method builds the node for the grammar rule or alias of the same name."""

    def build(self, rule: str, children: Children) -> Any:
        """Return the node for a rule."""
        return getattr(self, rule)(children)

    def description(self, children: Children) -> tree.Description:
        return cast(tree.Description, children[0])

    def anywhere(self, children: Children) -> tree.Description:
        """Build the description of everything at a place such as "behind the barrier"."""
        return tree.Description((tree.Phrase(("thing",), tests_of(children)),))

    def np_to(self, children: Children) -> tree.Phrase:
        """Build "the closest cone to the van"."""
        *front, other = children
        phrase = self.np(front)
        key: tree.OrderKey = phrase.order.key if phrase.order else "nearest"
        return replace(phrase, order=tree.Order(key, tree.Description((other,))))

    def nps(self, children: Children) -> tree.Description:
        """Build the description for a list of noun phrases.

        The last noun ("red or blue cars") and its modifiers ("cars and vans on the left") apply to all items. If every item has an
        own article, the modifiers belong to the last item: "the van or the worker with a broom".
        """
        first, *rest = instances_of(children, tree.Phrase)
        phrases: list[tree.Phrase] = [first, *(_with_noun_for_one(p, first) for p in rest)]
        last = phrases[-1]
        spans = nouns_in(last.words)
        if not spans and len(phrases) == 2 and nouns_in(phrases[0].words) and not last.tests and tokens_of(children, "AND"):
            return tree.Description((replace(phrases[0], tests=(*phrases[0].tests, tree.Is(last.words))),))
        noun = last.words[spans[0][0] : spans[0][1]] if spans else ()
        phrases[:-1] = [
            replace(
                p,
                words=p.words if nouns_in(p.words) or (p.article and not _ADJECTIVES.issuperset(p.words)) else (*p.words, *noun),
                tests=p.tests or (() if p.order or (p.article and last.article) else last.tests),
            )
            for p in phrases[:-1]
        ]
        return tree.Description(tuple(phrases), by_and=len(phrases) > 1 and bool(tokens_of(children, "AND")))

    def core(self, children: Children) -> Core:
        return Core(word for token in children for word in (_digits(token) if token.type == "NUM" else str(token)).split())

    def order(self, children: Children) -> Rank:
        key = cast("tree.OrderKey | None", value_of(children, "SUP") or value_of(children, "CMP"))
        ordinal, amount = value_of(children, "ORD"), value_of(children, "NUM")
        return Rank((key, int(ordinal) if ordinal else None, english.cardinal(amount) if amount else None))

    def np(self, children: Children) -> tree.Phrase:
        (core,) = instances_of(children, Core)
        return self._phrase(children, core)

    def np_of(self, children: Children) -> tree.Phrase:
        """Build "the largest of the vehicles" or "the nearest"."""
        described = instances_of(children, tree.Description)
        if not described:
            return self._phrase(children, Core(("thing",)))
        first = described[0].phrases[0]
        return self._phrase([*children, *first.tests], Core(first.words))

    def np_owned(self, children: Children) -> tree.Phrase:
        """Build "the worker's helmet" as the helmet on the worker."""
        (owner,), (core,) = instances_of(children, tree.Phrase), instances_of(children, Core)
        rest = [x for x in children if x is not owner and x is not core]
        return self._phrase([*rest, tree.Relation("on", tree.Description((owner,)))], core)

    def owner(self, children: Children) -> tree.Phrase:
        return self.np(children)

    def _phrase(self, children: Children, core: Core) -> tree.Phrase:
        tests = list(tests_of(children))
        order: tree.Order | None = None
        ordinal: int | None = None
        number = value_of(children, "NUM")
        amount = english.cardinal(number) if number else None
        for key, nth, ranked_amount in instances_of(children, Rank):
            order = tree.Order(key) if key else None
            ordinal = nth
            amount = ranked_amount or amount
        for test in [t for t in tests if isinstance(t, tree.Order)]:
            order = test
            tests.remove(test)
        leading = tokens_of(children, "DET", "A", "THAT")[:1]
        article: Any = "the" if leading and (leading[0].type == "THAT" or leading[0] in _DEFINITE_DETERMINERS) else ""
        article = "a" if leading and leading[0].type == "A" else article
        return tree.Phrase(tuple(core), tuple(tests), order, ordinal, amount, article)

    def loose(self, children: Children) -> tree.Test:
        words = tuple(str(t) for t in tokens_of(children, "W"))
        return tree.Not(tree.Is(words)) if tokens_of(children, "NOT") else tree.Is(words)

    def adjective(self, children: Children) -> tree.Test:
        words = tree.Is((*(str(t) for t in tokens_of(children, "NUM")), *instances_of(children, Core)[0]))
        return tree.Not(words) if tokens_of(children, "NOT") else words

    def not_test(self, children: Children) -> tree.Not:
        return tree.Not(tests_of(children)[0])

    def relation(self, children: Children) -> tree.Relation:
        kind, _, preposition = str(children[0]).partition(":")
        return tree.Relation(cast(tree.RelationKind, kind), descriptions(children)[0], preposition)

    def either(self, children: Children) -> tree.Any:
        return tree.Any(tuple(self.relation([t, *descriptions(children)]) for t in tokens_of(children, "REL")))

    def limit(self, children: Children) -> tree.Within:
        other = descriptions(children)
        beyond = bool(tokens_of(children, "BEYOND")) or value_of(children, "CMP") == "furthest"
        return tree.Within(float(english.cardinal(value_of(children, "NUM") or "0") or 0), other[0] if other else None, beyond)

    def of(self, children: Children) -> tree.Relation:
        return tree.Relation("on", descriptions(children)[0], "of")

    def between(self, children: Children) -> tree.Between:
        first, second = descriptions(children)
        return tree.Between(first, second)

    def among(self, children: Children) -> tree.Between:
        (both,) = descriptions(children)
        return tree.Between(both, both)

    def region(self, children: Children) -> tree.Region:
        return tree.Region(
            tuple(cast(tree.Side, str(t)) for t in tokens_of(children, "SIDE")), "half" in tokens_of(children, "PART")
        )

    def zone(self, children: Children) -> tree.Region:
        return tree.Region((cast(tree.Side, str(children[0])),))

    def has(self, children: Children) -> tree.Has:
        return tree.Has(descriptions(children)[0])

    def sells(self, children: Children) -> tree.Has:
        return tree.Has(descriptions(children)[0], sold=True)

    def awaits(self, children: Children) -> tree.Is:
        """Build "waiting for the tram", which only a scene's facts can state."""
        phrase = descriptions(children)[0].phrases[0]
        article = [phrase.article] if phrase.article else []
        return tree.Is(("waiting", "for", *article, *phrase.words))

    def wears(self, children: Children) -> tree.Has:
        return tree.Has(descriptions(children)[0], worn=True)

    def lacks(self, children: Children) -> tree.Not:
        return tree.Not(tree.Has(descriptions(children)[0], worn=bool(tokens_of(children, "WEAR"))))

    def excepted(self, children: Children) -> tree.Not:
        return tree.Not(tree.Any(tuple(tree.Is(p.words) for p in descriptions(children)[0].phrases)))

    def measured(self, children: Children) -> tree.Measured:
        return tree.Measured(cast(tree.OrderKey, value_of(children, "CMP")), descriptions(children)[0])

    def faces(self, children: Children) -> tree.Faces:
        return tree.Faces(cast(tree.Side, str(tokens_of(children, "SIDE")[0])))

    def says(self, children: Children) -> tree.Says:
        literal = value_of(children, "TEXT") or " ".join(x for core in instances_of(children, Core) for x in core)
        return tree.Says(tuple(english.letters(literal).split()))

    def ordered(self, children: Children) -> tree.Order:
        reference = descriptions(children)
        return tree.Order(cast(tree.OrderKey, value_of(children, "SUP")), reference[0] if reference else None)

    def from_side(self, children: Children) -> tree.Order:
        return tree.Order(cast(tree.OrderKey, value_of(children, "SIDE")))

    def that(self, children: Children) -> _Predicate:
        return _Predicate(tests_of(children))

    def predicate(self, children: Children) -> _Predicate:
        """Build a predicate. If its tests are joined by "or", one of them must hold; otherwise all must hold."""
        tests = tests_of(children)
        if tokens_of(children, "OR"):
            tests = _with_shared_reference(tests)
        return _Predicate((tree.Any(tests),) if tokens_of(children, "OR") and len(tests) > 1 else tests)

    predicate_at = that


def _with_noun_for_one(phrase: tree.Phrase, first: tree.Phrase) -> tree.Phrase:
    """Return "a blue car" for "a blue one" after "a red car". Other phrases are returned unchanged."""
    spans = nouns_in(first.words)
    if not spans or len(phrase.words) < 2 or phrase.words[-1] not in {"one", "ones"} or nouns_in(phrase.words[:-1]):
        return phrase
    *words, noun = [x for x in first.words[slice(*spans[0])] if x not in english.COLOURS]  # "an orange cone or a red one"
    noun = english.singular(noun) if phrase.words[-1] == "one" else noun
    return replace(phrase, words=(*phrase.words[:-1], *words, noun))
