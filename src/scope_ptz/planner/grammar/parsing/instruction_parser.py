"""From the text of an instruction to its steps, with the grammar of ``language.lark``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from scope_ptz.planner.grammar.instruction_tree import Step
from scope_ptz.planner.grammar.lexing.lexer import SEPARATORS, Lexeme, Lexer
from scope_ptz.planner.grammar.parsing.chart import ChartParser
from scope_ptz.planner.grammar.parsing.rules import load_rules

_BINDING = frozenset({*SEPARATORS, "OR", "THAN", "IF", "UNLESS", "OTHERWISE", "UNTIL"})
_FREE = frozenset({"TEXT", "PRESETNAME"})
_SOFT = frozenset(
    {
        "AFTER", "AHEAD", "ANY", "AROUND", "BE", "BEFORE", "BY", "CAMERA", "CIRCLE", "CLOSE", "COMPASS", "DEG", "DET", "DOWN",
        "FEWERTHAN", "FIELD", "FOR", "FRACTION", "FULL", "FULLSCOPE", "HIGHER", "HOURS", "IN", "INVIEW", "LEFT", "LEVEL",
        "LITTLE", "LOT", "MINUTES", "MORE", "MORETHAN", "NONE", "NOWSCOPE", "NUM", "OFVIEW", "ONEOF", "ORDINAL",
        "ORMORE", "OUT", "PERCENT", "PICTURE", "PREP", "PRESETWORD", "PRON", "RIGHT", "SAYS", "SCENESCOPE", "SECONDS",
        "SEVERAL", "SURROUND", "THATREL", "THERE", "TO", "UP", "VISIBLE", "WHO", "X", "YOUSEE",
    }
)  # fmt: skip
LONGEST_TEXT = 2000
MOST_LEXEMES = 120


@dataclass(frozen=True, slots=True)
class Parsed:
    """The result of parsing. ``steps`` is None when the text is not in the language."""

    text: str
    steps: tuple[Step, ...] | None


@lru_cache(maxsize=2)
def parser(presets_known: bool) -> ChartParser:
    """Return the parser, loaded on first use.

    Args:
        presets_known: Whether the camera's presets are known. Without them, free words after "at" or "in" are not taken for a
            preset.
    """
    return ChartParser(load_rules(guesses=presets_known))


@lru_cache(maxsize=512)
def roles(kinds: frozenset[str]) -> frozenset[str]:
    """Return the terminals that a lexeme may be, with its role inside a description: WORD (free), SOFT or HARD (at a cost)."""
    if kinds & _FREE:
        return kinds | {"WORD"}
    if kinds & _BINDING or "GERUND" in kinds:
        return kinds
    return kinds | {"SOFT"} if kinds & _SOFT else kinds | {"HARD"}


@lru_cache(maxsize=512)
def parse(text: str, presets: tuple[str, ...] = ()) -> Parsed:
    """Return the steps of an instruction. Never raises, whatever the text."""
    from scope_ptz.planner.grammar.parsing.step_builder import StepBuilder

    lexemes = Lexer(presets).lexemes(text[:LONGEST_TEXT])
    if not lexemes or len(lexemes) > MOST_LEXEMES:
        return Parsed(text, None)
    steps: list[Step] = []
    for first, last in _sentences(lexemes):
        tree = parser(bool(presets)).parse([roles(lexeme.kinds) for lexeme in lexemes[first:last]], "sentence")
        if tree is None:
            return Parsed(text, None)
        steps = StepBuilder(text, lexemes[first:last]).extend(tree, steps)
    return Parsed(text, tuple(steps))


def _sentences(lexemes: list[Lexeme]) -> list[tuple[int, int]]:
    stops = [i for i, lexeme in enumerate(lexemes) if "STOP" in lexeme.kinds]
    edges = [-1, *stops, len(lexemes)]
    return [(a + 1, b) for a, b in pairwise(edges) if b > a + 1]
