"""Build the questions of ``question_tree`` from parse trees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.english.grammar.questions.phrase_builder import (
    Children,
    Core,
    NounPhrases,
    descriptions,
    instances_of,
    tests_of,
    tokens_of,
    value_of,
)
from scope_ptz.english.grammar.questions.typed_tokens import Token

EVERYTHING = tree.Description((tree.Phrase(("thing",)),))

_VIEW_WORDS = frozenset(
    ["scene", "view", "picture", "image", "frame", "photo", "surroundings", "everything", "it", "this", "area", "situation"]
)


def _text_owner(what: tree.Description) -> tree.Description | None:
    """Return the thing that the text is on ("the words on the van": the van); None if the question names only "the text"."""
    phrase = what.phrases[0]
    if phrase.words[-1] not in _TEXT_NOUNS:
        return what
    owners = [t.other for t in phrase.tests if isinstance(t, tree.Relation)]
    return owners[0] if owners else None


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


class Subject(tuple[tree.Description, str]):
    """The subject of a yes-or-no question, with its scope."""


class QuestionBuilder(NounPhrases):
    """A builder of questions. Each method builds the node for the grammar rule of the same name."""

    def question(self, children: Children) -> tree.Question:
        return cast(tree.Question, next(x for x in children if not isinstance(x, Token)))

    def exists(self, children: Children) -> tree.Exists:
        what = descriptions(children)[0]
        amount = what.phrases[0].amount if len(what.phrases) == 1 and what.phrases[0].order is None else None
        if amount is None:
            return tree.Exists(what)
        if tokens_of(children, "ATLEAST", "MORE"):
            return tree.Exists(what, least=amount + bool(tokens_of(children, "MORE")))
        if tokens_of(children, "ATMOST", "FEWER"):
            return tree.Exists(what, least=0, most=amount - bool(tokens_of(children, "FEWER")))
        return tree.Exists(what, least=amount, most=amount)

    def absent(self, children: Children) -> tree.Exists:
        return tree.Exists(descriptions(children)[0], negated=True)

    def count(self, children: Children) -> tree.Count:
        return tree.Count(descriptions(children)[0], tests_of(children))

    def count_of(self, children: Children) -> tree.Count:
        what, owner = descriptions(children)
        return tree.Count(what, (tree.Relation("on", owner),))

    def count_any(self, children: Children) -> tree.Count:
        """Build "how many are wearing helmets?", which is about people, or "how many are red?", which is about anything."""
        tests = tests_of(children)
        worn = any(isinstance(t, tree.Has) and t.worn for t in tests)
        return tree.Count(tree.Description((tree.Phrase(("people" if worn else "things",)),)), tests)

    def count_read(self, children: Children) -> tree.Count:
        return tree.Count(descriptions(children)[0], (tree.Says(()),))

    def what_read(self, children: Children) -> tree.What:
        return tree.What(descriptions(children)[0], (tree.Says(()),))

    def count_kinds(self, children: Children) -> tree.CountKinds:
        return tree.CountKinds(("colour",) if tokens_of(children, "COLOUR") else ("kind",), descriptions(children)[0])

    def subject(self, children: Children) -> Subject:
        return Subject((descriptions(children)[0], "the"))

    def subject_all(self, children: Children) -> Subject:
        return Subject((descriptions(children)[0], "all"))

    def subject_any(self, children: Children) -> Subject:
        return Subject((descriptions(children)[0], "any"))

    def subject_none(self, children: Children) -> Subject:
        return Subject((descriptions(children)[0], "none"))

    def yesno(self, children: Children) -> tree.YesNo:
        ((subject, scope),) = instances_of(children, Subject)
        return tree.YesNo(subject, tests_of(children), scope)

    def yesno_has(self, children: Children) -> tree.YesNo:
        ((subject, scope),) = instances_of(children, Subject)
        has = tree.Has(descriptions(children)[0])
        return tree.YesNo(subject, (tree.Not(has) if tokens_of(children, "NONE") else has,), scope)

    def isa(self, children: Children) -> tree.IsA:
        subject, what = descriptions(children)
        return tree.IsA(subject, what)

    def ask_colour(self, children: Children) -> tree.Ask:
        return tree.Ask(("colour",), self._owned_thing(descriptions(children)))

    def _owned_thing(self, parts: list[tree.Description]) -> tree.Description:
        """Return the thing that is asked about: "helmet on the worker" for "what colour helmet is the worker wearing"."""
        if len(parts) == 1:
            return parts[0]
        part, owner = parts
        phrase = part.phrases[0]
        words = tuple(x for x in phrase.words if x not in {"colour", "color", "colours", "colors"})
        return tree.Description((tree.Phrase(words, (*phrase.tests, tree.Relation("on", owner))),))

    def colours_seen(self, children: Children) -> tree.CountKinds:
        return tree.CountKinds(("colour",), tree.Description((tree.Phrase(("thing",), tests_of(children)),)))

    def ask_worn(self, children: Children) -> tree.Ask:
        with_word = value_of(children, "WITH")
        return tree.Ask(("wearing",) if with_word is None else ("carrying",), descriptions(children)[0])

    def ask_carried(self, children: Children) -> tree.Ask:
        return tree.Ask(("carrying",), descriptions(children)[0])

    def ask_sold(self, children: Children) -> tree.Ask:
        return tree.Ask(("sells",), descriptions(children)[0])

    def ask_direction(self, children: Children) -> tree.Ask:
        return tree.Ask(("direction",), descriptions(children)[0])

    def ask_doing(self, children: Children) -> tree.Ask | tree.Read:
        if value_of(children, "W") in {"called", "named"}:  # names are written on things
            return tree.Read(descriptions(children)[0])
        return tree.Ask((str(value_of(children, "W")),), descriptions(children)[0])

    def ask_attribute(self, children: Children) -> tree.Ask | tree.Read:
        if instances_of(children, Core)[0][-1] in _TEXT_NOUNS:
            return tree.Read(descriptions(children)[0])
        return tree.Ask(tuple(instances_of(children, Core)[0]), descriptions(children)[0])

    def ask_of(self, children: Children) -> tree.Ask:
        attribute, what = descriptions(children)
        words = attribute.phrases[0].words
        if len(words) > 1 and words[-1] in {"colour", "color"}:  # "the helmet colour of the worker"
            return tree.Ask(("colour",), self._owned_thing([tree.Description((tree.Phrase(words[:-1]),)), what]))
        return tree.Ask(attribute.phrases[0].words, what)

    def read(self, children: Children) -> tree.Read:
        described = descriptions(children)
        return tree.Read(_text_owner(described[-1]) if described else None)

    def price(self, children: Children) -> tree.Price:
        what, *places = descriptions(children)
        tests = tuple(tree.Relation("on", place) for place in places)
        return tree.Price(tree.Description(tuple(replace(p, tests=(*p.tests, *tests)) for p in what.phrases)))

    def time(self, children: Children) -> tree.Time:
        return tree.Time(descriptions(children)[-1])

    def plate(self, children: Children) -> tree.Read:
        described = descriptions(children)
        return tree.Read(described[0] if described else None, plate=True)

    def legible(self, children: Children) -> tree.TextExists:
        described = descriptions(children)
        return tree.TextExists(described[0] if described else None)

    def where(self, children: Children) -> tree.Where:
        return tree.Where(descriptions(children)[0])

    def quarter(self, children: Children) -> tree.Quarter:
        return tree.Quarter(descriptions(children)[0])

    def in_order(self, children: Children) -> tree.InOrder:
        criterion = value_of(children, "INORDER") or ""
        default = "nearest" if "distance" in criterion else "most" if "number" in criterion or "many" in criterion else "left"
        return tree.InOrder(cast("tree.OrderKey", value_of(children, "RANKBY") or default), descriptions(children)[0])

    def what_at(self, children: Children) -> tree.What:
        who = bool(tokens_of(children, "WHO"))
        return tree.What(tree.Description((tree.Phrase(("person",)),)) if who else EVERYTHING, tests_of(children))

    def who_does(self, children: Children) -> tree.What:
        """Build "who is driving the taxi?"."""
        words = descriptions(children)[0].phrases[0].words
        tests = (tree.Is((str(value_of(children, "W")),)), tree.Is(words))
        return tree.What(tree.Description((tree.Phrase(("person",)),)), tests)

    def what_that(self, children: Children) -> tree.What:
        return tree.What(descriptions(children)[0], tests_of(children))

    def present(self, children: Children) -> tree.Present:
        return tree.Present(descriptions(children)[0])

    def kind_seen(self, children: Children) -> tree.KindOf:
        what = descriptions(children)[0]
        tests = tests_of(children)
        return tree.KindOf(tree.Description(tuple(replace(p, tests=(*p.tests, *tests)) for p in what.phrases)))

    def kind_is(self, children: Children) -> tree.KindOf:
        kind, description = descriptions(children)
        spans = nouns_in(kind.phrases[0].words)
        noun = kind.phrases[0].words[spans[0][0] : spans[0][1]] if spans else ()
        return tree.KindOf(
            tree.Description(
                tuple(replace(p, words=(*p.words[:-1], *noun)) if noun and p.words[-1] == "one" else p for p in description.phrases)
            )
        )

    def identify(self, children: Children) -> tree.Identify | tree.Read:
        what = descriptions(children)[0]
        owner = _text_owner(what)
        return tree.Identify(what) if owner is None or owner == what else tree.Read(owner)

    def who(self, _: Children) -> tree.What:
        return tree.What(tree.Description((tree.Phrase(("person",)),)))

    def which(self, children: Children) -> tree.Which:
        key = value_of(children, "CMP") or value_of(children, "SUP") or value_of(children, "TAKES")
        return tree.Which(cast(tree.OrderKey, key), descriptions(children)[-1])

    def far(self, children: Children) -> tree.HowFar:
        what, *other = descriptions(children)
        if len(what.phrases) == 2 and not other:
            what, *other = (tree.Description((p,)) for p in what.phrases)
        return tree.HowFar(what, other[0] if other else None)

    def compare(self, children: Children) -> tree.Compare:
        first, second = descriptions(children)
        return tree.Compare(cast(tree.OrderKey, value_of(children, "CMP")), first, second)

    def compare_count(self, children: Children) -> tree.CompareCount:
        first, second = descriptions(children)
        return tree.CompareCount(self._more_or_fewer(children), first, second)

    def more_or_less(self, children: Children) -> tree.CompareCount:
        """Build "are there more vans than cars, fewer, or just as many?"."""
        first, second = descriptions(children)
        return tree.CompareCount(self._more_or_fewer(children[:3]), first, second, which=True)

    def compare_numbers(self, children: Children) -> tree.CompareCount:
        first, second = descriptions(children)
        return tree.CompareCount("more", first, second, which=True)

    def difference(self, children: Children) -> tree.Difference:
        first, second = descriptions(children)
        return tree.Difference(first, second)

    def more_of(self, children: Children) -> tree.CompareCount:
        options = descriptions(children)[0].phrases
        first, second = tree.Description(options[:1]), tree.Description(options[1:])
        return tree.CompareCount(self._more_or_fewer(children), first, second, which=True)

    def _more_or_fewer(self, children: Children) -> Any:
        return "same" if tokens_of(children, "SAMEAS") else "fewer" if tokens_of(children, "FEWER") else "more"

    def common(self, children: Children) -> tree.MostCommon:
        described = descriptions(children)
        attribute = ("colour",) if tokens_of(children, "COLOUR") else ("kind",)
        return tree.MostCommon(attribute, described[-1] if described else EVERYTHING, bool(tokens_of(children, "LEAST")))

    def describe(self, children: Children) -> tree.Describe:
        described = descriptions(children)
        if described and described[0].phrases[0].words[-1] not in _VIEW_WORDS:
            return tree.Describe(tests_of(children), described[0])
        return tree.Describe(tests_of(children) or (described[0].phrases[0].tests if described else ()))

    def happening(self, _: Children) -> tree.Happening:
        return tree.Happening()
