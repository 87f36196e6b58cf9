"""Read clauses that look at the scene: counts, questions, reading, pictures, close-ups and following."""

from __future__ import annotations

from collections.abc import Sequence

from scope_ptz.english.grammar.lexicon import lexicon
from scope_ptz.planner.grammar.instruction_tree import Ask, Count, Step, Sweep
from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.looks.asking import question_step
from scope_ptz.planner.grammar.parsing.looks.closeups import close_up_step, read_step, track_step
from scope_ptz.planner.grammar.parsing.looks.counting import check_places_step, count_step
from scope_ptz.planner.grammar.parsing.looks.pictures import picture_step
from scope_ptz.planner.grammar.parsing.parts.clause import SKIP, Source, text_of
from scope_ptz.planner.grammar.parsing.parts.noun_phrases import thing_of, things_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match
from scope_ptz.planner.grammar.parsing.parts.scopes import has_full_scope, without_view

_ALL_AROUND = (
    "look_all_around|look_all_round|have_a_look_all_around|look_all_the_way_round|look_all_the_way_around|check_all_around|"
    "sweep|scan|survey"
)
"""Commands to look at the whole scene, after which a site may be named."""

_SITES = frozenset({None, "ground", "field", "road", "building", "grass"})
"""The kinds of things that are no object to look for: unknown nouns ("the stadium"), and surfaces that fill the scene."""


def look_step(source: Source, lexemes: Sequence[Lexeme], *, has_question_mark: bool) -> Step | tuple[Step, ...] | None:
    """Return the step of a clause that looks at the scene; None for other clauses.

    Args:
        source: The instruction.
        lexemes: The clause.
        has_question_mark: Whether a question mark ends the clause.
    """
    bare, view = without_view(lexemes)
    for read in (picture_step, check_places_step, _sweep):
        if (step := read(source, lexemes)) is not None:
            return step
    if (
        has_question_mark
        and (match := full_match(r"(FILLER|SEE|SHOW|any|got)* (ANY|DET) (?P<thing>_+?) (VISIBLE|there|here|about|anywhere)*", bare))
        and (lexemes[0].has("SEE", "ANY") or lexemes[0].word == "got")
        and not any(x.has("PICTURE", "CLOSER", "SNAP") for x in bare)
        and (thing := thing_of(source, match["thing"])) is not None
        and thing.text
    ):
        return Ask(text_of(source, lexemes) + "?", "full" if has_full_scope(lexemes) else view)
    for reader in (count_step, read_step):
        if (step := reader(source, bare, view)) is not None:
            return step
    for read in (track_step, close_up_step):
        if (step := read(source, bare)) is not None:
            return step
    return question_step(source, lexemes, bare, view, has_question_mark=has_question_mark)


def _sweep(source: Source, lexemes: Sequence[Lexeme]) -> Step | tuple[Step, ...] | None:
    """Read "sweep the scene", which makes the questions after it apply to the whole scene."""
    scope = (
        r"(DET|FULL|WHOLETHING|VIEWNOUN|PRESETNOUN|area|site|AROUND|CAMERA|through|FILLER|over|of|whole|entire|"
        r"full|sweep|place|LIMIT|surroundings|look|and|have|DET|all|full_sweep|once|CARRY|TURN|in|AIM|complete|"
        r"yard|room|field|LITTLE|horizon|HORIZON|NUM DEG|so_that|one|SCAN|at)*"
    )
    if (
        full_match(
            (
                rf"{SKIP} (DET)? (FULL|LIMIT|full|complete)? (SCAN|SCAN-ING|check|look|AIM|look_through|do|DET|TELL|have a "
                rf"look|(TURN) (NUM DEG|LIMIT) "
                rf"AROUND|cover) {scope}"
            ),
            lexemes,
        )
        and (any(x.has("SCAN", "SCAN-ING", "FULL") for x in lexemes))
        and not any(x.has("LEFT", "RIGHT", "UP", "DOWN", "HORIZON") or (x.has("TURN") and not x.has("SCAN")) for x in lexemes)
    ):
        return Sweep(turn=any(x.word in {"do_a_360", "do_a_full_360", "do_a_full_circle"} for x in lexemes))
    around = full_match(rf"{SKIP} ({_ALL_AROUND}) (in|on|over|across)? DET (?P<site>FREE{{1,2}}) (FILLER)*", lexemes)
    if around is not None and lexicon().concept(around["site"][-1].word) in _SITES:
        return Sweep()  # "have a look all around the ground"
    match = full_match(
        (
            rf"{SKIP} (SCAN|SCAN-ING) (?P<where>(DET|FULL|VIEWNOUN|AROUND|area|site|through|of|over|place)*) (for|to "
            rf"(SEE|FIND|COUNT)|COUNT-ING|COUNT) (?P<things>_+)"
        ),
        lexemes,
    )
    if match and (things := things_of(source, match["things"])):
        return (Sweep(), Count(things, "full"))
    return None
