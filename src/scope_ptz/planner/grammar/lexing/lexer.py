"""Split text into lexemes: words and fixed expressions with their classes, numbers and preset names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.english.grammar.numbers import NUMBER_WORDS, read_number
from scope_ptz.english.grammar.parts_of_speech import parts_of_speech
from scope_ptz.english.grammar.tokens import Token, tokenise
from scope_ptz.english.numerals import FRACTIONS
from scope_ptz.planner.grammar.lexing.lexicon import longest_phrase, phrases
from scope_ptz.planner.grammar.lexing.preset_names import preset_at, preset_key, short_names
from scope_ptz.planner.grammar.lexing.spelling import corrected_word, is_english, within_one_edit

_MARKS = {
    ",": "COMMA", ".": "STOP", "!": "STOP", "\n": "STOP", ";": "STOP", "?": "QUESTION", ":": "COLON", "(": "OPEN", ")": "CLOSE",
    "-": "RANGE", "–": "DASH", "—": "DASH", '"': "QUOTE", "“": "QUOTE", "”": "QUOTE", "'": "QUOTE", "...": "COMMA", "…": "COMMA",
    "°": "DEG", "=": "EQUALS", "/": "SLASH", "•": "STOP", "*": "STOP", "‘": "QUOTE",
}  # fmt: skip
_MAX_NUMBER_WORDS = 8
_ENDING = frozenset({"IFSO", "IFNOT", "EACHTIME", "PURPOSE"})
"""Classes whose expressions must end a clause. "If there is" belongs to one only before a comma, a command or the end."""

_AFTER_ENDING = frozenset(
    {
        ",",
        ".",
        ";",
        ":",
        "?",
        "!",
        "–",
        "(",
        ")",
        "then",
        "and",
        "but",
        "please",
        "otherwise",
        "go",
        "take",
        "return",
        "switch",
        "count",
        "move",
        "\n",
        "just",
        "instead",
    }
)
_PARTS_OF_COMPOUNDS = (["the", "centre"], ["the", "center"], ["the", "front"])
_AFTER_THING = frozenset(
    {"on", "by", "in", "at", "near", "under", "behind", "beside", "hanging", "lying", "that", "next", "outside"}
)
_PLACE_NOUNS = frozenset({"preset", "presets", "position", "view", "side", "picture", "frame", "image", "shot", "camera"})
_COMMANDS = frozenset({"PAN", "TILT", "ZOOM", "SNAP", "TURN", "TRACK"})


_ADDRESSED = frozenset(
    {"operator", "captain", "skipper", "chief", "bud", "buddy", "mate", "pal", "boss", "lad", "lads", "fella", "fellas"}
)
"""Words for people. Without a determiner before them, they only address someone."""


_MIN_CHARS_OF_PRESET_WORD = 4  # shorter words of a preset's name must be spelt correctly
_AT_PLACE = frozenset({"at", "to", "go", "goto"})
"""Words after which the last word of a preset's name can stand for the preset: "at the gate"."""


@dataclass(frozen=True, slots=True)
class Lexeme:
    """A word, fixed expression, number, preset name or punctuation mark.

    Attributes:
        word: The words in lower case with corrected spelling, joined by "_".
        start: The index of the first character in the instruction.
        end: The index after the last character.
        classes: The classes of the lexicon, or FREE for other words; NUM, FRACTION or ORDINAL for numbers; PRESET for presets.
        value: The value of a number.
        preset: The name of the preset.
    """

    word: str
    start: int
    end: int
    classes: frozenset[str]
    value: float = 0.0
    preset: str = ""

    def has(self, *classes: str) -> bool:
        """Return whether the lexeme belongs to one of the classes."""
        return not self.classes.isdisjoint(classes)

    def reworded(self, word: str, *classes: str) -> Lexeme:
        """Return a lexeme with another word and the given classes, at the same position."""
        return Lexeme(word, self.start, self.end, frozenset(classes))


@lru_cache(maxsize=512)
def lexemes_of(text: str, presets: tuple[str, ...] = ()) -> tuple[Lexeme, ...]:
    """Return the lexemes of a text. At every position, the longest preset name, number or expression of the lexicon wins."""
    tokens = _without_inner_hyphens(_without_list_markers(tokenise(text)))
    known = {part for preset in presets for part in re.findall(r"[^\W\d_]+", preset.lower())}
    known |= {joined for preset in presets if (joined := re.sub(r"[\W_]+", "", preset.lower())).isalpha()}
    words = [_preset_word(token.text, known) if _resembles(token.text, known) else corrected_word(token.text) for token in tokens]
    words = _with_preset_words(["and" if word == "&" else word for word in words], presets)
    out: list[Lexeme] = []
    i = 0
    while i < len(tokens):
        lexeme, used = _lexeme_at(tokens, words, i, presets)
        out.append(lexeme)
        i += used
    return tuple(_with_short_names(_with_units(out, text), presets))


def _preset_word(word: str, known: set[str]) -> str:
    """Return the word in a preset's name that a misspelt word stands for; any other word unchanged.

    The misspelling is a doubled letter ("yardd") or, in a long word, one wrong, missing or additional letter ("weighbrige").
    """
    single = {word[:i] + word[i + 1 :] for i in range(1, len(word)) if word[i] == word[i - 1]} & known
    if len(single) == 1 and len(word) > 4:
        return single.pop()
    close = [name for name in known if len(word) > 5 and len(name) > 5 and within_one_edit(word, name)]
    return close[0] if len(close) == 1 and word not in known and not is_english(word) else word


def _with_preset_words(words: list[str], presets: tuple[str, ...]) -> list[str]:
    """Correct a misspelt word of a preset's name if all its other words match: "log dekc" becomes "log deck"."""
    out = list(words)
    for name in (preset_key(preset) for preset in presets):
        for i in range(len(words) - len(name) + 1 if len(name) > 1 else 0):
            said = words[i : i + len(name)]
            wrong = [j for j, (a, b) in enumerate(zip(said, name, strict=True)) if a != b]
            if len(wrong) != 1 or len(name[wrong[0]]) < _MIN_CHARS_OF_PRESET_WORD or is_english(said[wrong[0]]):
                continue
            if read_number(said[wrong[0] :]).used:
                continue  # "half a minute" does not name the preset "hall-a"
            if within_one_edit(said[wrong[0]], name[wrong[0]]):
                out[i + wrong[0]] = name[wrong[0]]
    return out


def _resembles(word: str, known: set[str]) -> bool:
    """Return whether a word equals a known one or, unless it is an English word, resembles one."""
    if word in known:
        return True
    return len(word) > 3 and not is_english(word) and any(len(name) > 3 and within_one_edit(word, name) for name in known)


def _lexeme_at(tokens: Sequence[Token], words: list[str], i: int, presets: tuple[str, ...]) -> tuple[Lexeme, int]:
    """Return the lexeme at a position, and the number of its tokens."""
    start = tokens[i].start
    length, classes = _phrase_at(words, i, presets)
    preset, preset_length = preset_at(words[i : i + 12], presets)
    if preset and preset_length >= length:
        return Lexeme(
            "_".join(words[i : i + preset_length]),
            start,
            tokens[i + preset_length - 1].end,
            frozenset({"PRESET"}) | (classes if length == preset_length else frozenset()),
            0.0,
            preset,
        ), preset_length
    window = words[i : i + _MAX_NUMBER_WORDS]
    number = read_number(window, [(token.start, token.end) for token in tokens[i : i + _MAX_NUMBER_WORDS]])
    if number.used and number.used >= length and not (words[i] in {"a", "an"} and number.used == 1):
        same = classes if number.used == length else frozenset()
        end = tokens[i + number.used - 1].end
        return Lexeme("_".join(words[i : i + number.used]), start, end, number.kinds | same, number.value), number.used
    if length:
        return Lexeme("_".join(words[i : i + length]), start, tokens[i + length - 1].end, classes), length
    mark = _MARKS.get(words[i])
    return Lexeme(words[i], start, tokens[i].end, frozenset({mark or "FREE"})), 1


def _phrase_at(words: Sequence[str], i: int, presets: tuple[str, ...]) -> tuple[int, frozenset[str]]:
    table = phrases()
    for length in range(min(longest_phrase(), len(words) - i), 0, -1):
        classes = table.get(tuple(words[i : i + length]))
        if classes and (length == 1 or _can_occur(words, i, length, classes, presets)):
            return length, classes
    return 0, frozenset()


def _can_occur(words: Sequence[str], i: int, length: int, classes: frozenset[str], presets: tuple[str, ...]) -> bool:
    """Return whether an expression can occur at a position: it must not overlap a preset, and may have to end a clause."""
    if words[i : i + length] == ["right", "then"] and i and words[i - 1].isalpha():
        return False  # "a quarter turn right then zoom in"
    if words[i + 1 : i + length] == ["the", "far"] and (i + length >= len(words) or words[i + length] in {"end", "side", "corner"}):
        return False  # "the car at the far end"
    after = words[i + length] if i + length < len(words) else "."
    if words[i : i + length] in _PARTS_OF_COMPOUNDS and _is_other_noun(after):
        return False  # "the centre circle", "the front door"
    if words[i : i + length] == ["the", "thing"] and after in _AFTER_THING:
        return False  # "the thing on the roof"
    if words[i : i + length] == ["the", "minute"] and after in {"hand", "hands"}:
        return False
    if words[i + 1 : i + length] == ["back"] and i + length < len(words) and words[i + length] in {"left", "right", "up", "down"}:
        return False  # "swing back right 20"
    if words[i + 1 : i + length] == ["it", "up"] and i + length < len(words) and is_number_word(words[i + length]):
        return False  # "bring it up 11"
    if any(preset_at(words[j : i + length + 3], presets)[0] for j in range(i + 1, i + length)):
        return False
    if words[i + length - 1] == "of" and "PREP" in classes and _is_amount(words[i + length : i + length + 2]):
        return False  # "a pan right of 8 degrees", "a rotation to the left of a third of a circle"
    if classes.isdisjoint(_ENDING) or words[i : i + length] in (["if", "so"], ["if", "not"]):
        return True
    return after in _AFTER_ENDING or not phrases().get((after,), frozenset()).isdisjoint(_COMMANDS)


def _is_amount(words: Sequence[str]) -> bool:
    """Return whether words begin with a number or a fraction: "8 degrees", "a third", "half"."""
    is_number = bool(words) and is_number_word(words[0])
    return is_number or any(word in FRACTIONS for word in (words[1:] if words[:1] in (["a"], ["an"]) else words[:1]))


def _is_other_noun(word: str) -> bool:
    """Return whether a word is a noun that does not mean a part of the picture or a preset."""
    is_known = word != "circle" and (word,) in phrases()
    return word not in _PLACE_NOUNS and not is_known and "NOUN" in parts_of_speech(word)


def _with_short_names(lexemes: list[Lexeme], presets: tuple[str, ...]) -> list[Lexeme]:
    """Read "at the gate" as the preset "main-gate", if no other preset's name contains that word."""
    short = short_names(presets)
    out = list(lexemes)
    for i, x in enumerate(lexemes):
        is_noun = x.has("FREE") or (i > 0 and lexemes[i - 1].word == "the")
        if not is_noun or x.word not in short:
            continue
        before = [y for y in lexemes[max(0, i - 2) : i] if y.word != "the"]
        is_place = bool(before) and (before[-1].word in _AT_PLACE and (i < 2 or lexemes[i - 1].word in {"the", before[-1].word}))
        is_place = is_place or _is_listed(lexemes, i) or _is_where_things_are_counted(lexemes, i)
        after = lexemes[i + 1] if i + 1 < len(lexemes) else None
        if is_place and (after is None or not (after.has("FREE", "PRESET", "NUM") or after.word in {"of", "'s"})):
            out[i] = Lexeme(x.word, x.start, x.end, frozenset({"PRESET"}), 0.0, short[x.word])
    return out


def _is_where_things_are_counted(lexemes: Sequence[Lexeme], i: int) -> bool:
    """Return whether a position ends "how many taxis are there on the rank?", and the word names nothing that perception knows."""
    words = [x.word for x in lexemes[max(0, i - 2) : i]]
    ends = i + 1 == len(lexemes) or lexemes[i + 1].has("STOP", "QUESTION")
    is_counted = any(x.has("HOWMANY") for x in lexemes[: i - 2])
    return words == ["on", "the"] and ends and is_counted and lexicon().concept(lexemes[i].word) is None


def _is_listed(lexemes: Sequence[Lexeme], i: int) -> bool:
    """Return whether "and" or "or" joins the word at a position to a preset: "the yard or the dock"."""
    before = [x for x in lexemes[max(0, i - 3) : i] if x.word != "the"]
    after = [x for x in lexemes[i + 1 : i + 4] if x.word != "the"]
    sides = (before[::-1][:2], after[:2])
    return any(len(side) == 2 and side[0].has("OR", "AND") and side[1].has("PRESET") for side in sides)


def _without_list_markers(tokens: list[Token]) -> list[Token]:
    """Drop the markers of a numbered or lettered list: "1. pan left", "a) pan left", "- pan left"."""
    out: list[Token] = []
    expected = 1
    i = 0
    while i < len(tokens):
        text = tokens[i].text
        after = tokens[i + 1].text if i + 1 < len(tokens) else ""
        at_start = not out or out[-1].text in {"\n", ".", ":", ";"} or (text == str(expected) and expected > 1)
        spaced = i + 2 < len(tokens) and tokens[i + 1].end < tokens[i + 2].start
        if (at_start and spaced and after in {".", ")"} and text == str(expected)) or (
            spaced and after == ")" and len(text) == 1 and text.isalpha() and (not out or out[-1].text != "(")
        ):
            out.append(Token(".", tokens[i].start, tokens[i + 1].end))
            expected += 1
            i += 2
            continue
        if text in {"-", "*", "•"} and (not out or out[-1].text == "\n"):
            i += 1
            continue
        out.append(tokens[i])
        i += 1
    return out


def _without_inner_hyphens(tokens: list[Token]) -> list[Token]:
    """Drop hyphens inside words ("close-up", "15-degree"). Other hyphens are dashes, which separate clauses as commas do."""
    out: list[Token] = []
    for i, token in enumerate(tokens):
        inner = 0 < i < len(tokens) - 1 and tokens[i - 1].end == token.start and tokens[i + 1].start == token.end
        if token.text != "-" or not inner:
            out.append(Token("–", token.start, token.end) if token.text == "-" else token)
        elif tokens[i - 1].text.isdigit() and tokens[i + 1].text.isdigit():
            out.append(token)  # a range, such as "10-15"
    return out


def _with_units(lexemes: list[Lexeme], text: str) -> list[Lexeme]:
    """Resolve letters that are units or directions only beside a number: "30 s", "L15", "2 m"."""
    out: list[Lexeme] = []
    for i, lexeme in enumerate(lexemes):
        before, after = (lexemes[j] if 0 <= j < len(lexemes) else None for j in (i - 1, i + 1))
        classes = lexeme.classes
        if (
            lexeme.word in {"s", "m", "x", "xs", "min", "h"}
            and not (before and (before.has("NUM") or (lexeme.word == "min" and before.word in {"a", "half a", "half_a"})))
            and not (lexeme.word == "x" and after and after.has("NUM"))
        ):
            classes = frozenset({"FREE"})
        elif lexeme.word == "m" and before and before.has("NUM") and before.end == lexeme.start:
            classes = frozenset({"BADUNIT"})
        elif lexeme.word == "u" and before and before.has("MODAL", "DOV"):
            classes = frozenset({"SELF"})  # "can u go left"
        elif (
            lexeme.word in {"l", "r", "u", "d"}
            and not (after and after.has("NUM"))
            and not (before and before.has("PAN", "TILT", "NUM", "TURN", "DEG", "AIM"))
        ):
            classes = frozenset({"SELF" if lexeme.word == "u" else "FREE"})  # "u see any cars?"
        elif lexeme.word in {"second", "seconds"} and lexeme.has("ORDINAL") and before and before.has("NUM", "FRACTION"):
            classes = frozenset({"SECONDS"})
        elif lexeme.word in {"hi", "there"} and lexeme.has("FILLER") and text[lexeme.end : lexeme.end + 1] == "-":
            classes = frozenset({"FREE"})  # "hi-vis vest"
        elif lexeme.word == "plus" and before and before.has("PAN", "TILT") and after and after.has("NUM"):
            classes = frozenset({"GLUE"})  # "tilt plus 5" has a sign
        elif lexeme.word in _ADDRESSED and before and _introduces(before):
            classes = frozenset({"FREE"})  # "if no operator is visible"
        elif lexeme.word == "side" and before and before.has("DET") and after and after.has("FREE"):
            classes = frozenset({"FREE"})  # "the side door"
        elif lexeme.word == "till" and before and before.has("DET"):
            classes = frozenset({"FREE"})  # "is the till light on?"
        elif lexeme.word == "point" and before and before.has("DET", "PREP"):
            classes = frozenset({"FREE"})
        out.append(lexeme if classes is lexeme.classes else Lexeme(lexeme.word, lexeme.start, lexeme.end, classes))
    return out


def _introduces(lexeme: Lexeme) -> bool:
    """Return whether a lexeme begins a noun phrase: "no" and "that" before "lad"."""
    return lexeme.word in {"that", "this"} or (lexeme.has("DET", "ANY", "HOWMANY") and not lexeme.has("NUM", "PRON"))


def is_number_word(word: str) -> bool:
    """Return whether a word is a digit string or a number word."""
    return word.isdigit() or word in NUMBER_WORDS
