"""Split a text into lexemes: known phrases, numbers and free text.

A lexeme can match several terminals ("left" is a direction or a verb); the grammar decides between them. Lexemes keep their
position in the original text, so descriptions and questions are passed on as the user typed them.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import takewhile

from scope_ptz.english import COLOURS
from scope_ptz.english.grammar.numbers import NUMBER_WORDS, NumberPhrase, read_number
from scope_ptz.planner.grammar.lexing.phrases import phrase_table
from scope_ptz.planner.grammar.lexing.vocabulary import spelling, word_list

_TOKEN = re.compile(
    r"""(?P<quote>"[^"\n]+"|“[^”\n]+”|(?<!\w)'[^'\n]+'(?!\w))
      |(?P<arrow>->|→|=>)
      |(?P<num>(?<![\w./])\d/\d+(?![\w/])|(?<![\w.])[-+−]?\d+(?:\.\d+)?|(?<=[\d ])\.\d+)
      |(?P<word>[^\W\d_]+(?:['’][^\W\d_]+)*\d*|\d+)
      |(?P<mark>[,;:.!?()\n°%&×])
      |(?P<dash>\s[-–—]+\s|[–—])""",
    re.VERBOSE,
)
_MARKS = {**dict.fromkeys(",:()", "COMMA"), **dict.fromkeys(";.!?\n", "STOP"), "&": "AND"}
SEPARATORS = ("COMMA", "AND", "THEN", "STOP")
_ATTACHED_TO_PREVIOUS = frozenset({"UNTIL", "OTHERWISE", "ATMOST", "EACHTIME"})
"""Terminals that continue a clause, so that a separator before them is dropped."""

_MAX_PHRASE_WORDS = 9
_DIRECTION_LETTERS = {"r": "right", "l": "left", "u": "up", "d": "down"}
_MOTION = frozenset({"TILT", "PAN", "MOVE", "LOOK", "CAMERA"})  # after them, "up to" and "down to" are directions
_NEVER_GERUND = frozenset({*SEPARATORS, "DET", "ONEOF", "PREP", "SAYS", "BY", "SHOWS", "VISIBLE", "FILLS"})
"""Terminals for which a word that ends in "ing" is not the gerund of a command."""

_HEDGES = frozenset({"FILLER", "BY"})  # terminals of words such as "about", which are dropped at the start of a clause
_COLOURS = COLOURS | {"dark", "light"}  # colours join with "and" into one description: "red and white barriers"
_DIAGONALS = ("UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT")


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A phrase, a number, a separator or free words.

    Attributes:
        kinds: The terminals that it can match.
        start: The index of its first character in the original text.
        end: The index after its last character.
        value: The value of a number; 0 for other lexemes.
    """

    kinds: frozenset[str]
    start: int
    end: int
    value: float = 0.0


@dataclass(slots=True)
class _Word:
    text: str
    start: int
    end: int
    kind: str


def _words(text: str) -> list[_Word]:
    """Return the raw tokens. Apostrophes and hyphens separate words ("don't" becomes don, t)."""
    out: list[_Word] = []
    lower_case = "".join(c.lower() if len(c.lower()) == 1 else c for c in text)
    for match in _TOKEN.finditer(lower_case):
        kind, start = match.lastgroup or "", match.start()
        if match.group() in word_list("dropped"):
            continue
        if kind == "word":
            for part in re.finditer(r"[^\W\d_]+|\d+", match.group()):
                word = spelling().get(part.group(), part.group())
                out.append(_Word(word, start + part.start(), start + part.end(), "num" if word.isdigit() else "word"))
        elif kind == "quote":
            out.append(_Word(match.group(), start, match.end(), "quote"))
        elif kind == "mark" and match.group() in "°%×":
            out.append(_Word(match.group(), start, match.end(), "word"))
        else:
            out.append(_Word(match.group(), start, match.end(), kind))
    return _without_list_numbers(_without_step_numbers(out))


def _without_step_numbers(words: list[_Word]) -> list[_Word]:
    """Replace "step 1:" with a sentence end."""
    out, i = list[_Word](), 0
    while i < len(words):
        if words[i].text == "step" and [w.kind for w in words[i + 1 : i + 3]] == ["num", "mark"]:
            out.append(_Word(";", words[i].start, words[i].end, "mark"))
            i += 3
        else:
            out.append(words[i])
            i += 1
    return out


def _without_list_numbers(words: list[_Word]) -> list[_Word]:
    """Replace the "1." or "2)" of a numbered list with sentence ends. The numbers must count up from one."""
    expected, out = 1, list[_Word]()
    for i, word in enumerate(words):
        after = words[i + 1].text if i + 1 < len(words) else ""
        starts = i == 0 or words[i - 1].text in {"\n", ".", ";", ",", ":", "(", ")"} or expected > 1
        if word.text in (str(expected), chr(96 + expected)) and starts and after in {".", ")"} and i + 2 < len(words):
            expected += 1
            out.append(_Word(";", word.start, word.end, "mark"))
        else:
            out.append(word)
    return out if expected > 2 else words


def within_one_edit(a: str, b: str) -> bool:
    """Return whether two words are equal, or differ by one insertion, deletion, substitution or swap of neighbouring letters."""
    if abs(len(a) - len(b)) > 1 or a == b:
        return a == b
    head = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    rest_a, rest_b = a[head:], b[head:]
    swapped = len(rest_a) >= 2 and rest_a[1:2] + rest_a[:1] + rest_a[2:] == rest_b
    return swapped or rest_a[1:] == rest_b[1:] or rest_a[1:] == rest_b or rest_a == rest_b[1:]


def _corrected(word: str, candidates: Iterable[str]) -> str | None:
    """Return the only candidate within one edit of an unknown word; None if there is none or more than one."""
    if len(word) < 3 or word in word_list("real words") or (word,) in phrase_table():
        return None
    close = [c for c in candidates if len(c) >= 3 and within_one_edit(word, c)]
    return close[0] if len(close) == 1 else None


class Lexer:
    """A lexer that splits texts into lexemes. Each preset name is one lexeme."""

    def __init__(self, presets: tuple[str, ...] = ()) -> None:
        self._table = phrase_table()
        self._presets = {key: name for name in presets if (key := preset_key(name)) and key not in self._table}

    def lexemes(self, text: str) -> list[Lexeme]:
        """Return the lexemes of a text, in order."""
        words, out, i = _words(text), list[Lexeme](), 0
        while i < len(words):
            lexeme, i = self._next(words, i, out)
            if lexeme:
                _append(out, lexeme)
        while out and out[-1].kinds & {*SEPARATORS}:
            out.pop()
        return _merge_text(out, text)

    def _next(self, words: list[_Word], i: int, before: list[Lexeme]) -> tuple[Lexeme | None, int]:
        """Return the lexeme that begins at word ``i`` (None for words without meaning) and the index of the next word."""
        word = words[i]
        if word.kind in {"mark", "arrow", "dash"}:
            kind = _MARKS.get(word.text) or ("THEN" if word.kind == "arrow" else "COMMA")
            return Lexeme(frozenset({kind}), word.start, word.end), i + 1
        if word.kind == "quote":
            return Lexeme(frozenset({"TEXT"}), word.start, word.end), i + 1
        sequence = [w.text for w in takewhile(lambda w: w.kind in {"word", "num"}, words[i : i + _MAX_PHRASE_WORDS])]
        preset = self._preset_length(sequence)
        phrase = self._phrase_length(sequence, before)
        number = read_number(sequence, [(w.start, w.end) for w in words[i : i + len(sequence)]])
        if preset >= max(phrase, number.used, 1):
            return Lexeme(frozenset({"PRESETNAME"}), word.start, words[i + preset - 1].end), i + preset
        if number.used and number.used >= phrase:
            return self._number(words, i, number, sequence[:phrase], before), i + number.used
        if phrase:
            return self._phrase(words, i, phrase, before), i + phrase
        return self._unknown(words, i, before), i + 1

    def _preset_length(self, sequence: list[str]) -> int:
        """Return the number of words at the start of a sequence that are the name of a preset."""
        return self._longest([(preset_key(w) or (w,))[0] for w in sequence], self._presets) if self._presets else 0

    def _phrase_length(self, sequence: list[str], before: list[Lexeme]) -> int:
        """Return the number of words at the start of a sequence that form a known phrase.

        In some contexts only the first word counts, because the words of the phrase have separate meanings.
        """
        phrase = self._longest(sequence, self._table.starting_with(sequence[0]) if sequence else {})
        if phrase < 2:
            return phrase
        kinds = self._table[tuple(sequence[:phrase])]
        previous = before[-1].kinds if before else frozenset[str]()
        read_separately = False
        if sequence[0] == "the":  # "the overview" if a preset has that name
            read_separately = bool(self._presets) and self._preset_length(sequence[1:]) >= phrase - 1
        elif sequence[0] in {"up", "down"}:  # "tilt up to 10" is a direction, not a limit
            read_separately = bool(previous & _MOTION) and not kinds & {"UP", "DOWN", *_DIAGONALS}
        elif sequence[:2] == ["if", "you"]:  # "if you can see" begins a condition; "if you can" at the end is a filler
            read_separately = "FILLER" in kinds and phrase < len(sequence)
        elif sequence[0] == "or":
            read_separately = bool(kinds & {"ORMORE", "ORFEWER"}) and "NUM" not in previous
        return 1 if read_separately else phrase

    def _number(self, words: list[_Word], i: int, number: NumberPhrase, phrase: list[str], before: list[Lexeme]) -> Lexeme | None:
        """Return the lexeme of a number; None if it only numbers a sentence ("first, ...")."""
        used = words[i : i + number.used]
        if _starts_clause(before) and "FILLER" in self._table.get(tuple(w.text for w in used)):
            return None
        kinds = number.kinds | (self._table[tuple(phrase)] if len(phrase) == number.used else frozenset())
        return Lexeme(frozenset(kinds), used[0].start, used[-1].end, number.value)

    def _phrase(self, words: list[_Word], i: int, length: int, before: list[Lexeme]) -> Lexeme | None:
        kinds = self._table[tuple(w.text for w in words[i : i + length])]
        start, end = words[i].start, words[i + length - 1].end
        is_whole_clause = _starts_clause(before) and (i + length == len(words) or words[i + length].kind != "word")
        if "ADDRESS" in kinds and is_whole_clause and length < len(words):
            return None
        if "ADDRESS" in kinds and not (kinds := kinds - {"ADDRESS"}):
            return Lexeme(frozenset({"TEXT"}), start, end)
        if "FILLER" in kinds:
            in_name = before and before[-1].kinds & {"DET", "PREP", "ORD"} and not before[-1].kinds & {"PRON"}
            addressed = i + length < len(words) and words[i + length].text in {",", ":"} and _starts_clause(before)
            if in_name and kinds == {"FILLER"} and length == 1:
                return Lexeme(frozenset({"TEXT"}), start, end)
            if kinds == {"FILLER"} or addressed or (kinds <= _HEDGES and _starts_clause(before) and i + length < len(words)):
                return None
        is_gerund = words[i].text.endswith("ing") and not kinds & _NEVER_GERUND
        return Lexeme(kinds | {"GERUND"} if is_gerund else kinds, start, end)

    def _unknown(self, words: list[_Word], i: int, before: list[Lexeme]) -> Lexeme:
        word = words[i]
        at_start = _starts_clause(before)
        after_turn = bool(before) and bool(before[-1].kinds & {"PAN", "TILT", "MOVE", "NUM", "DEG", "ZOOM"})
        before_number = i + 1 < len(words) and words[i + 1].kind == "num"
        if (after_turn or (at_start and before_number)) and word.text in _DIRECTION_LETTERS:
            return Lexeme(self._table[(_DIRECTION_LETTERS[word.text],)], word.start, word.end)
        guess = (
            _corrected(word.text, word_list("commands"))
            if at_start
            else _corrected(word.text, word_list("directions"))
            if after_turn
            else None
        )
        return Lexeme(self._table[(guess,)] if guess else frozenset({"TEXT"}), word.start, word.end)

    @staticmethod
    def _longest(sequence: list[str], table: Mapping[tuple[str, ...], object]) -> int:
        return next((n for n in range(len(sequence), 0, -1) if tuple(sequence[:n]) in table), 0)


def _starts_clause(before: list[Lexeme]) -> bool:
    return not before or bool(before[-1].kinds & {*SEPARATORS, "CANYOU"})


def _append(out: list[Lexeme], lexeme: Lexeme) -> None:
    """Append a lexeme. Neighbouring separators are merged; they are dropped before words that attach to the previous words."""
    if lexeme.kinds <= {*SEPARATORS}:
        if not out:
            return
        if out[-1].kinds <= {*SEPARATORS}:
            strongest = max(out[-1].kinds | lexeme.kinds, key=("AND", "COMMA", "THEN", "STOP").index)
            out[-1] = Lexeme(frozenset({strongest}), out[-1].start, lexeme.end)
            return
    elif (
        lexeme.kinds & _ATTACHED_TO_PREVIOUS
        and out
        and out[-1].kinds <= {*SEPARATORS}
        and not ("ATMOST" in lexeme.kinds and "STOP" in out[-1].kinds)
    ):
        out.pop()
    out.append(lexeme)


def _merge_text(lexemes: list[Lexeme], text: str) -> list[Lexeme]:
    """Merge neighbouring free words into one lexeme, and colours with "and" between them ("red and white barriers")."""
    out: list[Lexeme] = []
    for i, lexeme in enumerate(lexemes):
        free = "TEXT" in lexeme.kinds
        if free and len(out) >= 2 and out[-1].kinds & {"AND", "OR"} and "TEXT" in out[-2].kinds:
            left = text[out[-2].start : out[-2].end].lower().split()[-1]
            right = text[lexeme.start : lexeme.end].lower().split()[0].split("-")[0]
            follows = " " in text[lexeme.start : lexeme.end] or (i + 1 < len(lexemes) and "TEXT" in lexemes[i + 1].kinds)
            if left in _COLOURS and right in _COLOURS and follows:
                out.pop()
                out[-1] = Lexeme(out[-1].kinds, out[-1].start, lexeme.end)
                continue
        if free and out and "TEXT" in out[-1].kinds:
            out[-1] = Lexeme(out[-1].kinds, out[-1].start, lexeme.end)
        else:
            out.append(lexeme)
    return out


def preset_key(name: str) -> tuple[str, ...]:
    """Return a preset name in the form used for comparison: lower-case words without accents, with numbers in digits."""
    decomposed = unicodedata.normalize("NFKD", name.lower())
    words = re.findall(r"[^\W\d_]+|\d+", "".join(c for c in decomposed if not unicodedata.combining(c)))
    return tuple(str(int(NUMBER_WORDS[w])) if w in NUMBER_WORDS and NUMBER_WORDS[w] < 100 else w for w in words)
