"""Split a description or question into words. A compound such as "hi-vis" or a quoted text is one word."""

from __future__ import annotations

import re

from scope_ptz.english.grammar.closed_class import misspellings
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.tokens import Token, tokenise

_QUOTED = re.compile(r'["“”][^"“”]*["“”]|(?<![^\W_])[\'‘][^\'‘’]+[\'’](?![^\W_])')
_JOINERS = frozenset("-.'/")
_NO_PERSON = frozenset({"nobody", "no-one", "noone"})


def split(text: str) -> list[str]:
    """Return lower-case words, numbers, commas and quoted strings with their quotes.

    Contractions are expanded, possessives are split into the word and ``'s``, and common misspellings are corrected.
    """
    words: list[str] = []
    start = 0
    for quoted in _QUOTED.finditer(text):
        words += [*_words(text[start : quoted.start()]), f'"{quoted[0][1:-1].lower()}"']
        start = quoted.end()
    return words + _words(text[start:])


def _words(text: str) -> list[str]:
    """Return the words of a text without quoted strings."""
    tokens = tokenise(text)
    words: list[str] = []
    i = 0
    while i < len(tokens):
        if tokens[i].text in {",", ";", "'s"}:
            words.append(tokens[i].text)
        elif _is_word(tokens[i]):
            end = _end_of_compound(text, tokens, i)
            word = "".join(token.text for token in tokens[i:end]).lstrip("+-")
            words += ["no", "person"] if word in _NO_PERSON else [_correct(word)]
            i = end - 1
        i += 1
    return words


def _correct(word: str) -> str:
    """Return the intended word of a common misspelling; other words are returned unchanged."""
    correction = misspellings().get(word, word)
    return correction if correction == word or not parts_of_speech(word) else word  # "the inn" is not "the in"


def _end_of_compound(text: str, tokens: list[Token], start: int) -> int:
    """Return the index after the last token of the compound that begins at ``start``. A contraction is not a compound."""
    end = start + 1
    while end < len(tokens) and tokens[end].start == tokens[end - 1].end:
        joined = end + 1 if _is_word(tokens[end]) else end + 2
        parts = tokens[end - 1 : joined]
        if (
            len(parts) != joined - end + 1
            or not _is_word(parts[-1])
            or (len(parts) == 3 and (parts[1].text not in _JOINERS or parts[1].end != parts[2].start))
            or any(token.text != text[token.start : token.end].lower() for token in parts)
        ):
            break
        end = joined
    return end


def _is_word(token: Token) -> bool:
    return token.text[-1].isalnum() and token.text != "'s"
