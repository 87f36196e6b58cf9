"""Parse the text of an instruction into steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from scope_ptz.planner.grammar.instruction_tree import Ask, Count, GoToPreset, Read, Step, Sweep
from scope_ptz.planner.grammar.lexing.lexer import Lexeme, lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import MARKERS, Clause, NotUnderstoodError, Source
from scope_ptz.planner.grammar.parsing.reader import Reader
from scope_ptz.planner.grammar.parsing.rewording.contractions import with_contractions
from scope_ptz.planner.grammar.parsing.rewording.contrasts import without_denials
from scope_ptz.planner.grammar.parsing.rewording.corrected_ones import with_noun_for_corrected_one
from scope_ptz.planner.grammar.parsing.rewording.named_corrections import with_corrections_in_form
from scope_ptz.planner.grammar.parsing.rewording.phrases import reworded
from scope_ptz.planner.grammar.parsing.rewording.plain_text import plainer, without_asides
from scope_ptz.planner.grammar.parsing.rewording.relayed import relayed
from scope_ptz.planner.grammar.parsing.rewording.repairs import Repaired, repaired, unresolved_editing
from scope_ptz.planner.grammar.parsing.rewording.withdrawn_parts import without_withdrawn_parts
from scope_ptz.planner.grammar.parsing.segments.order import in_order
from scope_ptz.planner.grammar.parsing.segments.segmentation import clauses_of
from scope_ptz.planner.grammar.parsing.segments.settings_first import with_settings_first
from scope_ptz.planner.grammar.parsing.sentences import SentenceReader

MAX_CHARS = 2000  # longer texts are rejected as a whole, because part of an instruction must not be carried out alone
MAX_LEXEMES = 250  # maximum number of lexemes in a text that is parsed
MAX_CONDITIONS = 12  # maximum number of conditions in a text that is parsed
_MAX_QUOTATIONS = 3
_MAX_QUOTED_WORDS = 8  # longer quotations are truncated to this many words


@dataclass(frozen=True, slots=True)
class Parsed:
    """The result of parsing.

    Attributes:
        text: The instruction, with spaces instead of the words that the user retracted.
        steps: Its steps; None if some words were not understood.
        unread: Quotations of the words that were not understood.
        said: The instruction in the user's words, but without asides; empty if it was parsed as it was written.
    """

    text: str
    steps: tuple[Step, ...] | None
    unread: tuple[str, ...] = ()
    said: str = ""


@lru_cache(maxsize=512)
def parse(text: str, presets: tuple[str, ...] = ()) -> Parsed:
    """Parse an instruction. This never raises an exception."""
    if len(text) > MAX_CHARS:
        return Parsed(text, None)
    text = with_noun_for_corrected_one(with_corrections_in_form(text, presets), presets)
    said = without_asides(text, presets)
    plain = plainer(said, presets)
    for wording in (relayed(plain, presets), plain if plain != text else None):
        if wording is not None and (parsed := _parse_as_written(wording, presets)).steps is not None:
            return replace(parsed, said=said)
    return _parse_as_written(text, presets)


def _parse_as_written(text: str, presets: tuple[str, ...]) -> Parsed:
    """Parse text without the changes that ``parse`` makes to the wording first."""
    lexemes = lexemes_of(text, presets)
    if not lexemes or is_too_complex(lexemes):
        return Parsed(text, None)
    said, unclear = without_withdrawn_parts(Repaired(with_contractions(reworded(lexemes)), text))
    corrected = without_denials(repaired(said.lexemes, said.text))
    lexemes, text = corrected.lexemes, corrected.text
    if unresolved := unclear or unresolved_editing(lexemes):
        return Parsed(text, None, _quoted(text, unresolved))
    try:
        clauses = in_order(with_settings_first(clauses_of(lexemes)))
        steps = SentenceReader(Reader(Source(text, presets)), clauses).steps()
    except NotUnderstoodError as error:
        return Parsed(text, None, _quoted(text, error.lexemes))
    return (
        Parsed(text, tuple(_with_preset_first(steps, is_vantage_point=_is_vantage_point(clauses, lexemes))))
        if steps
        else Parsed(text, None)
    )


def _is_vantage_point(clauses: Sequence[Clause], lexemes: Sequence[Lexeme]) -> bool:
    """Return whether the last clause only states where to look from to answer a question: "is it open? Look from the yard."."""
    is_asked = clauses[-1].is_question and not any(x.has("OPEN") for x in lexemes)
    if len(clauses) < 2 or is_asked or any(x.has("THEN") for x in lexemes):
        return False
    asks = clauses[-2].is_question and clauses[-1].link == "."
    goes = any(x.has("SWITCH", "CARRY", "TURN", "PAN") for x in clauses[-1].lexemes)
    return asks and not goes


def _with_preset_first(steps: list[Step], *, is_vantage_point: bool) -> list[Step]:
    """Move a preset that is named after its question to the front: "how many are there? Use the yard preset."."""
    *before, last = steps
    if not before or not all(isinstance(s, Count | Ask | Read) for s in before):
        return steps
    is_place = isinstance(last, GoToPreset) and (last.how == "use" or (is_vantage_point and last.how != "look"))
    return [last, *before] if is_place or isinstance(last, Sweep) else steps  # "has a ladder been left out? Check all around."


def is_too_complex(lexemes: Sequence[Lexeme]) -> bool:
    """Return whether there are too many lexemes or conditions to parse in a fraction of a second."""
    conditions = sum(lexeme.has(*MARKERS) for lexeme in lexemes)
    return len(lexemes) > MAX_LEXEMES or conditions > MAX_CONDITIONS


def _quoted(text: str, lexemes: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return quotations of the words that were not understood."""
    if not lexemes:
        return ()
    groups: list[tuple[int, int]] = []  # spans of free words with at most one other word between them
    for i, lexeme in enumerate(lexemes):
        if lexeme.has("FREE"):
            joins = groups and i - groups[-1][1] <= 2
            groups[-1:] = [(groups[-1][0], i)] if joins else [*groups[-1:], (i, i)]
    if not groups or len(groups) > _MAX_QUOTATIONS:
        groups = [(0, len(lexemes) - 1)]
    phrases = [text[lexemes[first].start : lexemes[last].end].split() for first, last in groups]
    phrases = [words for words in phrases if words] or [text.split()]
    return tuple(
        dict.fromkeys(" ".join(words[:_MAX_QUOTED_WORDS]) + (" ..." if len(words) > _MAX_QUOTED_WORDS else "") for words in phrases)
    )
