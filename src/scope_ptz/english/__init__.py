"""English number words, noun forms, colour words, lists and sentences.

The package contains only data and pure functions. It is independent of cameras, pictures and tasks.
"""

from scope_ptz.english.colours import COLOURS
from scope_ptz.english.nouns import article, counted, is_plural, plural, singular
from scope_ptz.english.numerals import cardinal, number_word, ordinal, ordinal_suffix
from scope_ptz.english.text_forms import letters, listing, sentence

__all__ = [
    "COLOURS",
    "article",
    "cardinal",
    "counted",
    "is_plural",
    "letters",
    "listing",
    "number_word",
    "ordinal",
    "ordinal_suffix",
    "plural",
    "sentence",
    "singular",
]
