"""Find where an answer names one of several options, by its full name or by an unambiguous short form."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

from scope_ptz.bench.answers.text import AnswerText, NameMention
from scope_ptz.bench.answers.tokenizer import all_wordings, plain_words, same_word

_CONNECTING_WORDS = frozenset({"with", "in", "of", "on", "at", "from", "who", "carrying", "and"})
"""Words before which the core of a name ends. The core of "man with a hat" is "man"."""
_ALLOWED_BEFORE = frozenset({
    "the", "a", "an", "then", "is", "are", "and", "or", "than", "more", "most", "fewer", "fewest", "order", "so", "therefore",
    "thus", "answer", "finally", "first", "last", "second", "third", "next", "lastly", "nearest", "closest", "farthest",
    "furthest", "largest", "biggest", "smallest", "leftmost", "rightmost",
})  # fmt: skip
"""Words that may precede a short form."""
_ALLOWED_AFTER = frozenset({
    "is", "are", "was", "were", "has", "have", "and", "or", "then", "than", "comes", "come", "appears", "appear", "seems", "looks",
    "stands", "takes", "being", "followed", "because", "since", "as", "while", "next", "last", "first", "second", "third", "by",
    "to",
})  # fmt: skip
"""Words that may follow a short form. Before any other word, the short form is part of another name ("bus stop")."""


def option_mentions(text: AnswerText, options: Mapping[str, Sequence[str]]) -> list[NameMention]:
    """Return the mentions of options. "The bus" refers to the red double-decker bus if no other option is a bus."""
    full_names = {name: all_wordings(name, other_wordings) for name, other_wordings in options.items()}
    short = _unambiguous_short_forms(full_names)
    mentions = text.mentions({name: (*wordings, *short[name]) for name, wordings in full_names.items()})
    return [m for m in mentions if _is_full_name(text, m, full_names[m.name]) or _stands_alone(text, m)]


def _is_full_name(text: AnswerText, mention: NameMention, wordings: Sequence[str]) -> bool:
    named = [w.text for w in text.words[mention.start : mention.end]]
    return any(len(words) == len(named) and _same_words(words, named) for words in map(plain_words, wordings))


def _same_words(words: Sequence[str], named: Sequence[str]) -> bool:
    articles = ({"a", "the"}, {"an", "the"}, {"a", "an"})
    return all(same_word(one, other) or {one, other} in articles for one, other in zip(words, named, strict=True))


def _stands_alone(text: AnswerText, mention: NameMention) -> bool:
    """Return whether a short form stands alone and is not part of another name."""
    words = text.words
    before = words[mention.start - 1 : mention.start] if mention.start else ()
    is_plural = words[mention.end - 1].text.endswith("s")
    valid_before = (
        not before
        or bool(words[mention.start].gap.strip())
        or before[0].text in _ALLOWED_BEFORE
        or (is_plural and before[0].text.isdigit())
    )
    after = words[mention.end : mention.end + 1]
    valid_after = not after or bool(after[0].gap.strip()) or after[0].text in _ALLOWED_AFTER
    if not valid_after:
        valid_after = " ".join(w.text for w in words[mention.end : mention.end + 3]) in _PLACE_PHRASES
    return valid_before and valid_after


_PLACE_PHRASES = frozenset({"in the middle", "on the left", "on the right", "in the centre", "in between them"})
"""Phrases that may follow a short form because they only state the position of the thing."""


def _unambiguous_short_forms(full_names: Mapping[str, Sequence[str]]) -> dict[str, tuple[str, ...]]:
    """Return, for each option, its short forms that match no other option.

    A short form is the noun with some of the words before it, or the proper name at the beginning of the option's name.
    """
    short_forms = dict[str, tuple[str, ...]]()
    for name in full_names:
        others = [plain_words(wording) for other, wordings in full_names.items() if other != name for wording in wordings]
        short_forms[name] = tuple(
            " ".join(words) for words in _short_forms(name) if not any(_contains_in_order(words, other) for other in others)
        )
    return short_forms


def _short_forms(name: str) -> list[tuple[str, ...]]:
    """Return the possible short forms of a name."""
    words = plain_words(name)
    connections = [at for at, word in enumerate(words) if word in _CONNECTING_WORDS]
    core = words[: connections[0]] if connections else words
    if not core or len(core) > 5:
        return []
    nouns = [(*before, core[-1]) for size in range(len(core)) for before in combinations(core[:-1], size)]
    capitals = [word for word in name.split() if word[0].isupper()]
    proper = plain_words(" ".join(capitals)) if name.startswith(" ".join(capitals)) and len(capitals) < len(name.split()) else []
    shorter = [*nouns, *([tuple(proper)] if proper and len(proper) < len(words) else [])]
    return [s for s in shorter if list(s) != words and any(len(word) > 2 for word in s)]


def _contains_in_order(words: Sequence[str], other: Sequence[str]) -> bool:
    """Return whether a name contains the words in the same order, possibly with other words between them."""
    at = 0
    for word in other:
        if at < len(words) and same_word(word, words[at]):
            at += 1
    return at == len(words)
