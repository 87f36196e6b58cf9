"""Read "'s" as "is" where it cannot be a possessive: "if the gate's open", unlike "if the driver's door is open".

This applies to conditions and to statements that are to be checked: "make sure the gate's shut".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.parts.statements import is_only_noun

_CONDITIONS = ("IF", "WHEN", "UNLESS", "UNTIL", "WHILE")
_CHECKS = frozenset({"check", "make_sure", "ensure", "verify", "confirm"})
"""Verbs before a statement to be checked: "check the gate's shut"."""

_ENDS = ("COMMA", "STOP", "QUESTION", "COLON", "THEN", "DASH", "IFNOT")
_SUBJECTS = ("FREE", "PRESET", "SOMEONE")
_VERBS = ("BE", "HAVEV", "MODAL", "DOV")


def with_contractions(lexemes: Sequence[Lexeme]) -> tuple[Lexeme, ...]:
    """Return lexemes with "'s" as "is" in conditions and statements to be checked that have no other auxiliary verb."""
    out = list(lexemes)
    is_condition = False
    for i, x in enumerate(out):
        is_condition = (is_condition or x.has(*_CONDITIONS) or x.word in _CHECKS) and not x.has(*_ENDS)
        if not is_condition or x.word != "'s" or not i or i + 1 >= len(out) or not out[i - 1].has(*_SUBJECTS):
            continue
        end = next((j for j in range(i, len(out)) if out[j].has(*_ENDS)), len(out))
        if out[i + 1].has("NUM", *_ENDS) or is_only_noun(out[i + 1]) or any(y.has(*_VERBS) for y in out[i + 1 : end]):
            continue
        out[i] = replace(x, word="is", classes=frozenset({"BE", "GLUE"}))
    return tuple(out)
