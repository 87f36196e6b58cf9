"""Builds questions, as ``question_tree`` defines them, from parse trees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from lark import Token

from scope_ptz.perception.ground_truth.language import question_tree as s
from scope_ptz.perception.ground_truth.language.concepts import nouns_in
from scope_ptz.perception.ground_truth.language.phrase_builder import (
    Children,
    Core,
    NounPhrases,
    descriptions,
    of_kind,
    tests_of,
    tokens_of,
    value_of,
)

EVERYTHING = s.Description((s.Phrase(("thing",)),))

_THE_VIEW = frozenset(
    ["scene", "view", "picture", "image", "frame", "photo", "surroundings", "everything", "it", "this", "area", "situation"]
)


def _text_owner(what: s.Description) -> s.Description | None:
    """Return the thing that a text is on ("the words on the van": the van); None if only "the text" is asked for."""
    phrase = what.phrases[0]
    if phrase.words[-1] not in _TEXT_NOUNS:
        return what
    holders = [t.other for t in phrase.tests if isinstance(t, s.Relation)]
    return holders[0] if holders else None


_TEXT_NOUNS = frozenset(
    [
        "text",
        "texts",
        "writing",
        "word",
        "words",
        "lettering",
        "letters",
        "inscription",
        "message",
        "caption",
        "slogan",
        "name",
        "number",
        "it",
    ]
)


class Subject(tuple[s.Description, str]):
    """The subject of a yes-or-no question, with its scope."""


class QuestionBuilder(NounPhrases):
    """Builds questions. Each method builds the grammar rule of its name."""

    def question(self, c: Children) -> s.Question:
        return cast(s.Question, next(x for x in c if not isinstance(x, Token)))

    def exists(self, c: Children) -> s.Exists:
        what = descriptions(c)[0]
        amount = what.phrases[0].amount if len(what.phrases) == 1 and what.phrases[0].order is None else None
        if amount is None:
            return s.Exists(what)
        if tokens_of(c, "ATLEAST", "MORE"):
            return s.Exists(what, least=amount + bool(tokens_of(c, "MORE")))
        if tokens_of(c, "ATMOST", "FEWER"):
            return s.Exists(what, least=0, most=amount - bool(tokens_of(c, "FEWER")))
        return s.Exists(what, least=amount, most=amount)

    def absent(self, c: Children) -> s.Exists:
        return s.Exists(descriptions(c)[0], negated=True)

    def count(self, c: Children) -> s.Count:
        return s.Count(descriptions(c)[0], tests_of(c))

    def count_of(self, c: Children) -> s.Count:
        what, owner = descriptions(c)
        return s.Count(what, (s.Relation("on", owner),))

    def count_any(self, c: Children) -> s.Count:
        """Build "how many are wearing helmets?", which is about people, or "how many are red?", which is about anything."""
        tests = tests_of(c)
        worn = any(isinstance(t, s.Has) and t.worn for t in tests)
        return s.Count(s.Description((s.Phrase(("people" if worn else "things",)),)), tests)

    def count_read(self, c: Children) -> s.Count:
        return s.Count(descriptions(c)[0], (s.Says(()),))

    def what_read(self, c: Children) -> s.What:
        return s.What(descriptions(c)[0], (s.Says(()),))

    def count_kinds(self, c: Children) -> s.CountKinds:
        return s.CountKinds(("colour",) if tokens_of(c, "COLOUR") else ("kind",), descriptions(c)[0])

    def subject(self, c: Children) -> Subject:
        return Subject((descriptions(c)[0], "the"))

    def subject_all(self, c: Children) -> Subject:
        return Subject((descriptions(c)[0], "all"))

    def subject_any(self, c: Children) -> Subject:
        return Subject((descriptions(c)[0], "any"))

    def subject_none(self, c: Children) -> Subject:
        return Subject((descriptions(c)[0], "none"))

    def yesno(self, c: Children) -> s.YesNo:
        ((subject, scope),) = of_kind(c, Subject)
        return s.YesNo(subject, tests_of(c), scope)

    def yesno_has(self, c: Children) -> s.YesNo:
        ((subject, scope),) = of_kind(c, Subject)
        has = s.Has(descriptions(c)[0])
        return s.YesNo(subject, (s.Not(has) if tokens_of(c, "NONE") else has,), scope)

    def isa(self, c: Children) -> s.IsA:
        subject, what = descriptions(c)
        return s.IsA(subject, what)

    def ask_colour(self, c: Children) -> s.Ask:
        return s.Ask(("colour",), self._owned(descriptions(c)))

    def _owned(self, found: list[s.Description]) -> s.Description:
        """Return "helmet on the worker" for "what colour helmet is the worker wearing"."""
        if len(found) == 1:
            return found[0]
        part, owner = found
        phrase = part.phrases[0]
        words = tuple(x for x in phrase.words if x not in {"colour", "color", "colours", "colors"})
        return s.Description((s.Phrase(words, (*phrase.tests, s.Relation("on", owner))),))

    def colours_seen(self, c: Children) -> s.CountKinds:
        return s.CountKinds(("colour",), s.Description((s.Phrase(("thing",), tests_of(c)),)))

    def ask_worn(self, c: Children) -> s.Ask:
        held = value_of(c, "WITH")
        return s.Ask(("wearing",) if held is None else ("carrying",), descriptions(c)[0])

    def ask_direction(self, c: Children) -> s.Ask:
        return s.Ask(("direction",), descriptions(c)[0])

    def ask_doing(self, c: Children) -> s.Ask:
        return s.Ask((str(value_of(c, "W")),), descriptions(c)[0])

    def ask_attribute(self, c: Children) -> s.Ask | s.Read:
        if of_kind(c, Core)[0][-1] in _TEXT_NOUNS:
            return s.Read(descriptions(c)[0])
        return s.Ask(tuple(of_kind(c, Core)[0]), descriptions(c)[0])

    def ask_of(self, c: Children) -> s.Ask:
        attribute, what = descriptions(c)
        words = attribute.phrases[0].words
        if len(words) > 1 and words[-1] in {"colour", "color"}:  # "the helmet colour of the worker"
            return s.Ask(("colour",), self._owned([s.Description((s.Phrase(words[:-1]),)), what]))
        return s.Ask(attribute.phrases[0].words, what)

    def read(self, c: Children) -> s.Read:
        found = descriptions(c)
        return s.Read(_text_owner(found[-1]) if found else None)

    def plate(self, c: Children) -> s.Read:
        found = descriptions(c)
        return s.Read(found[0] if found else None, plate=True)

    def legible(self, c: Children) -> s.TextExists:
        found = descriptions(c)
        return s.TextExists(found[0] if found else None)

    def where(self, c: Children) -> s.Where:
        return s.Where(descriptions(c)[0])

    def what_at(self, c: Children) -> s.What:
        who = bool(tokens_of(c, "WHO"))
        return s.What(s.Description((s.Phrase(("person",)),)) if who else EVERYTHING, tests_of(c))

    def what_that(self, c: Children) -> s.What:
        return s.What(descriptions(c)[0], tests_of(c))

    def kind_is(self, c: Children) -> s.Identify:
        kind, asked = descriptions(c)
        spans = nouns_in(kind.phrases[0].words)
        noun = kind.phrases[0].words[spans[0][0] : spans[0][1]] if spans else ()
        return s.Identify(
            s.Description(
                tuple(replace(p, words=(*p.words[:-1], *noun)) if noun and p.words[-1] == "one" else p for p in asked.phrases)
            )
        )

    def identify(self, c: Children) -> s.Identify | s.Read:
        what = descriptions(c)[0]
        owner = _text_owner(what)
        return s.Identify(what) if owner is None or owner == what else s.Read(owner)

    def who(self, _: Children) -> s.What:
        return s.What(s.Description((s.Phrase(("person",)),)))

    def which(self, c: Children) -> s.Which:
        key = value_of(c, "CMP") or value_of(c, "SUP")
        return s.Which(cast(s.OrderKey, key), descriptions(c)[-1])

    def far(self, c: Children) -> s.HowFar:
        what, *other = descriptions(c)
        if len(what.phrases) == 2 and not other:
            what, *other = (s.Description((p,)) for p in what.phrases)
        return s.HowFar(what, other[0] if other else None)

    def compare(self, c: Children) -> s.Compare:
        first, second = descriptions(c)
        return s.Compare(cast(s.OrderKey, value_of(c, "CMP")), first, second)

    def compare_count(self, c: Children) -> s.CompareCount:
        first, second = descriptions(c)
        return s.CompareCount(self._sense(c), first, second)

    def more_of(self, c: Children) -> s.CompareCount:
        options = descriptions(c)[0].phrases
        first, second = s.Description(options[:1]), s.Description(options[1:])
        return s.CompareCount(self._sense(c), first, second, which=True)

    def _sense(self, c: Children) -> Any:
        return "same" if tokens_of(c, "SAMEAS") else "fewer" if tokens_of(c, "FEWER") else "more"

    def common(self, c: Children) -> s.MostCommon:
        found = descriptions(c)
        attribute = ("colour",) if tokens_of(c, "COLOUR") else ("kind",)
        return s.MostCommon(attribute, found[-1] if found else EVERYTHING, bool(tokens_of(c, "LEAST")))

    def describe(self, c: Children) -> s.Describe:
        found = descriptions(c)
        if found and found[0].phrases[0].words[-1] not in _THE_VIEW:
            return s.Describe(tests_of(c), found[0])
        return s.Describe(tests_of(c) or (found[0].phrases[0].tests if found else ()))

    def happening(self, _: Children) -> s.Happening:
        return s.Happening()
