"""Colours, states, clothes, and yes or no about them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.perception.answers.counting import exists, narrowed
from scope_ptz.perception.answers.naming import (
    Reply,
    are,
    name,
    none_of,
    noun,
    place,
    plural,
    reply,
    test_words,
    the,
    unknown,
)
from scope_ptz.perception.answers.reading import spoken_texts
from scope_ptz.perception.facts import (
    COLOUR_KEYS,
    canonical,
    colour_of,
    fact_words,
    fits_noun,
    is_worn,
    key_words,
    opposite,
    value_words,
)
from scope_ptz.perception.language import syntax as s
from scope_ptz.perception.language import words as w
from scope_ptz.perception.language.lexicon import COLOURS, nouns_in, singular_phrase
from scope_ptz.perception.matching import find, holds, noun_of
from scope_ptz.perception.view import Thing, View

_ANYBODY = frozenset("anyone anybody someone somebody anything something".split())
_DOING = frozenset("doing activity action up".split())
_KEY_SYNONYMS = {
    "state": {"state", "status", "condition", "position"},
    "kind": {"kind", "type", "make", "model", "sort"},
    "activity": {"activity", "action", "doing", "task", "up"},
    "material": {"material", "made"},
    "direction": {"direction", "pointing", "facing", "heading", "way"},
}


# Yes or no


def yes_no(view: View, question: s.YesNo) -> Reply:
    subject, tests = _parts(view, question)
    if not tests:
        return exists(view, s.Exists(subject))
    found = find(view, subject)
    if not found:
        return unknown(f"I cannot tell: {none_of(view, subject)}")
    answers = [_every([holds(view, t, test) for test in tests]) for t in found]
    if None in answers and True not in answers:
        return unknown(
            f"I cannot tell whether {the(view, subject, plural(subject))} {_be(subject)} {_said(view, tests)}"
        )
    yes = [t for t, ok in zip(found, answers, strict=True) if ok]
    choice = _choice(view, tests, found)
    if choice is not None:
        return choice
    return _verdict(view, question, subject, tests, found, yes)


def _parts(view: View, question: s.YesNo) -> tuple[s.Description, tuple[s.Test, ...]]:
    """Who is asked about, and what is asked: the predicate may hide behind the noun ("gate open") or be the last restriction."""
    *others, last = question.subject.phrases
    tests = list(question.tests)
    if tests and isinstance(tests[0], s.Is) and not last.tests and not last.order:
        last = replace(last, words=(*last.words, *tests.pop(0).words))  # type: ignore[union-attr]
    head, after = noun_of(view, last.words)
    if after:
        tests.insert(0, s.Is(after))
        last = replace(last, words=head)
    if not tests and last.tests:
        tests = [last.tests[-1]]
        last = replace(last, tests=last.tests[:-1])
        others = [replace(p, tests=tuple(t for t in p.tests if t not in tests)) for p in others]
    while len(tests) > 1 and isinstance(tests[0], s.Region | s.Relation | s.Between):
        last = replace(last, tests=(*last.tests, tests.pop(0)))
    return s.Description((*others, last)), tuple(tests)


def _every(answers: Sequence[bool | None]) -> bool | None:
    return False if False in answers else None if None in answers else True


def _be(subject: s.Description) -> str:
    return "are" if plural(subject) else "is"


def _said(view: View, tests: Sequence[s.Test]) -> str:
    return w.listing([test_words(view, t) for t in tests])


def _choice(view: View, tests: Sequence[s.Test], found: list[Thing]) -> Reply | None:
    """ "Red or white?" is answered by naming the one that holds."""
    match tests:
        case (s.Any(tests=options),):
            held = [o for o in options if any(holds(view, t, o) for t in found)]
            if held:
                return reply(
                    f"the {name(found[0])} {_be_count(found)} {_said(view, held)}"
                    if len(found) == 1
                    else _mixed(view, held, found)
                )
            if (fact := _instead(view, options[0], found)) is not None:
                return reply(f"neither: {fact}")
            return None
        case _:
            return None


def _mixed(view: View, held: Sequence[s.Test], found: list[Thing]) -> str:
    return w.listing(
        [f"{sum(holds(view, t, o) is True for t in found)} of {len(found)} {test_words(view, o)}" for o in held]
    )


def _be_count(found: Sequence[Thing]) -> str:
    return are(len(found))


def _verdict(
    view: View,
    question: s.YesNo,
    subject: s.Description,
    tests: tuple[s.Test, ...],
    found: list[Thing],
    yes: list[Thing],
) -> Reply:
    said = _said(view, tests)
    indefinite = question.scope == "any" or any(p.words[-1] in _ANYBODY for p in subject.phrases if p.words)
    share = f"{len(yes)} of the {len(found)} {noun(view, subject, many=True)} {are(len(yes))} {said}"
    if question.scope == "none":
        return reply(f"yes, none of the {noun(view, subject, many=True)} is {said}" if not yes else f"no, {share}")
    if not yes:
        fact = _instead(view, tests[-1], found) if len(tests) == 1 else None
        if indefinite:
            return reply(f"no, none of the {len(found)} {noun(view, subject, many=True)} in view is {said}")
        many = len(found) > 1
        return reply(f"no, {fact}" if fact else f"no, {the(view, subject, many)} {are(len(found))} not {said}")
    if len(yes) == len(found):
        every = (
            f"all {len(found)} {noun(view, subject, many=True)} are" if len(found) > 1 else f"{the(view, subject)} is"
        )
        return reply(f"yes, {every} {said}")
    if question.scope == "all" or (plural(subject) and not indefinite):
        return reply(f"no, only {share}")
    where = f": the one {place(yes[0])}" if len(yes) == 1 else ""
    return reply(f"yes, {share}{where}")


def _instead(view: View, test: s.Test, found: list[Thing]) -> str | None:
    """What is the case instead of a loose word: "the van is white", "the gate is closed"."""
    if not isinstance(test, s.Is) or len({name(t) for t in found}) > 1:
        return None
    thing, wanted = found[0], canonical(test.words[-1])
    colour = colour_of(thing)
    kind = thing.category
    if wanted in COLOURS and colour:
        return f"the {kind} is {colour}" if len(found) == 1 else f"the {w.plural(kind)} are {colour}"
    for fact in sorted(fact_words(thing)):
        if opposite(wanted, fact):
            return f"the {kind} is {fact}" if len(found) == 1 else f"the {w.plural(kind)} are {fact}"
    if nouns_in(test.words) and not fits_noun(thing, test.words[-1]):
        return f"it is {w.article(name(thing))}"
    return None


def is_a(view: View, question: s.IsA) -> Reply:
    found = find(view, question.subject)
    if not found:
        return unknown(f"I cannot tell: {none_of(view, question.subject)}")
    fitting = find(view, question.what)
    return reply(f"{'yes' if found[0] in fitting else 'no'}, it is {w.article(name(found[0]))}")


# Values of attributes


def ask(view: View, question: s.Ask) -> Reply:
    """The value of an attribute, of one thing or of several."""
    if question.what is None:
        return _anywhere(view, question.attribute)
    found = find(view, question.what)
    if not found:
        return _of_a_part(view, question) or unknown(f"I cannot tell: {none_of(view, question.what)}")
    values = [(t, value_of(view, t, question.attribute)) for t in found]
    told = [(t, v) for t, v in values if v is not None]
    if not told:
        attribute = " ".join(question.attribute)
        return unknown(
            f"I cannot tell: the scene does not say ({attribute} of {the(view, question.what, plural(question.what))})"
        )
    verb = "wearing " if _is_clothes(question.attribute) else ""
    distinct = Counter(v for _, v in told)
    if len(distinct) == 1:
        who = the(view, question.what, many=len(told) > 1)
        return reply(f"{who} {are(len(told))} {verb}{told[0][1]}")
    if not plural(question.what) and len(told) <= 4:
        return reply(w.listing([f"the {t.category} {place(t)} is {verb}{v}" for t, v in told]))
    return reply(
        f"{len(told)} {noun(view, question.what, many=True)}: "
        + w.listing([f"{n} {verb}{v}" for v, n in distinct.most_common()])
    )


def value_of(view: View, thing: Thing, attribute: Sequence[str]) -> str | None:
    """An attribute of a thing in words, None when the scene has none."""
    if attribute[-1] in COLOUR_KEYS:
        colour = colour_of(thing)
        return colour if colour or "person" not in thing.concepts else _clothes(thing)
    if _is_clothes(attribute):
        return _clothes(thing)
    wanted = {canonical(w.singular(x)) for x in attribute}
    synonyms = {x for group in _KEY_SYNONYMS.values() if group & set(attribute) for x in group}
    for key, value in thing.attributes.items():
        keys = {canonical(w.singular(x)) for x in key_words(key)}
        if wanted <= keys or keys & synonyms or keys <= wanted:
            return _value(key, value)
    if set(attribute) & _DOING:
        states = fact_words(thing) & {"moving", "stationary", "walking", "working", "upright", "sitting"}
        return min(states, default=None)
    if set(attribute) & _KEY_SYNONYMS["state"]:
        facts = [f for f in sorted(fact_words(thing)) if any(opposite(f, x) for x in _POLAR)]
        return facts[0] if facts else None
    return None


_POLAR = ("open", "closed", "lit", "unlit", "raised", "lowered", "empty", "full", "moving", "stationary")


def _value(key: str, value: object) -> str:
    if isinstance(value, bool):
        return " ".join(key_words(key)) if value else f"not {' '.join(key_words(key))}"
    return str(value)


def _is_clothes(attribute: Sequence[str]) -> bool:
    return attribute[-1] in {"wearing", "clothes", "clothing", "outfit"}


def _clothes(thing: Thing) -> str | None:
    """What a person wears: "an orange vest and a white helmet"."""
    worn: list[str] = []
    for key, value in thing.attributes.items():
        if key in {"wearing", "clothing", "clothes", "outfit", "ppe"}:
            worn += [str(value)]
        elif is_worn(key):
            item = " ".join(x for x in key_words(key) if x not in COLOUR_KEYS)
            lacking = value is False or str(value).lower() in {"none", "no"}
            worn.append(f"no {item}" if lacking else w.article(item) if value is True else w.article(f"{value} {item}"))
    return w.listing(worn) if worn else None


def _of_a_part(view: View, question: s.Ask) -> Reply | None:
    """ "The colour of the worker's helmet", where the helmet is no thing of its own but a fact of the worker."""
    if question.what is None:
        return None
    phrase = question.what.phrases[0]
    owners = [t.other for t in phrase.tests if isinstance(t, s.Relation) and t.kind == "on"]
    if not owners:
        return None
    found = [(t, v) for t in find(view, owners[0]) for v in [_part_value(t, phrase.words)] if v is not None]
    if not found:
        return None
    part = " ".join(phrase.words)
    if len({v for _, v in found}) == 1:
        return reply(f"{the(view, owners[0], many=len(found) > 1)}'s {part} is {found[0][1]}")
    return reply(w.listing([f"the {part} of the {t.category} {place(t)} is {v}" for t, v in found]))


def _part_value(thing: Thing, words: Sequence[str]) -> str | None:
    from scope_ptz.perception.facts import names_of

    wanted = names_of(" ".join(words))
    for key, value in thing.attributes.items():
        part = singular_phrase(" ".join(x for x in key_words(key) if x not in COLOUR_KEYS) or key)
        if part in wanted and isinstance(value, str):
            return value
    return None


def _anywhere(view: View, attribute: Sequence[str]) -> Reply:
    """ "Which lane is closed?", "what is the speed limit?": any thing with such a fact, else a text of such a sign."""
    told = [
        (t, v) for t in view.things for v in [value_of(view, t, attribute)] if v is not None and _says(t, attribute)
    ]
    if told:
        values = list(dict.fromkeys(v for _, v in told))
        return reply(f"the {' '.join(attribute)} is {w.listing(values)}")
    signs = find(view, s.Description((s.Phrase(tuple(attribute)),)))
    return spoken_texts(view, signs) or unknown(f"I cannot tell: nothing in view says the {' '.join(attribute)}")


def _says(thing: Thing, attribute: Sequence[str]) -> bool:
    """Whether a key of the thing speaks of every word asked for."""
    wanted = {canonical(w.singular(x)) for x in attribute}
    return any(
        wanted <= {canonical(w.singular(x)) for x in (*key_words(k), *value_words(v))}
        for k, v in thing.attributes.items()
    )


def anywhere(view: View, attribute: Sequence[str]) -> Reply:
    """Public face of the search over all things."""
    return _anywhere(view, attribute)


__all__ = ["anywhere", "ask", "is_a", "narrowed", "value_of", "yes_no"]
