"""Find the words in a request that ground truth cannot interpret: unknown nouns, and qualities that no scene states."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

from scope_ptz import english
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import nouns_in
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.questions import question_tree as tree
from scope_ptz.perception.ground_truth.view import View
from scope_ptz.perception.ground_truth.vocabulary import FILLER_WORDS, IGNORABLE_WORDS

_PRONOUNS = frozenset({("it",), ("them",)})
"""Pronouns that cannot refer to anything, because no sentence precedes a question about a picture."""

_ONE = frozenset({"one", "ones"})


def has_unresolved_item(node: Any) -> bool:
    """Return whether a question asks for an item that only an earlier sentence names: "who is not wearing one?"."""
    if isinstance(node, tuple):
        return any(map(has_unresolved_item, node))
    if not is_dataclass(node):
        return False
    if isinstance(node, tree.Has) and any(set(p.words) <= _ONE for p in node.what.phrases):
        return True
    return any(has_unresolved_item(getattr(node, field.name)) for field in fields(node))


_JUDGEMENT = re.compile(
    r"\b(?:everything|everyone|everybody|all|it|things|they)\s+(?:still\s+)?(?:ok|okay|alright|all right|fine|in order|normal"
    r"|under control)\W*$",
    re.IGNORECASE,
)
_OPINIONS = frozenset(
    {"wrong", "odd", "fancy", "amiss", "suspect", "weird", "nice", "interesting", "lost", "missing", "drunk", "hurt"}
)
"""Words for qualities that no scene states. Words that can only be adjectives need not be listed."""


def asks_for_judgement(question: str) -> bool:
    """Return whether a question asks if all is well, which no ground truth states: "is everyone ok?"."""
    return _JUDGEMENT.search(question) is not None


def find_unknown_nouns(view: View, parsed: tree.Description | tree.Question) -> list[str]:
    """Return the noun phrases that contain no noun from the lexicon, the scene or common English.

    Args:
        view: The view, whose scene adds its own nouns and the words of its facts.
        parsed: The parsed description or question.

    Returns:
        The words of each phrase, in order.
    """
    known = _known_words(view)
    return [
        " ".join(phrase.words)
        for phrase in _phrases(parsed)
        if phrase.words in _PRONOUNS
        or (
            not nouns_in(phrase.words, view.nouns)
            and not is_common_noun(" ".join(phrase.words))
            and not any(word in known or english.cardinal(word) is not None for word in phrase.words)
        )
    ]


def find_unknown_qualities(view: View, parsed: tree.Description | tree.Question) -> list[str]:
    """Return the adjectives about which the scene says nothing: "dangerous" in "anything dangerous".

    Words that can also be nouns or verbs ("police car", "open gate") are not returned, unless they express an opinion.
    """
    known = _known_words(view)
    found: list[str] = []
    for phrase in _phrases(parsed):
        spans = nouns_in(phrase.words, view.nouns)
        in_nouns = {i for start, end in spans for i in range(start, end)}
        others = [word for i, word in enumerate(phrase.words) if i not in in_nouns and word not in known]
        found += [word for word in others if spans and _is_unstated_quality(word)]
    return found


def _known_words(view: View) -> frozenset[str]:
    """Return the words that count as known: colours, words without a meaning of their own, and those of the scene's facts."""
    stated = frozenset[str]().union(*view.values.values())
    return english.COLOURS | FILLER_WORDS | IGNORABLE_WORDS | stated


def is_english_noun(phrase: str) -> bool:
    """Return whether the last word of a phrase is a noun in the dictionary, even if no scene uses it: "square"."""
    return "NOUN" in parts_of_speech(phrase.split()[-1])


def _is_unstated_quality(word: str) -> bool:
    tags = parts_of_speech(word)
    return word in _OPINIONS or ("ADJ" in tags and not tags & {"NOUN", "VERB", "ADV", "PROPN"})


def _phrases(node: Any) -> Iterator[tree.Phrase]:
    """Yield the noun phrases in a description or question, including those in its tests. Text on signs is excluded."""
    if isinstance(node, tuple):
        for item in node:
            yield from _phrases(item)
    elif is_dataclass(node) and not isinstance(node, tree.Says | tree.Is):
        if isinstance(node, tree.Phrase):
            yield node
        for field in fields(node):
            yield from _phrases(getattr(node, field.name))
