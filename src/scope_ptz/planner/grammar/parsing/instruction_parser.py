"""Parse the text of an instruction into steps, with the grammar of ``language.lark``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from scope_ptz.planner.grammar.instruction_tree import Ask, Count, GoToPreset, Read, Step
from scope_ptz.planner.grammar.lexing.lexer import SEPARATORS, Lexeme, Lexer
from scope_ptz.planner.grammar.parsing.chart import ChartParser
from scope_ptz.planner.grammar.parsing.rules import load_rules

_STRUCTURAL = frozenset({*SEPARATORS, "OR", "THAN", "IF", "UNLESS", "OTHERWISE", "UNTIL"})
"""Terminals that cannot be part of a description."""

_FREE_WORDS = frozenset({"TEXT", "PRESETNAME"})  # terminals that have no cost in a description
_COMMON_IN_DESCRIPTIONS = frozenset(
    {
        "AFTER", "AHEAD", "ANY", "AROUND", "BE", "BEFORE", "BY", "CAMERA", "CIRCLE", "CLOSE", "COMPASS", "DEG", "DET", "DOWN",
        "FEWERTHAN", "FIELD", "FOR", "FRACTION", "FULL", "FULLSCOPE", "HIGHER", "HOURS", "IN", "INVIEW", "LEFT", "LEVEL",
        "LITTLE", "LOT", "MINUTES", "MORE", "MORETHAN", "NONE", "NOWSCOPE", "NUM", "OFVIEW", "ONEOF", "ORDINAL",
        "ORMORE", "OUT", "PERCENT", "PICTURE", "PREP", "PRESETWORD", "PRON", "RIGHT", "SAYS", "SCENESCOPE", "SECONDS",
        "SEVERAL", "SURROUND", "THATREL", "THERE", "TO", "UP", "VISIBLE", "WHO", "X", "YOUSEE",
    }
)  # fmt: skip
"""Terminals that often occur in descriptions, and therefore have a lower cost there than other terminals."""

MAX_CHARS = 2000  # longer texts are not parsed, because the first part of an instruction must not be carried out alone
MAX_LEXEMES = 120  # maximum number of lexemes in a text that is parsed
MAX_CONDITIONS = 12  # maximum number of conditions in a text that is parsed; each one multiplies the number of readings
_CONDITIONS = frozenset({"IF", "IFSO", "UNLESS", "OTHERWISE", "UNTIL", "WHILE"})


@dataclass(frozen=True, slots=True)
class Parsed:
    """The result of parsing. ``steps`` is None if the grammar does not cover the text."""

    text: str
    steps: tuple[Step, ...] | None


@lru_cache(maxsize=2)
def parser(presets_known: bool) -> ChartParser:
    """Return the parser, which is loaded on first use.

    Args:
        presets_known: Whether the camera's presets are known. If not, free words after "at" or "in" are not read as a preset.
    """
    return ChartParser(load_rules(presets_known=presets_known))


@lru_cache(maxsize=512)
def roles(kinds: frozenset[str]) -> frozenset[str]:
    """Return the terminals that a lexeme can match, including its role in a description.

    The role is WORD (free), SOFT (at a low cost) or HARD (at a high cost). Because of the costs, the parser prefers readings in
    which a known phrase keeps its own meaning. A lexeme that structures the sentence has no role.
    """
    if kinds & _FREE_WORDS:
        return kinds | {"WORD"}
    if kinds & _STRUCTURAL or "GERUND" in kinds:
        return kinds
    return kinds | {"SOFT"} if kinds & _COMMON_IN_DESCRIPTIONS else kinds | {"HARD"}


@lru_cache(maxsize=512)
def parse(text: str, presets: tuple[str, ...] = ()) -> Parsed:
    """Return the steps of an instruction. No text raises an exception."""
    from scope_ptz.planner.grammar.parsing.step_builder import StepBuilder

    lexemes = Lexer(presets).lexemes(text) if len(text) <= MAX_CHARS else []
    if not lexemes or is_too_complex(lexemes):
        return Parsed(text, None)
    steps: list[Step] = []
    for first, last in _sentences(lexemes):
        tree = parser(bool(presets)).parse([roles(lexeme.kinds) for lexeme in lexemes[first:last]], "sentence")
        if tree is None:
            return Parsed(text, None)
        steps = StepBuilder(text, lexemes[first:last]).extend(tree, steps)
    return Parsed(text, tuple(_with_preset_first(steps)))


def _with_preset_first(steps: list[Step]) -> list[Step]:
    """Move a preset that is named after its question to the front: "how many are there? Use the yard preset."."""
    *before, last = steps
    if isinstance(last, GoToPreset) and last.how == "use" and before and all(isinstance(s, Count | Ask | Read) for s in before):
        return [last, *before]
    return steps


def is_too_complex(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether there are too many lexemes or conditions to parse in a fraction of a second."""
    conditions = sum(bool(lexeme.kinds & _CONDITIONS) for lexeme in lexemes)
    return len(lexemes) > MAX_LEXEMES or conditions > MAX_CONDITIONS


def covers(clause: Sequence[Lexeme], presets: tuple[str, ...]) -> bool:
    """Return whether the lexemes of a clause parse by themselves."""
    return parser(bool(presets)).parse([roles(lexeme.kinds) for lexeme in clause], "sentence") is not None


def _sentences(lexemes: list[Lexeme]) -> list[tuple[int, int]]:
    """Return the range of lexemes of each sentence: the first index, and the index after the last."""
    stops = [i for i, lexeme in enumerate(lexemes) if "STOP" in lexeme.kinds]
    edges = [-1, *stops, len(lexemes)]
    return [(a + 1, b) for a, b in pairwise(edges) if b > a + 1]
