"""Answers about prices and times, which are stated only in text. Only legible text is reported."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from scope_ptz import english
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.answers.restating import phrase_as_asked
from scope_ptz.perception.ground_truth.answers.text_blocks import blocks_of
from scope_ptz.perception.ground_truth.answers.thing_names import TruthAnswer, known_answer, unknown_answer
from scope_ptz.perception.ground_truth.answers.unread_texts import illegibility, is_only_too_small
from scope_ptz.perception.ground_truth.thing_search import find, split_after_noun
from scope_ptz.perception.ground_truth.view import View
from scope_ptz.perception.ground_truth.vocabulary import FILLER_WORDS
from scope_ptz.simulator.truth import TextSighting

_PRICE = re.compile(r"(?<![\d.:])\d+\.\d\d(?![\d.])")
_TIME = re.compile(
    r"\b\d{1,2}[:.]\d\d\b|\b\d{1,2}(?:[:.]\d\d)? ?[ap]\.?m\b|\b(?:noon|midnight|24 hours|day and night)\b"
    r"|\b(?:mon|tues|wednes|thurs|fri|satur|sun)day\b"
    r"|\b(?:january|february|march|april|may|june|july|august|september|october|november|december) \d{1,4}\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class _ThingTexts:
    """The texts on one thing, such as a price card."""

    name: str
    texts: tuple[TextSighting, ...]

    @property
    def legible(self) -> list[str]:
        """The legible texts."""
        return list(dict.fromkeys(t.text.text for t in self.texts if t.legible))

    @property
    def rows(self) -> list[str]:
        """The rows of the legible texts, from top to bottom."""
        legible = [t for t in self.texts if t.legible]
        return [" ".join(row) for block in blocks_of(legible) for row in block.rows] if legible else []

    @property
    def legible_words(self) -> frozenset[str]:
        """The words of the legible texts, in the singular."""
        return _words(" ".join(self.legible))

    @property
    def words(self) -> frozenset[str]:
        """The words of the name and of the legible texts, in the singular."""
        return _words(self.name) | self.legible_words


def answer_stated_fact(view: View, question: tree.Price | tree.Time) -> TruthAnswer:
    """Answer what something costs, or when it opens, closes or happens."""
    return answer_price(view, question) if isinstance(question, tree.Price) else answer_time(view, question)


def answer_price(view: View, question: tree.Price) -> TruthAnswer:
    """Answer what something costs: with the price on its card, or in its line of a price list."""
    goods = [_content_words(phrase.words) for phrase in question.what.phrases]
    named = phrase_as_asked(view, tree.Description(tuple(replace(p, tests=()) for p in question.what.phrases)))
    matches = find(view.with_cut_off_texts(), question.what)
    belonging = _texts_by_thing(view, lambda parent: any(view.belongs(parent, t.id) for t in matches))
    has_tests = any(phrase.tests for phrase in question.what.phrases)
    candidates = belonging if has_tests and belonging else _texts_by_thing(view)
    # A card or line that names the goods takes precedence over other texts on the same stall or crate.
    groups = [p for p in candidates if any(words <= p.words for words in goods)]
    prices = list(dict.fromkeys(price for group in groups for price in _prices_on(group, goods)))
    if not prices and not any(words <= _words(p.name) for p in groups for words in goods):
        groups = belonging
        prices = list(dict.fromkeys(price for group in groups for price in _prices_on(group, goods)))
    if len({price for _, price in prices}) == 1:
        return known_answer(f"the price of {named} is {prices[0][1]}")
    if prices:
        labels = {label for label, _ in prices}
        listed = [f"{price} for {label}" if len(labels) > 1 and label else price for label, price in prices]
        return known_answer(f"there are {len(prices)} prices for {named}: {english.listing(listed)}")
    if not groups and (price_list := _illegible_price_list(candidates)) is not None:
        return unknown_answer(f"the price of {named} may be on the {price_list}, but it is too small to read")
    return _illegible_answer(groups, f"the price of {named}") or unknown_answer(
        f"I cannot tell: nothing that I can read in view states the price of {named}"
    )


def _illegible_price_list(groups: Sequence[_ThingTexts]) -> str | None:
    """Return the name of the largest list of prices of which the text is only too small; None if there is none."""
    lists = [
        (max(t.cap_height_px for t in group.texts), group.name)
        for group in groups
        if _words(group.name) & _PRICE_LISTS and all(is_only_too_small(t) for t in group.texts)
    ]
    return max(lists)[1] if lists else None


_PRICE_LISTS = frozenset({"menu", "tariff"})
"""Words in the names of things that list the prices of several goods. A price card has the price of one."""


def _prices_on(group: _ThingTexts, goods: Sequence[frozenset[str]]) -> list[tuple[str, str]]:
    """Return the labels and prices for goods in the texts on one thing. Lines of a price list count only if they name the goods."""
    lines = [(line, prices[0]) for line in group.legible if (prices := _PRICE.findall(line))]
    label = " ".join(line.lower() for line in group.legible if not _PRICE.search(line))
    if len(lines) == 1 and lines[0][0].strip() == lines[0][1]:
        return [(label, lines[0][1])]
    entries = [(line, price) for line, price in lines if any(words <= _words(line) for words in goods)]
    if not entries:
        entries = [(text, price) for text, price in _labelled_prices(group.rows) if any(words <= _words(text) for words in goods)]
    return [("", price) for _, price in entries]


def _labelled_prices(rows: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield the text and the price of each entry of a price list.

    A price in a row without goods belongs to the row above, if that is the only row since the last price: of several rows, the
    first may be a heading. A list that begins with such a price has its prices above the goods, or is cut off, so it has no
    entries.
    """
    if rows and _is_bare_price(rows[0]):
        return
    pending: list[str] = []
    for row in rows:
        prices = _PRICE.findall(row)
        if not prices:
            pending.append(row)
            continue
        if not _is_bare_price(row):
            yield row, prices[0]
        elif len(pending) == 1:
            yield f"{pending[0]} {row}", prices[0]
        pending = []


def _is_bare_price(row: str) -> bool:
    """Return whether a row has a price and no goods: "1.80 a kilo"."""
    return bool(_PRICE.search(row)) and set(re.findall(r"[a-z]+", row.lower())) <= _UNITS


_UNITS = frozenset(
    {"a", "per", "each", "the", "for", "kilo", "kg", "g", "lb", "pound", "litre", "bunch", "bag", "box", "punnet", "piece"}
)
"""Words beside a price that say for how much of the goods it is."""


def answer_time(view: View, question: tree.Time) -> TruthAnswer:
    """Answer when something opens, closes or happens: with text that states a time and is on the thing or names it."""
    heads = tree.Description(tuple(replace(p, words=split_after_noun(view, p.words)[0]) for p in question.what.phrases))
    matches = [t for what in (question.what, heads) for t in find(view.with_cut_off_texts(), what)]
    belonging = _texts_by_thing(view, lambda parent: any(view.belongs(parent, t.id) for t in matches))
    named = [
        group
        for what in (question.what, heads)
        for group in _texts_by_thing(view)
        if any(_content_words(phrase.words) <= group.legible_words for phrase in what.phrases)
    ]
    for group in (*belonging, *named):
        if any(_TIME.search(text) for text in group.legible):
            quoted = [f'"{text}"' for text in group.legible]
            return known_answer(f"the {group.name} reads {english.listing(quoted)}")
    subject = phrase_as_asked(view, heads)
    return _illegible_answer(belonging, f"the text about {subject}") or unknown_answer(
        f"I cannot tell: nothing that I can read in view states a time for {subject}"
    )


def _illegible_answer(groups: Sequence[_ThingTexts], what: str) -> TruthAnswer | None:
    """Return the answer that the text is on a certain thing, but cannot be read; None if all texts are legible."""
    group = next((p for p in groups if not all(t.legible for t in p.texts)), None)
    if group is None:
        return None
    reason = illegibility([t for t in group.texts if not t.legible])
    return unknown_answer(f"{what} is on the {group.name}, but {reason} to read")


def _texts_by_thing(view: View, includes: Callable[[str], bool] = lambda _: True) -> list[_ThingTexts]:
    """Return the texts in view, grouped by the thing that they are on. ``includes`` selects things by id."""
    parents = dict.fromkeys(t.text.parent for t in view.texts if includes(t.text.parent))
    return [_ThingTexts(view.instances[parent].name, tuple(t for t in view.texts if t.text.parent == parent)) for parent in parents]


def _content_words(words: Iterable[str]) -> frozenset[str]:
    return frozenset(english.singular(x) for x in words if x not in FILLER_WORDS)


def _words(text: str) -> frozenset[str]:
    return frozenset(english.singular(x) for x in english.letters(text).split())
