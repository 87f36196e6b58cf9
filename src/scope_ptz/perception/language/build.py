"""From parse trees to the plain data of ``syntax``."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from lark import Token, Transformer

from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.language.lexicon import nouns_in

Children = list[Any]
EVERYTHING = s.Description((s.Phrase(("thing",)),))


def _tokens(children: Children, *kinds: str) -> list[Token]:
    return [c for c in children if isinstance(c, Token) and c.type in kinds]


def _of(children: Children, kind: type[Any]) -> list[Any]:
    return [c for c in children if isinstance(c, kind)]


def _value(children: Children, kind: str) -> str | None:
    found = _tokens(children, kind)
    return str(found[0]) if found else None


def _descriptions(children: Children) -> list[s.Description]:
    return [s.Description((c,)) if isinstance(c, s.Phrase) else c for c in children if isinstance(c, s.Phrase | s.Description)]


def _tests(children: Children) -> tuple[s.Test, ...]:
    """Tests among the children; those of a predicate (a plain tuple) are spliced in."""
    found: list[s.Test] = []
    for child in children:
        if isinstance(child, _Predicate):
            found += child
        elif isinstance(child, s.Test):
            found.append(child)
    return tuple(found)


class _Predicate(tuple[s.Test, ...]):
    """The tests of "that is ...", "is ...?"."""


class _Core(tuple[str, ...]):
    """The words of a noun phrase."""


class _Subject(tuple[s.Description, str]):
    """Subject of a yes/no question, with its scope."""


class _Rank(tuple[s.OrderKey | None, int | None, int | None]):
    """Superlative, ordinal, amount."""


_THE_VIEW = frozenset("scene view picture image frame photo surroundings everything it this area situation".split())


def _bearer(what: s.Description) -> s.Description | None:
    """What bears a text: "the words on the van" are the van's; None for "the text"."""
    phrase = what.phrases[0]
    if phrase.words[-1] not in _TEXTS:
        return what
    holders = [t.other for t in phrase.tests if isinstance(t, s.Relation)]
    return holders[0] if holders else None


_TEXTS = frozenset("text texts writing word words lettering letters inscription message caption slogan name number it".split())


class NounPhrases(Transformer[Token, Any]):
    """Noun phrases and what may follow them."""

    def description(self, c: Children) -> s.Description:
        return cast(s.Description, c[0])

    def anywhere(self, c: Children) -> s.Description:
        """ "Behind the barrier": everything there."""
        return s.Description((s.Phrase(("thing",), _tests(c)),))

    def np_to(self, c: Children) -> s.Phrase:
        """ "The closest cone to the van"."""
        *front, other = c
        phrase = self.np(front)
        key: s.OrderKey = phrase.order.key if phrase.order else "nearest"
        return replace(phrase, order=s.Order(key, s.Description((other,))))

    def nps(self, c: Children) -> s.Description:
        """What follows the last of several nouns goes for all ("cars and vans on the left"), and so does its noun ("red or blue cars")."""
        phrases: list[s.Phrase] = _of(c, s.Phrase)
        last = phrases[-1]
        spans = nouns_in(last.words)
        if not spans and len(phrases) == 2 and nouns_in(phrases[0].words) and not last.tests and _tokens(c, "AND"):
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

    def core(self, c: Children) -> _Core:
        return _Core(word for token in c for word in str(token).split())

    def order(self, c: Children) -> _Rank:
        key = cast("s.OrderKey | None", _value(c, "SUP") or _value(c, "CMP"))
        ordinal, amount = _value(c, "ORD"), _value(c, "NUM")
        return _Rank((key, int(ordinal) if ordinal else None, w.number(amount) if amount else None))

    def np(self, c: Children) -> s.Phrase:
        (core,) = _of(c, _Core)
        return self._phrase(c, core)

    def np_of(self, c: Children) -> s.Phrase:
        """ "the largest of the vehicles", "the nearest"."""
        described = _of(c, s.Description)
        if not described:
            return self._phrase(c, _Core(("thing",)))
        first = described[0].phrases[0]
        return self._phrase([*c, *first.tests], _Core(first.words))

    def np_owned(self, c: Children) -> s.Phrase:
        """ "the worker's helmet": the helmet on the worker."""
        (owner,), (core,) = _of(c, s.Phrase), _of(c, _Core)
        rest = [x for x in c if x is not owner and x is not core]
        return self._phrase([*rest, s.Relation("on", s.Description((owner,)))], core)

    def owner(self, c: Children) -> s.Phrase:
        return self.np(c)

    def _phrase(self, c: Children, core: _Core) -> s.Phrase:
        tests = list(_tests(c))
        order: s.Order | None = None
        ordinal: int | None = None
        number = _value(c, "NUM")
        amount = w.number(number) if number else None
        for key, nth, ranked_amount in _of(c, _Rank):
            order = s.Order(key) if key else None
            ordinal = nth
            amount = ranked_amount or amount
        for test in [t for t in tests if isinstance(t, s.Order)]:
            order = test
            tests.remove(test)
        return s.Phrase(tuple(core), tuple(tests), order, ordinal, amount)

    def loose(self, c: Children) -> s.Test:
        words = tuple(str(t) for t in _tokens(c, "W"))
        return s.Not(s.Is(words)) if _tokens(c, "NOT") else s.Is(words)

    def adjective(self, c: Children) -> s.Test:
        words = s.Is((*(str(t) for t in _tokens(c, "NUM")), *_of(c, _Core)[0]))
        return s.Not(words) if _tokens(c, "NOT") else words

    def not_test(self, c: Children) -> s.Not:
        return s.Not(_tests(c)[0])

    def relation(self, c: Children) -> s.Relation:
        kind, _, said = str(c[0]).partition(":")
        return s.Relation(cast(s.RelationKind, kind), _descriptions(c)[0], said)

    def either(self, c: Children) -> s.Any:
        return s.Any(tuple(self.relation([t, *_descriptions(c)]) for t in _tokens(c, "REL")))

    def limit(self, c: Children) -> s.Within:
        other = _descriptions(c)
        beyond = bool(_tokens(c, "BEYOND")) or _value(c, "CMP") == "furthest"
        return s.Within(float(w.number(_value(c, "NUM") or "0") or 0), other[0] if other else None, beyond)

    def of(self, c: Children) -> s.Relation:
        return s.Relation("on", _descriptions(c)[0], "of")

    def between(self, c: Children) -> s.Between:
        first, second = _descriptions(c)
        return s.Between(first, second)

    def among(self, c: Children) -> s.Between:
        (both,) = _descriptions(c)
        return s.Between(both, both)

    def region(self, c: Children) -> s.Region:
        return s.Region(tuple(cast(s.Side, str(t)) for t in _tokens(c, "SIDE")), "half" in _tokens(c, "PART"))

    def zone(self, c: Children) -> s.Region:
        return s.Region((cast(s.Side, str(c[0])),))

    def has(self, c: Children) -> s.Has:
        return s.Has(_descriptions(c)[0])

    def wears(self, c: Children) -> s.Has:
        return s.Has(_descriptions(c)[0], worn=True)

    def lacks(self, c: Children) -> s.Not:
        return s.Not(s.Has(_descriptions(c)[0], worn=bool(_tokens(c, "WEAR"))))

    def excepted(self, c: Children) -> s.Not:
        return s.Not(s.Any(tuple(s.Is(p.words) for p in _descriptions(c)[0].phrases)))

    def measured(self, c: Children) -> s.Measured:
        return s.Measured(cast(s.OrderKey, _value(c, "CMP")), _descriptions(c)[0])

    def faces(self, c: Children) -> s.Faces:
        return s.Faces(cast(s.Side, str(_tokens(c, "SIDE")[0])))

    def says(self, c: Children) -> s.Says:
        literal = _value(c, "TEXT") or " ".join(x for core in _of(c, _Core) for x in core)
        return s.Says(tuple(w.letters(literal).split()))

    def ordered(self, c: Children) -> s.Order:
        reference = _descriptions(c)
        return s.Order(cast(s.OrderKey, _value(c, "SUP")), reference[0] if reference else None)

    def from_side(self, c: Children) -> s.Order:
        return s.Order(cast(s.OrderKey, _value(c, "SIDE")))

    def that(self, c: Children) -> _Predicate:
        return _Predicate(_tests(c))

    def predicate(self, c: Children) -> _Predicate:
        """ "red or blue" holds when either does, everything else when all do."""
        tests = _tests(c)
        return _Predicate((s.Any(tests),) if _tokens(c, "OR") and len(tests) > 1 else tests)

    predicate_at = that


class Builder(NounPhrases):
    """Questions."""

    def question(self, c: Children) -> s.Question:
        return cast(s.Question, [x for x in c if not isinstance(x, Token)][0])

    def exists(self, c: Children) -> s.Exists:
        what = _descriptions(c)[0]
        amount = what.phrases[0].amount if len(what.phrases) == 1 and what.phrases[0].order is None else None
        if amount is None:
            return s.Exists(what)
        if _tokens(c, "ATLEAST", "MORE"):
            return s.Exists(what, least=amount + bool(_tokens(c, "MORE")))
        if _tokens(c, "ATMOST", "FEWER"):
            return s.Exists(what, least=0, most=amount - bool(_tokens(c, "FEWER")))
        return s.Exists(what, least=amount, most=amount)

    def absent(self, c: Children) -> s.Exists:
        return s.Exists(_descriptions(c)[0], negated=True)

    def count(self, c: Children) -> s.Count:
        return s.Count(_descriptions(c)[0], _tests(c))

    def count_of(self, c: Children) -> s.Count:
        what, owner = _descriptions(c)
        return s.Count(what, (s.Relation("on", owner),))

    def subject(self, c: Children) -> _Subject:
        return _Subject((_descriptions(c)[0], "the"))

    def subject_all(self, c: Children) -> _Subject:
        return _Subject((_descriptions(c)[0], "all"))

    def subject_any(self, c: Children) -> _Subject:
        return _Subject((_descriptions(c)[0], "any"))

    def subject_none(self, c: Children) -> _Subject:
        return _Subject((_descriptions(c)[0], "none"))

    def yesno(self, c: Children) -> s.YesNo:
        ((subject, scope),) = _of(c, _Subject)
        return s.YesNo(subject, _tests(c), scope)

    def yesno_has(self, c: Children) -> s.YesNo:
        ((subject, scope),) = _of(c, _Subject)
        has = s.Has(_descriptions(c)[0])
        return s.YesNo(subject, (s.Not(has) if _tokens(c, "NONE") else has,), scope)

    def isa(self, c: Children) -> s.IsA:
        subject, what = _descriptions(c)
        return s.IsA(subject, what)

    def ask_colour(self, c: Children) -> s.Ask:
        return s.Ask(("colour",), self._owned(_descriptions(c)))

    def _owned(self, found: list[s.Description]) -> s.Description:
        """ "What colour helmet is the worker wearing": the helmet on the worker."""
        if len(found) == 1:
            return found[0]
        part, owner = found
        phrase = part.phrases[0]
        return s.Description((s.Phrase(phrase.words, (*phrase.tests, s.Relation("on", owner))),))

    def ask_worn(self, c: Children) -> s.Ask:
        return s.Ask((_value(c, "WITH") or "wearing",), _descriptions(c)[0])

    def ask_direction(self, c: Children) -> s.Ask:
        return s.Ask(("direction",), _descriptions(c)[0])

    def ask_doing(self, c: Children) -> s.Ask:
        return s.Ask((str(_value(c, "W")),), _descriptions(c)[0])

    def ask_attribute(self, c: Children) -> s.Ask:
        return s.Ask(tuple(_of(c, _Core)[0]), _descriptions(c)[0])

    def ask_of(self, c: Children) -> s.Ask:
        attribute, what = _descriptions(c)
        return s.Ask(attribute.phrases[0].words, what)

    def read(self, c: Children) -> s.Read:
        found = _descriptions(c)
        return s.Read(_bearer(found[-1]) if found else None)

    def plate(self, c: Children) -> s.Read:
        found = _descriptions(c)
        return s.Read(found[0] if found else None, plate=True)

    def legible(self, c: Children) -> s.TextExists:
        found = _descriptions(c)
        return s.TextExists(found[0] if found else None)

    def where(self, c: Children) -> s.Where:
        return s.Where(_descriptions(c)[0])

    def what_at(self, c: Children) -> s.What:
        who = bool(_tokens(c, "WHO"))
        return s.What(s.Description((s.Phrase(("person",)),)) if who else EVERYTHING, _tests(c))

    def what_that(self, c: Children) -> s.What:
        return s.What(_descriptions(c)[0], _tests(c))

    def kind_is(self, c: Children) -> s.Identify:
        kind, asked = _descriptions(c)
        spans = nouns_in(kind.phrases[0].words)
        noun = kind.phrases[0].words[spans[0][0] : spans[0][1]] if spans else ()
        return s.Identify(
            s.Description(
                tuple(replace(p, words=(*p.words[:-1], *noun)) if noun and p.words[-1] == "one" else p for p in asked.phrases)
            )
        )

    def identify(self, c: Children) -> s.Identify:
        return s.Identify(_descriptions(c)[0])

    def who(self, c: Children) -> s.What:
        return s.What(s.Description((s.Phrase(("person",)),)))

    def which(self, c: Children) -> s.Which:
        key = _value(c, "CMP") or _value(c, "SUP")
        return s.Which(cast(s.OrderKey, key), _descriptions(c)[-1])

    def far(self, c: Children) -> s.HowFar:
        what, *other = _descriptions(c)
        if len(what.phrases) == 2 and not other:
            what, *other = (s.Description((p,)) for p in what.phrases)
        return s.HowFar(what, other[0] if other else None)

    def compare(self, c: Children) -> s.Compare:
        first, second = _descriptions(c)
        return s.Compare(cast(s.OrderKey, _value(c, "CMP")), first, second)

    def compare_count(self, c: Children) -> s.CompareCount:
        first, second = _descriptions(c)
        return s.CompareCount(self._sense(c), first, second)

    def more_of(self, c: Children) -> s.CompareCount:
        options = _descriptions(c)[0].phrases
        first, second = s.Description(options[:1]), s.Description(options[1:])
        return s.CompareCount(self._sense(c), first, second, which=True)

    def _sense(self, c: Children) -> Any:
        return "same" if _tokens(c, "SAMEAS") else "fewer" if _tokens(c, "FEWER") else "more"

    def common(self, c: Children) -> s.MostCommon:
        found = _descriptions(c)
        attribute = ("colour",) if _tokens(c, "COLOUR") else ("kind",)
        return s.MostCommon(attribute, found[-1] if found else EVERYTHING, bool(_tokens(c, "LEAST")))

    def describe(self, c: Children) -> s.Describe:
        found = _descriptions(c)
        if found and found[0].phrases[0].words[-1] not in _THE_VIEW:
            return s.Describe(_tests(c), found[0])
        return s.Describe(_tests(c) or (found[0].phrases[0].tests if found else ()))

    def happening(self, c: Children) -> s.Happening:
        return s.Happening()
