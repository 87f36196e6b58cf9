"""English words that several packages share: number words, noun forms, colours, lists and sentences.

Pure data and pure functions at the bottom of the package layers. Nothing here knows about cameras, pictures or tasks.
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
