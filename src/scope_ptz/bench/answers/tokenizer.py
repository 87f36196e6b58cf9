"""Split text into normalised words, without markup and with consistent spelling."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

_SPELLINGS = {
    "color": "colour", "gray": "grey", "center": "centre", "meter": "metre", "tire": "tyre", "curb": "kerb",
    "sidewalk": "pavement", "license": "licence", "story": "storey", "aluminum": "aluminium", "colored": "coloured",
}  # fmt: skip
"""British spellings of American words."""
_UNIT_NAMES = {"°": "degree", "deg": "degree", "%": "percent", "m": "metre", "km": "kilometre", "s": "second", "sec": "second"}
"""Unit names by the signs and abbreviations that may follow a number."""
_IRREGULAR = {
    "people": "person", "men": "man", "women": "woman", "children": "child", "persons": "person",
    "loaves": "loaf", "shelves": "shelf", "leaves": "leaf", "knives": "knife",
}  # fmt: skip
"""Singular forms of irregular plurals."""
_IDIOMS = (
    "without a doubt", "without doubt", "no doubt", "no problem", "of course", "for sure", "not only", "no wonder",
    "needless to say", "as you can see", "not surprisingly", "no question", "no mistake", "even so", "even though",
)  # fmt: skip
"""Phrases that are removed because they contain words that the parser would misread, such as "no" in "no doubt"."""

_CONTRACTIONS = (
    (re.compile(r"\bcan'?t\b|\bcannot\b"), "can not"),
    (re.compile(r"\bwon't\b"), "will not"),
    (re.compile(r"n't\b"), " not"),
    (re.compile(r"\b(it|there|that|he|she|what|here|one|everything|who|let)'s\b"), r"\1 is"),
    (re.compile(r"\b(i|we|you|they)'(m|re|ve|d|ll)\b"), r"\1"),
    (re.compile(r"(?<=\d)\+(?!\s*\d|\w)"), " or more"),
)
"""Patterns of contractions and of "3+", with their replacements."""
_WORD = re.compile(r"\d+(?:,\d{3})+(?:\.\d+)?|\d+(?:\.\d+)?|[^\W\d_]+(?:'[^\W\d_]+)*|[°%]")
_TAGS = re.compile(r"</?(?:b|i|u|em|strong|p|br|code|answer)\s*/?>", re.IGNORECASE)
_LIST_NUMBER = re.compile(r"^\s*(\d{1,3})[.)]\s+", re.MULTILINE)
"""The number of a list item at the beginning of a line."""
_CLAUSE_END = re.compile(r"[!?;\n]|\.(?!\d)|\s[—–-]\s|—")


@dataclass(frozen=True, slots=True)
class Word:
    """A word in a text.

    Attributes:
        text: The word in lower case and British spelling.
        gap: The characters between the previous word and this one.
        clause: Index of its clause. A clause ends at a full stop, a dash, a semicolon or a new line.
        segment: Index of its segment. A segment also ends at a comma or a colon, and before words such as "but".
    """

    text: str
    gap: str
    clause: int
    segment: int


def clean(text: str) -> str:
    """Remove markup from text, and normalise quotation marks, dashes and spaces. Case is preserved.

    Notes about the source, such as "(seen by ...)", are also removed.
    """
    text = unicodedata.normalize("NFKC", "".join(_plain_letter(letter) for letter in text))
    text = re.sub(r"\s*\((?:source:|seen by)[^)]*\)", "", text, flags=re.IGNORECASE)
    text = re.sub(r"[‘’´`]", "'", re.sub(r"[“”„«»]", '"', text)).replace("−", "-")
    text = re.sub(r"\*\*|__|^#+\s*|^>\s+(?![\s\d])|(?<!\w)\*(?=\w)|(?<=\w)\*(?!\w)", "", text, flags=re.MULTILINE)
    text = re.sub(_TAGS, "", text)
    text = re.sub(r"^\s*[-*•]\s+", "", text, flags=re.MULTILINE)
    numbers = [int(number) for number in _LIST_NUMBER.findall(text)]
    is_list = len(numbers) > 1 and numbers == list(range(1, len(numbers) + 1))
    return (_LIST_NUMBER.sub("", text) if is_list else text).strip()


def _plain_letter(letter: str) -> str:
    """Return the plain form of a character.

    Digits in any script become 0 to 9. Superscripts are preceded by "^" and fractions by a space, so that they do not join the
    digits before them.
    """
    kind = unicodedata.category(letter)
    if kind == "Cf":
        return ""
    if kind == "Nd":
        return str(unicodedata.decimal(letter))
    if kind == "No" and "⁄" in unicodedata.normalize("NFKC", letter):
        return f" {letter}"
    return f"^{letter}" if kind == "No" and unicodedata.decomposition(letter).startswith("<su") else letter


def plain_words(text: str) -> list[str]:
    """Return the normalised words of a text."""
    return list(_plain_words(text))


@lru_cache(maxsize=4096)
def _plain_words(text: str) -> tuple[str, ...]:
    return tuple(w.text for w in words_of(clean(text)))


def _british_spelling(word: str) -> str:
    if word.endswith("s") and word[:-1] in _SPELLINGS:
        return _SPELLINGS[word[:-1]] + "s"
    return _SPELLINGS.get(word, word)


def words_of(text: str) -> list[Word]:
    """Return the words of a cleaned text in order, with their clauses and segments."""
    lowered = text.lower()
    for pattern, plain in _CONTRACTIONS:
        lowered = pattern.sub(plain, lowered)
    for idiom in _IDIOMS:
        if idiom in lowered:
            lowered = re.sub(rf"\b{idiom}\b", " ", lowered)
    words, end, clause, segment = list[Word](), 0, 0, 0
    for match in _WORD.finditer(lowered):
        gap, word = lowered[end : match.start()], match.group()
        if words and words[-1].text[0].isdigit() and not gap.strip():
            word = _UNIT_NAMES.get(word, word)
        end = match.end()
        if words and _CLAUSE_END.search(gap):
            clause += 1
        if words and (_CLAUSE_END.search(gap) or re.search(r"[,:]", gap) or word in ("but", "whereas", "while", "although", "so")):
            segment += 1
        words.append(Word(_british_spelling(word), gap, clause, segment))
    return words


def names_any(text: str, wordings: Iterable[str]) -> bool:
    """Return whether a text contains one of the wordings, even in a denial."""
    words = plain_words(text)
    for phrase in (plain_words(w) for w in wordings):
        for at in range(len(words) - len(phrase) + 1):
            if all(same_word(words[at + i], p) for i, p in enumerate(phrase)):
                return True
    return False


@lru_cache(maxsize=4096)
def _singular_forms(word: str) -> frozenset[str]:
    forms = {word, _IRREGULAR.get(word, word)}
    if len(word) > 3 and word.endswith("s") and not word.endswith("ss"):
        forms.add(word[:-1])
        if word.endswith("es"):
            forms.add(word[:-2])
        if word.endswith("ies"):
            forms.add(word[:-3] + "y")
    return frozenset(forms)


def same_word(one: str, other: str) -> bool:
    """Return whether two words are equal, ignoring the difference between singular and plural."""
    return one == other or one in _singular_forms(other) or other in _singular_forms(one)


def all_wordings(name: str, other_wordings: Iterable[str]) -> tuple[str, ...]:
    """Return the name of an option followed by its other wordings."""
    return name, *other_wordings
