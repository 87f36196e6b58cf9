"""Put clauses in the order in which they are to be carried out: "pan left 20, but first take a picture" begins with the picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.parsing.parts.clause import DIRECTIONS, VERBS, Clause, NotUnderstoodError, trimmed
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start

_BEFORE_FIRST = ("PICTURE", "NUM", "DEG", "HOME", *DIRECTIONS, "IN", "OUT", "X", "PERCENT", "PRON", "LITTLE", "LOT")
"""Classes of the words that can end a command."""

_FIRST_STEP = (
    f"(FILLER|BUT|COMMA)* (CARRY|SWITCH|to|DET)* PRESET first (FILLER)*|"
    f"(FILLER|BUT|COMMA)* ({'|'.join(VERBS)}) ((?!REL) _){{1,6}} FREE first (FILLER)*"
)
"""A preset or a command that ends with "first": "the silos first", "count the cars first"."""


def in_order(clauses: Sequence[Clause]) -> list[Clause]:
    """Return clauses in execution order, with a clause that says "first" moved ahead of the command before it.

    Raises:
        NotUnderstoodError: It is unclear which clauses come first, or which clauses they precede.
    """
    clauses = _with_start_first([_without_needless_first(clauses, i) for i in range(len(clauses))])
    if _only_last_is_first(clauses) and not match_start("BUT", clauses[-1].lexemes):
        raise NotUnderstoodError(clauses[-1].lexemes)  # "go to the yard. First zoom out": before going, or once there?
    for i, clause in enumerate(clauses):
        is_first = clause.marker == "FIRST" or _says_first_at_end(clauses, i)
        if not is_first and not (i == len(clauses) - 1 and _only_last_is_first(clauses)):
            continue
        end = next((j for j in range(i + 1, len(clauses)) if clauses[j].link != "and"), len(clauses))
        earlier, first, later = clauses[:i], clauses[i:end], clauses[end:]
        is_clear = len(earlier) == 1 and not earlier[0].marker and (not later or later[0].link == ".")
        if not is_clear or any(other.marker for other in first[1:]):
            raise NotUnderstoodError(clause.lexemes)
        lexemes = trimmed(clause.lexemes, "BUT", "FIRSTLY", "COMMA")
        begun = [replace(clause, link="", marker="", opener=None, lexemes=lexemes), *first[1:]]
        return [*begun, replace(earlier[0], link="then"), *later]
    return clauses


def _with_start_first(clauses: list[Clause]) -> list[Clause]:
    """Return clauses with the starting place first: "take three pictures, starting at the gate"."""
    *before, last = clauses or [Clause("", "", ())]
    if not before or any(clause.marker or clause.link == "." for clause in clauses) or last.is_question:
        return clauses
    if (
        full_match("(FILLER)* (starting|beginning) (at|from|with|on|in) (DET)? (PRESET|HOME) (PRESETNOUN|FILLER)*", last.lexemes)
        is None
    ):
        return clauses
    return [replace(last, link=""), replace(before[0], link="then"), *before[1:]]


def _without_needless_first(clauses: Sequence[Clause], i: int) -> Clause:
    """Return a clause without a "first" at its end if another clause comes after it: "take a picture first, then pan left"."""
    clause = clauses[i]
    is_needless = i + 1 < len(clauses) and clauses[i + 1].link in {"then", ","} and _ends_with_first(clause)
    return replace(clause, lexemes=trimmed(clause.lexemes, "FIRSTLY", "COMMA")) if is_needless else clause


def _only_last_is_first(clauses: Sequence[Clause]) -> bool:
    """Return whether the last sentence begins with "first", and nothing before it does: "go to the yard. But first the dock"."""
    last = clauses[-1] if len(clauses) > 1 else Clause("", "", ())
    begins = "(FILLER|BUT|COMMA)* first ((?!ANOTHER|PRESETNOUN|FREE|PICTURE) _)"
    if last.link != "." or last.marker or last.is_question or match_start(begins, last.lexemes) is None:
        return False
    is_ordered = any(x.has("FIRSTLY", "THEN", "BEFORE", "ORDINAL") for clause in clauses[:-1] for x in clause.lexemes)
    commands = [clause for clause in clauses[:-1] if any(x.has(*VERBS, *DIRECTIONS, "PRESET") for x in clause.lexemes)]
    return not is_ordered and bool(commands) and not any(clause.is_question for clause in clauses)


def _says_first_at_end(clauses: Sequence[Clause], i: int) -> bool:
    """Return whether a clause ends with "first", and is the last of at least two: "pan left 20, take a picture first"."""
    if not 0 < i == len(clauses) - 1:
        return False
    return _ends_with_first(clauses[i]) or (
        clauses[i].link in {".", ","} and full_match(_FIRST_STEP, clauses[i].lexemes) is not None
    )


def _ends_with_first(clause: Clause) -> bool:
    """Return whether a clause is a command that ends with "first". In "the gate first", that word belongs to the name."""
    lexemes = trimmed(clause.lexemes, "FILLER", "COMMA")
    return len(lexemes) > 1 and not clause.marker and lexemes[-1].word == "first" and lexemes[-2].has(*_BEFORE_FIRST)
