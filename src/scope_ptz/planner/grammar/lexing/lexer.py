"""From text to lexemes: words are grouped into known phrases, numbers are read, everything else stays free text.

Each lexeme may be several terminals at once ("left" is a direction or a verb); the grammar decides. Lexemes keep their place
in the original text, so descriptions and questions are passed on as the person typed them.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass

from scope_ptz.planner.grammar.lexing.number_phrases import read_number
from scope_ptz.planner.grammar.lexing.vocabulary import NUMBER_WORDS, phrase_table, spelling, word_list

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
_BINDS_BACK = frozenset({"UNTIL", "OTHERWISE", "ATMOST", "EACHTIME"})
_LONGEST_PHRASE = 9
_LETTERS = {"r": "right", "l": "left", "u": "up", "d": "down"}
_TURNED = frozenset({"TILT", "PAN", "MOVE", "LOOK", "CAMERA"})
_NEVER_DONE = frozenset({*SEPARATORS, "DET", "ONEOF", "PREP", "SAYS", "BY", "SHOWS", "VISIBLE", "FILLS"})
_HEDGES = frozenset({"FILLER", "BY"})
_DIAGONALS = ("UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT")


@dataclass(frozen=True, slots=True)
class Lexeme:
    """``kinds``: the terminals it may be; ``start``, ``end``: characters in the original text; ``value``: of a number."""

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
    """Raw tokens. Apostrophes split words ("don't" is don, t) and hyphens separate them."""
    out: list[_Word] = []
    lowered = "".join(c.lower() if len(c.lower()) == 1 else c for c in text)
    for match in _TOKEN.finditer(lowered):
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
    """Turn "step 1:" into a sentence end."""
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
    """Turn the "1." and "2)" of a numbered list into sentence ends; they must count up from one."""
    wanted, out = 1, list[_Word]()
    for i, word in enumerate(words):
        after = words[i + 1].text if i + 1 < len(words) else ""
        starts = i == 0 or words[i - 1].text in {"\n", ".", ";", ",", ":", "(", ")"} or wanted > 1
        if word.text in (str(wanted), chr(96 + wanted)) and starts and after in {".", ")"} and i + 2 < len(words):
            wanted += 1
            out.append(_Word(";", word.start, word.end, "mark"))
        else:
            out.append(word)
    return out if wanted > 2 else words


def distance_one(a: str, b: str) -> bool:
    """Whether one insertion, deletion, substitution or swap of neighbours makes ``a`` into ``b``."""
    if abs(len(a) - len(b)) > 1 or a == b:
        return a == b
    head = next((i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b)))
    rest_a, rest_b = a[head:], b[head:]
    swapped = len(rest_a) >= 2 and rest_a[1:2] + rest_a[:1] + rest_a[2:] == rest_b
    return swapped or rest_a[1:] == rest_b[1:] or rest_a[1:] == rest_b or rest_a == rest_b[1:]


def _respelled(word: str, candidates: Iterable[str]) -> str | None:
    """The one command word that a misspelt word can only mean, if there is exactly one."""
    if len(word) < 3 or word in word_list("real words") or (word,) in phrase_table():
        return None
    close = [c for c in candidates if len(c) >= 3 and distance_one(word, c)]
    return close[0] if len(close) == 1 else None


class Lexer:
    """Lexemes of a text, given the preset names that count as words of the language."""

    def __init__(self, presets: tuple[str, ...] = ()) -> None:
        self._table = phrase_table()
        self._presets = {key: name for name in presets if (key := preset_key(name)) and key not in self._table}

    def lexemes(self, text: str) -> list[Lexeme]:
        words, out, i = _words(text), list[Lexeme](), 0
        while i < len(words):
            lexeme, i = self._next(words, i, out)
            if lexeme:
                _append(out, lexeme)
        while out and out[-1].kinds & {*SEPARATORS}:
            out.pop()
        return _merge_text(out, text)

    def _next(self, words: list[_Word], i: int, before: list[Lexeme]) -> tuple[Lexeme | None, int]:
        word = words[i]
        if word.kind in {"mark", "arrow", "dash"}:
            kind = _MARKS.get(word.text) or ("THEN" if word.kind == "arrow" else "COMMA")
            return Lexeme(frozenset({kind}), word.start, word.end), i + 1
        if word.kind == "quote":
            return Lexeme(frozenset({"TEXT"}), word.start, word.end), i + 1
        run = []
        for w in words[i : i + _LONGEST_PHRASE]:
            if w.kind not in {"word", "num"}:
                break
            run.append(w.text)
        preset = self._longest([(preset_key(w) or (w,))[0] for w in run], self._presets) if self._presets else 0
        phrase = self._longest(run, self._table)
        if run[:1] == ["the"] and phrase > 1 and self._presets:
            named = self._longest([(preset_key(w) or (w,))[0] for w in run[1:]], self._presets)
            phrase = 1 if named >= phrase - 1 else phrase  # "the overview" where a preset is called so
        if (
            before
            and phrase > 1
            and run[0] in {"up", "down"}
            and before[-1].kinds & _TURNED
            and not self._table[tuple(run[:phrase])] & {"UP", "DOWN", *_DIAGONALS}
        ):
            phrase = 1  # "tilt up to 10" is a direction, not a limit
        number = read_number(run, [(w.start, w.end) for w in words[i : i + len(run)]])
        if run[:2] == ["if", "you"] and phrase > 1 and "FILLER" in self._table[tuple(run[:phrase])] and phrase < len(run):
            phrase = 1  # "if you can see" is a condition, "if you can" at the end is politeness
        if (
            run[:1] == ["or"]
            and phrase > 1
            and self._table[tuple(run[:phrase])] & {"ORMORE", "ORFEWER"}
            and not (before and "NUM" in before[-1].kinds)
        ):
            phrase = 1
        if preset >= max(phrase, number.used, 1):
            return Lexeme(frozenset({"PRESETNAME"}), word.start, words[i + preset - 1].end), i + preset
        if number.used and number.used >= phrase:
            if _starts_clause(before) and "FILLER" in self._table.get(tuple(run[: number.used]), ()):
                return None, i + number.used  # "first, ..."
            kinds = number.kinds | (self._table[tuple(run[:phrase])] if phrase == number.used else frozenset())
            return Lexeme(frozenset(kinds), word.start, words[i + number.used - 1].end, number.value), i + number.used
        if phrase:
            return self._phrase(words, i, phrase, before), i + phrase
        return self._unknown(words, i, before), i + 1

    def _phrase(self, words: list[_Word], i: int, length: int, before: list[Lexeme]) -> Lexeme | None:
        kinds = self._table[tuple(w.text for w in words[i : i + length])]
        start, end = words[i].start, words[i + length - 1].end
        alone = _starts_clause(before) and (i + length == len(words) or words[i + length].kind != "word")
        if "ADDRESS" in kinds and alone and length < len(words):
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
        doing = words[i].text.endswith("ing") and not kinds & _NEVER_DONE
        return Lexeme(kinds | {"GERUND"} if doing else kinds, start, end)

    def _unknown(self, words: list[_Word], i: int, before: list[Lexeme]) -> Lexeme:
        word = words[i]
        at_start = _starts_clause(before)
        after_turn = bool(before) and bool(before[-1].kinds & {"PAN", "TILT", "MOVE", "NUM", "DEG", "ZOOM"})
        before_number = i + 1 < len(words) and words[i + 1].kind == "num"
        if (after_turn or (at_start and before_number)) and word.text in _LETTERS:
            return Lexeme(self._table[(_LETTERS[word.text],)], word.start, word.end)
        guess = (
            _respelled(word.text, word_list("commands"))
            if at_start
            else _respelled(word.text, word_list("directions"))
            if after_turn
            else None
        )
        return Lexeme(self._table[(guess,)] if guess else frozenset({"TEXT"}), word.start, word.end)

    @staticmethod
    def _longest(run: list[str], table: dict[tuple[str, ...], frozenset[str]] | dict[tuple[str, ...], str]) -> int:
        return next((n for n in range(len(run), 0, -1) if tuple(run[:n]) in table), 0)


def _starts_clause(before: list[Lexeme]) -> bool:
    return not before or bool(before[-1].kinds & {*SEPARATORS, "CANYOU"})


def _append(out: list[Lexeme], lexeme: Lexeme) -> None:
    """Add a lexeme; neighbouring separators become one, and none stands before words that bind to what went before."""
    if lexeme.kinds <= {*SEPARATORS}:
        if not out:
            return
        if out[-1].kinds <= {*SEPARATORS}:
            strongest = max(out[-1].kinds | lexeme.kinds, key=("AND", "COMMA", "THEN", "STOP").index)
            out[-1] = Lexeme(frozenset({strongest}), out[-1].start, lexeme.end)
            return
    elif (
        lexeme.kinds & _BINDS_BACK
        and out
        and out[-1].kinds <= {*SEPARATORS}
        and not ("ATMOST" in lexeme.kinds and "STOP" in out[-1].kinds)
    ):
        out.pop()
    out.append(lexeme)


def _merge_text(lexemes: list[Lexeme], text: str) -> list[Lexeme]:
    """Join neighbouring free words, and colours with "and" between them ("red and white barriers"), into one lexeme."""
    out: list[Lexeme] = []
    for i, lexeme in enumerate(lexemes):
        free = "TEXT" in lexeme.kinds
        if free and len(out) >= 2 and out[-1].kinds & {"AND", "OR"} and "TEXT" in out[-2].kinds:
            left = text[out[-2].start : out[-2].end].lower().split()[-1]
            right = text[lexeme.start : lexeme.end].lower().split()[0].split("-")[0]
            follows = " " in text[lexeme.start : lexeme.end] or (i + 1 < len(lexemes) and "TEXT" in lexemes[i + 1].kinds)
            if left in word_list("colours") and right in word_list("colours") and follows:
                out.pop()
                out[-1] = Lexeme(out[-1].kinds, out[-1].start, lexeme.end)
                continue
        if free and out and "TEXT" in out[-1].kinds:
            out[-1] = Lexeme(out[-1].kinds, out[-1].start, lexeme.end)
        else:
            out.append(lexeme)
    return out


def preset_key(name: str) -> tuple[str, ...]:
    """A preset name as the lexer sees it: lower-case words without accents, and numbers in digits."""
    plain = unicodedata.normalize("NFKD", name.lower())
    words = re.findall(r"[^\W\d_]+|\d+", "".join(c for c in plain if not unicodedata.combining(c)))
    return tuple(str(int(NUMBER_WORDS[w])) if w in NUMBER_WORDS and NUMBER_WORDS[w] < 100 else w for w in words)
