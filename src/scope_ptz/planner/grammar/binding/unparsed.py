"""Name the words of an instruction that no rule of the grammar covers."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.planner.grammar.lexing.lexer import SEPARATORS, Lexeme, Lexer
from scope_ptz.planner.grammar.parsing.instruction_parser import MAX_CHARS, covers, is_too_complex

_MAX_QUOTED_WORDS = 8  # longer clauses are quoted by their first words
_MAX_QUOTED = 3  # number of quotations in one question


def unparsed_phrases(text: str, presets: tuple[str, ...]) -> list[str]:
    """Return the words that are not understood: unknown words of the clauses that do not parse, or else these clauses.

    Args:
        text: An instruction that does not parse.
        presets: The camera's presets.

    Returns:
        At most three quotations of the instruction; none if it is too long to be parsed.
    """
    lexemes = Lexer(presets).lexemes(text) if len(text) <= MAX_CHARS else []
    if not lexemes or is_too_complex(lexemes):
        return []
    clauses = [clause for clause in _clauses(lexemes) if not covers(clause, presets)]
    phrases = [phrase for clause in clauses or [lexemes] for phrase in _unknown_words(text, clause) or [_quoted(text, clause)]]
    return list(dict.fromkeys(phrases))[:_MAX_QUOTED]


def _clauses(lexemes: Sequence[Lexeme]) -> list[Sequence[Lexeme]]:
    """Return the lexemes of each clause, without the separators between them."""
    edges = [-1, *(i for i, lexeme in enumerate(lexemes) if lexeme.kinds & {*SEPARATORS}), len(lexemes)]
    return [lexemes[a + 1 : b] for a, b in pairwise(edges) if b > a + 1]


def _unknown_words(text: str, clause: Sequence[Lexeme]) -> list[str]:
    """Return the free words of a clause that also has known words."""
    free = [lexeme for lexeme in clause if "TEXT" in lexeme.kinds]
    return [_quoted(text, [lexeme]) for lexeme in free] if len(free) < len(clause) else []


def _quoted(text: str, lexemes: Sequence[Lexeme]) -> str:
    words = text[lexemes[0].start : lexemes[-1].end].split()
    return " ".join(words[:_MAX_QUOTED_WORDS]) + (" ..." if len(words) > _MAX_QUOTED_WORDS else "")
