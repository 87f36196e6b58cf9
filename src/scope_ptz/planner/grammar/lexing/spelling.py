"""Correct typing errors in the words of the planner's vocabulary."""

from __future__ import annotations

import re
from functools import lru_cache

from scope_ptz.english import singular
from scope_ptz.english.grammar.common_nouns import is_common_noun
from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.numbers import NUMBER_WORDS
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech, verb_form
from scope_ptz.english.nouns import plural_noun
from scope_ptz.english.numerals import FRACTIONS
from scope_ptz.planner.grammar.lexing.lexicon import known_words, spelling_lists

_MIN_CHARS = 5  # in shorter words, only exchanged, doubled and missing letters count as typing errors
_MIN_SHORT_CHARS = 3
_MIN_VOWEL_CHARS = 7  # in shorter words, another vowel often makes another word
_VOWELS = frozenset("aeiou")
_STRETCHED = re.compile(r"([a-z])\1{2,}")
"""A letter that is written three times or more, which no English word has."""

_MIN_NOUN_CHARS = 6  # shorter words that nobody knows may be names


def within_one_edit(a: str, b: str) -> bool:
    """Return whether two words are equal, or differ by one insertion, deletion, substitution or swap of neighbouring letters."""
    if abs(len(a) - len(b)) > 1 or a == b:
        return a == b
    head = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    rest_a, rest_b = a[head:], b[head:]
    swapped = len(rest_a) >= 2 and rest_a[1:2] + rest_a[:1] + rest_a[2:] == rest_b
    return swapped or rest_a[1:] == rest_b[1:] or rest_a[1:] == rest_b or rest_a == rest_b[1:]


@lru_cache(maxsize=8192)
def corrected_word(word: str) -> str:
    """Return the word of the vocabulary that a misspelt word stands for; any other word unchanged."""
    lists = spelling_lists()
    if word in lists["fixed"]:
        return str(lists["fixed"][word])
    if len(word) < _MIN_SHORT_CHARS or not word.isalpha() or is_english(word):
        return word
    if (whole := with_whole_ending(word)) != word:
        return whole
    if len(swapped := _with_letters_swapped(word)) == 1 and not parts_of_speech(word):
        return swapped[0]
    close = [known for known in lists["short"] if (_is_typing_error if len(word) < _MIN_CHARS else within_one_edit)(word, known)]
    close = close or _likely_words(word)
    close = [known for known in close if known in NUMBER_WORDS] or close  # "tweny" is "twenty", not "teeny"
    return close[0] if len(close) == 1 and not parts_of_speech(word) else word


def with_whole_ending(word: str) -> str:
    """Return "going" for "goin"; any other word unchanged."""
    is_shortened = word.endswith("in") and not (is_english(word) or parts_of_speech(word)) and verb_form(f"{word}g") == "participle"
    return f"{word}g" if is_shortened else word


def without_stretched_letters(word: str) -> str:
    """Return the word that was stretched for emphasis: "in" for "innn", "zoom" for "zooooom". Unknown words are unchanged."""
    single, double = _STRETCHED.sub(r"\1", word), _STRETCHED.sub(r"\1\1", word)
    return next((short for known in (_is_command_word, is_english) for short in (double, single) if known(short)), word)


def _is_command_word(word: str) -> bool:
    return word in known_words()


@lru_cache(maxsize=4096)
def corrected_noun(word: str) -> str:
    """Return the word that a misspelt noun or adjective stands for.

    It is the only noun for a kind of thing that perception knows with a letter more or less, with two letters swapped ("exavator"),
    or with another vowel ("ambulence"), or the only English noun or adjective that results from swapping two adjacent letters or
    doubling one. Known words, and words that could be corrected in more than one way, are returned unchanged.
    """
    if is_english(word) or parts_of_speech(word) or verb_form(word) is not None:
        return word
    if len(word) >= _MIN_NOUN_CHARS - 1:  # a letter of a longer noun may be missing: "peple"
        things = {noun for noun in _nouns_for_things() if noun[0] == word[0] and _differs_by_a_slip(word, noun)}
        if len({singular(noun) for noun in things}) == 1:
            return max(things, key=lambda noun: (noun.endswith("s") == word.endswith("s"), noun))
    swapped = {word[:i] + word[i + 1] + word[i] + word[i + 2 :] for i in range(1, len(word) - 1)}
    doubled = {word[:i] + word[i] + word[i:] for i in range(1, len(word))}
    meant = {other for other in swapped | doubled if parts_of_speech(other) & {"NOUN", "ADJ"}}
    return meant.pop() if len(meant) == 1 else word


def _differs_by_a_slip(word: str, noun: str) -> bool:
    """Return whether a letter is missing, added or swapped, or a vowel is another one: "ambulence".

    With another consonant, it may be another word: "shunter", "shutter".
    """
    if not within_one_edit(word, noun):
        return False
    differing = {pair for pair in zip(word, noun, strict=False) if pair[0] != pair[1]}
    is_wrong_vowel = len(differing) == 1 and all(letter in _VOWELS for pair in differing for letter in pair)
    return len(word) != len(noun) or sorted(word) == sorted(noun) or (len(word) >= _MIN_VOWEL_CHARS and is_wrong_vowel)


@lru_cache(maxsize=1)
def _nouns_for_things() -> frozenset[str]:
    """Return the longer nouns of one word for kinds of things, in the singular and the plural."""
    nouns = [noun for noun in lexicon().concepts if noun.isalpha()]
    longer = {form for noun in nouns if len(noun) >= _MIN_NOUN_CHARS for form in (noun, plural_noun(noun))}
    irregular = {plural_noun(noun) for noun in nouns if plural_noun(noun).removesuffix("es").removesuffix("s") != noun}
    return frozenset({*longer, *(noun for noun in irregular if len(noun) > _MIN_NOUN_CHARS and not noun.endswith("s"))})


def _with_letters_swapped(word: str) -> list[str]:
    """Return the words of the vocabulary that result from swapping two neighbouring letters, which corrects the commonest error."""
    swapped = {word[:i] + word[i + 1] + word[i] + word[i + 2 :] for i in range(len(word) - 1)} - {word}
    return sorted(swapped & known_words())


def _likely_words(word: str) -> list[str]:
    """Return the words of the whole vocabulary that a misspelt longer word may stand for."""
    if len(word) < _MIN_CHARS:
        return []
    return [known for known in known_words() if len(known) >= _MIN_CHARS and word[0] == known[0] and within_one_edit(word, known)]


def _is_typing_error(word: str, known: str) -> bool:
    """Return whether a short word is a typing error: a known word with its letters reordered, or one letter doubled or left out."""
    if len(word) == len(known):
        return sorted(word) == sorted(known) and within_one_edit(word, known)
    if len(word) > len(known):
        return within_one_edit(word, known) and any(word == known[:i] + known[i] + known[i:] for i in range(len(known)))
    return len(known) > _MIN_SHORT_CHARS and word[0] == known[0] and within_one_edit(word, known)


@lru_cache(maxsize=8192)
def is_english(word: str) -> bool:
    """Return whether a word is English, so that it is not treated as a misspelling."""
    is_listed = word in known_words() or word in FRACTIONS or word in spelling_lists()["real"]
    return is_listed or lexicon().concept(word) is not None or is_common_noun(word)
