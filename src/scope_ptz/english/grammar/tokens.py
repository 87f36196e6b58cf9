"""Split text into tokens: words, numbers, units and punctuation, with contractions resolved."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

_TOKEN = re.compile(
    r"""
    (?<![\w./])\d+/\d+(?![\w/])                      # 1/2
  | (?<![\w.)])[-+−](?=\.?\d)(?:\d+(?:\.\d+)?|\.\d+) # -10, +5
  | \d{1,3}(?:,\d{3})+(?!\d) | \d+(?:\.\d+)? | \.\d+ # 1,000  20  2.5  .5
  | [^\W\d_]+(?:\.[^\W\d_]+)*(?=\b|\d|_)             # words
  | ->|→|=>|\.\.\.|…
  | ['’]\w+
  | [^\s\w]
  | \n
    """,
    re.VERBOSE,
)
_CONTRACTIONS = {
    "n't": ("not",), "'re": ("are",), "'ll": ("will",), "'ve": ("have",), "'m": ("am",), "'d": ("would",),
}  # fmt: skip
_FUSED_WORDS = {
    "dont": ("do", "not"), "cant": ("can", "not"), "cannot": ("can", "not"), "wont": ("will", "not"), "isnt": ("is", "not"),
    "arent": ("are", "not"), "doesnt": ("does", "not"), "didnt": ("did", "not"), "whats": ("what", "is"),
    "wheres": ("where", "is"), "whos": ("who", "is"), "theres": ("there", "is"), "thats": ("that", "is"), "im": ("i", "am"),
    "ive": ("i", "have"), "lets": ("let", "us"), "gimme": ("give", "me"), "lemme": ("let", "me"), "wanna": ("want", "to"),
    "gonna": ("going", "to"), "goto": ("go", "to"), "youre": ("you", "are"), "howmany": ("how", "many"),
    "couldnt": ("could", "not"), "shouldnt": ("should", "not"), "wasnt": ("was", "not"), "hasnt": ("has", "not"),
    "havent": ("have", "not"),
    "wouldnt": ("would", "not"), "werent": ("were", "not"), "mustnt": ("must", "not"), "aint": ("is", "not"),
}  # fmt: skip
_AFTER_ID = re.compile(r" (?:like|love|prefer|appreciate|be|rather|say)\b")
"""The words after "id" that show that it stands for "I'd"."""

_BEFORE_IS = frozenset({
    "what", "who", "where", "there", "it", "that", "how", "here", "he", "she", "when", "why", "which", "everyone", "everybody",
    "anyone", "anybody", "someone", "somebody", "nobody", "everything", "something", "one", "nothing",
})  # fmt: skip
"""Words after which "'s" is a verb; after other words it is a possessive."""

_NEGATABLE = frozenset({
    "do", "does", "did", "is", "are", "was", "were", "has", "have", "had", "can", "could", "would", "should", "will", "must",
    "might", "need",
})  # fmt: skip
"""Verbs that "n't" can follow."""


@dataclass(frozen=True, slots=True)
class Token:
    """A word, number or punctuation mark.

    Attributes:
        text: The word in lower case, or the mark. Contracted words are written in full.
        start: The index of its first character in the text.
        end: The index after its last character.
    """

    text: str
    start: int
    end: int


def tokenise(text: str) -> list[Token]:
    """Return the tokens of a text. A token's ``text`` may differ from the characters at its position."""
    plain = "".join(c.lower() if len(c.lower()) == 1 else c for c in text).replace("’", "'")
    tokens: list[Token] = []
    for match in _TOKEN.finditer(plain):
        word = unicodedata.normalize("NFKC", match.group()).replace("−", "-")
        if word == "id" and _AFTER_ID.match(plain, match.end()):
            tokens += [Token(part, match.start(), match.end()) for part in ("i", "would")]
        else:
            _add(tokens, word, match.start(), match.end())
    return tokens


def token_texts(text: str) -> tuple[str, ...]:
    """Return the texts of the tokens of a text. It is faster than ``tokenise`` for lower-case words that are not contractions."""
    words = text.split(" ")
    is_plain = text.isascii() and text.islower() and all(word.isalpha() for word in words)
    if is_plain and not any(word in _CONTRACTIONS or word in _FUSED_WORDS or word == "id" for word in words):
        return tuple(words)
    return tuple(token.text for token in tokenise(text))


def _add(tokens: list[Token], word: str, start: int, end: int) -> None:
    """Append the tokens of a word. A contraction gives several tokens."""
    before = tokens[-1] if tokens and tokens[-1].end == start else None
    if word == "'t" and before and before.text.endswith("n"):  # don't, can't, won't
        verb = {"wo": "will", "ca": "can", "ai": "is"}.get(before.text[:-1], before.text[:-1])
        if before.text == "can":
            verb = "can"
        if verb in _NEGATABLE:
            tokens[-1:] = [Token(verb, before.start, before.end), Token("not", start, end)]
            return
    if word == "'s" and before:
        word = "us" if before.text == "let" else "is" if before.text in _BEFORE_IS else "'s"
    if word in _CONTRACTIONS:
        tokens += [Token(part, start, end) for part in _CONTRACTIONS[word]]
    elif word in _FUSED_WORDS:
        tokens += [Token(part, start, end) for part in _FUSED_WORDS[word]]
    elif word.startswith("'") and len(word) > 1 and word != "'s":  # an opening quotation mark
        tokens += [Token("'", start, start + 1), Token(word[1:], start + 1, end)]
    elif word.startswith("-") and len(word) > 1 and before and before.text.isalnum() and word[1:].isdigit():  # "10-15"
        tokens += [Token("-", start, start + 1), Token(word[1:], start + 1, end)]
    else:
        tokens.append(Token(word.replace(",", "") if word[0].isdigit() else word, start, end))
