"""Put the settings of the camera before the question that they serve.

"How many planters are there? To find out, move to the forecourt." is read as "move to the forecourt. How many planters are there?".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from scope_ptz.planner.grammar.parsing.parts.clause import Clause
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search

_ASKS = "(FILLER|LEADFILLER|WRAPPER|MODAL SELF|SELF|MODAL)* (TELL|COUNT|LISTING|READ|DESCRIBE|WHQ|HOWMANY|PREP WHQ|put|rank|add)"
_NEEDED = "(you_will_have_to|you_have_to|you_need_to|you_will_need_to|SELF (MODAL)? (have|need) to)"
_LOOKS = "HOWMANY|WHQ|COUNT|TELL|REPEAT"
_ONLY_LOOKS = "(AIM|SHOW|TELL|have_a_look|take_a_look) (there|here|FILLER)*"
_VANTAGE = (
    "(FILLER|WRAPPER)* ((look|check) (it)? (from|at|in)|from|(?P<use>use|using)) (?P<place>(DET|PRESETNOUN)* (PRESET|"
    "FREE)+ PRESETNOUN?) "
    "(FILLER|PURPOSE)*"
)
_IF_ANY = ("one", "any", "some")


def with_settings_first(clauses: Sequence[Clause]) -> list[Clause]:
    """Return clauses with the moves before the question if the instruction says that they are needed to answer it."""
    clauses = _without_empty_conditions(clauses)
    for start in range(1, len(clauses)):
        question, settings = clauses[:start], clauses[start:]
        if (
            settings[0].link in {".", ":", ","}
            and _is_unconditional_question(question)
            and (reordered := _settings_for_question(question, settings))
        ):
            return [replace(reordered[0], link=""), *reordered[1:], replace(question[0], link="."), *question[1:]]
    return clauses


def _without_empty_conditions(clauses: Sequence[Clause]) -> list[Clause]:
    """Drop "if there is one" after a question that is not a yes-or-no question, because its answer says if there is none."""
    out: list[Clause] = []
    for i, clause in enumerate(clauses):
        ends = i + 1 == len(clauses) or clauses[i + 1].link in {".", ":"}
        opener = clause.opener if clause.marker == "IFSO" and not clause.lexemes and ends else None
        if opener is not None and opener.word.split("_")[-1] in _IF_ANY and out and search("WHQ", out[-1].lexemes):
            out[-1] = replace(out[-1], is_question=out[-1].is_question or clause.is_question)
        else:
            out.append(clause)
    return out


def _is_unconditional_question(clauses: Sequence[Clause]) -> bool:
    """Return whether clauses begin with a question and contain no condition."""
    first = clauses[0]
    return not any(clause.marker for clause in clauses) and (first.is_question or match_start(_ASKS, first.lexemes) is not None)


def _settings_for_question(question: Sequence[Clause], settings: Sequence[Clause]) -> list[Clause]:
    """Return the clauses that set the camera for a question; empty if their words do not say that they do."""
    settings = list(settings)
    if any(clause.marker or clause.is_question for clause in settings):
        return []
    last, is_needed = settings[-1], False
    if full_match("PURPOSE (COMMA|FILLER)*", settings[0].lexemes):
        del settings[0]  # "To find out, ..."
        is_needed = True
    elif settings[0].link == ":" and len(settings) > 1 and last.link in {"and", "then"} and full_match(_ONLY_LOOKS, last.lexemes):
        del settings[-1]  # "...: pan left 20 and look"
        is_needed = True
    elif len(settings) == 1 and len(question) == 1 and question[0].is_question and (vantage := full_match(_VANTAGE, last.lexemes)):
        return [replace(last, lexemes=last.lexemes if vantage.has("use") else tuple(vantage["place"]))]
    is_needed = is_needed or (
        settings[0].link == "."
        and bool(match_start(f"PURPOSE|{_NEEDED}", settings[0].lexemes) or search(r"PURPOSE FILLER* \Z", last.lexemes))
    )
    if not settings or not is_needed or any(search(_LOOKS, clause.lexemes) for clause in settings):
        return []
    return settings
