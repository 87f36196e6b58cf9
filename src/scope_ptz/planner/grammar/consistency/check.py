"""Check that a plan accounts for its instruction.

The check reads the instruction again, with simple rules of its own. It therefore notices words that the parser loses, swallows or
reverses, so that the planner asks the user instead of moving the camera.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from difflib import SequenceMatcher

from scope_ptz.english import listing
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.consistency.acts import forbidden_actions, ignored_conditions, omitted_actions
from scope_ptz.planner.grammar.consistency.directions import contradicted_zoom, ignored_directions, unnamed_directions
from scope_ptz.planner.grammar.consistency.evidence import Evidence, evidence_of
from scope_ptz.planner.grammar.consistency.last_words import unclear_last_words
from scope_ptz.planner.grammar.consistency.numbers import is_amount, unused_numbers
from scope_ptz.planner.grammar.consistency.slots import swallowed_command
from scope_ptz.planner.grammar.consistency.unsafe_wordings import unsafe_wording
from scope_ptz.planner.grammar.consistency.withdrawals import withdrawing_statement
from scope_ptz.planner.grammar.consistency.words import REPAIRING, Word, words_of
from scope_ptz.planner.grammar.lexing.preset_names import preset_key
from scope_ptz.planner.grammar.parsing.rewording.named_corrections import unresolved_correction, with_corrections_in_form

_LEAVING_OUT = re.compile(
    r"(?:\b(?:but|and) not|(?<!\ba )(?<!\bthe )(?<!\bany )(?<!\bno )\bskip|\bleave out|\bmiss out|\bnot"
    r"|\bbut don t (?:stop|go)|\bexcept)(?: at| to| do| in)?(?: the)?$"
)
"""Words before a preset that leave it out; "a skip at the yard" is a container."""

_STAY = re.compile(
    r"\bwithout moving\b|\b(?:do not|don['’]?t) move(?: the camera| it)?\s*(?:[.,;!]|$)|\bbut stay (?:here|put|where you are)\b",
    re.IGNORECASE,
)
"""Words that forbid every movement."""

_MOVE_OR_STAY = "You asked me not to move, but also to do something for which the camera must move. Which of the two shall I do?"
_WHOLE_TURN = frozenset({"360"})  # "over the full 360 degrees" is also the whole scene
_PURPOSE = re.compile(
    r"\b(?:so|so that|because|as|since) (?:i|we) (?:can|could|cannot|can t|want to|need to) (?:see|view|watch)(?: \w+)?$"
)
"""The beginning of a clause that says what a move is for, up to the name of the thing to be seen: "so I can see the"."""


def objection(instruction: str, steps: Sequence[ast.Step], presets: Sequence[str] = ()) -> str | None:
    """Return the question to ask if the steps do not account for the instruction; None if they do.

    Args:
        instruction: The user's text.
        steps: The steps with all names resolved.
        presets: The camera's presets.
    """
    evidence = evidence_of(steps)
    found = (swallowed_command(text, is_thing=is_thing) for text, is_thing in evidence.texts.items())
    if swallowed := next(filter(None, found), None):
        return not_understood([swallowed])
    if evidence.forbids_moving and evidence.moves:
        return _MOVE_OR_STAY
    words = words_of(instruction)
    _mark_described(words, evidence)
    _mark_presets(words, evidence)
    unexplained = sorted(
        {
            word.start: word
            for word in (
                *unused_numbers(words, evidence),
                *ignored_directions(words, evidence),
                *contradicted_zoom(words, evidence),
                *omitted_actions(words, evidence),
                *ignored_conditions(words, evidence),
                *unvisited_presets(words, evidence, presets),
            )
        }.values(),
        key=lambda word: word.start,
    )
    if unexplained:
        return not_understood(_phrases(instruction, words, unexplained))
    if unnamed := unnamed_directions(words, evidence):
        return f"I am not sure that you mean {listing(unnamed, 'or')}. Which way shall I turn, and how far?"
    return None


def objection_to_loss(said: str, steps: Sequence[ast.Step], presets: Sequence[str] = ()) -> str | None:
    """Return the question to ask if rewording lost a direction, a number or a preset, or added a direction; None if it did not.

    Args:
        said: The user's words before they were reworded; empty if they were not.
        steps: The steps with all names resolved.
        presets: The camera's presets.
    """
    if not said:
        return None
    evidence = evidence_of(steps)
    words = words_of(said)
    _mark_described(words, evidence)
    _mark_presets(words, evidence)
    lost = (
        *(word for word in unused_numbers(words, evidence) if is_amount(words, word)),
        *ignored_directions(words, evidence),
        *contradicted_zoom(words, evidence),
        *unvisited_presets(words, evidence, presets),
    )
    unexplained = sorted({word.start: word for word in lost if word.text not in _WHOLE_TURN}.values(), key=lambda word: word.start)
    if unexplained and not any(word.text in REPAIRING for word in words):
        return not_understood(_phrases(said, words, unexplained))
    if unnamed := unnamed_directions(words, evidence):
        return f"I am not sure that you mean {listing(unnamed, 'or')}. Which way shall I turn, and how far?"
    return None


def objection_to_forbidden(instruction: str, steps: Sequence[ast.Step]) -> str | None:
    """Return the question to ask if the steps do something that the instruction forbids; None if they do not.

    Args:
        instruction: The user's text, before any of it was left out.
        steps: The steps with all names resolved.
    """
    evidence = evidence_of(steps)
    if _STAY.search(instruction) and evidence.moves:
        return _MOVE_OR_STAY
    words = words_of(instruction)
    _mark_described(words, evidence)
    found = {word.start: word for word in (*forbidden_actions(words, evidence), *presets_left_out(words, evidence))}
    return not_understood(_phrases(instruction, words, [found[start] for start in sorted(found)])) if found else None


def objection_to_wording(instruction: str, presets: tuple[str, ...] = ()) -> str | None:
    """Return the question to ask if a statement takes back, forbids or changes what is asked for, or may be misread; else None.

    Args:
        instruction: The user's text, with abbreviations written out.
        presets: The camera's presets.
    """
    meant = with_corrections_in_form(instruction, presets)
    words = withdrawing_statement(instruction) or unresolved_correction(instruction, presets) or unclear_last_words(meant, presets)
    if words is not None:
        return f'You said "{words}", so I did nothing. Please say only what I should do.'
    return None if (words := unsafe_wording(instruction)) is None else not_understood([words])


NOT_UNDERSTOOD = "I did not understand"
"""The beginning of the questions about words that were not understood."""


def not_understood(phrases: Sequence[str]) -> str:
    """Return the question that names the words that were not understood."""
    quoted = listing([f'"{phrase}"' for phrase in phrases])
    return f"{NOT_UNDERSTOOD} {quoted}, so I did nothing. Please say it another way."


def unvisited_presets(words: Sequence[Word], evidence: Evidence, presets: Sequence[str]) -> list[Word]:
    """Return the words of preset names that the instruction mentions but the plan does not use."""
    found: list[Word] = []
    for preset in presets:
        name = re.findall(r"[^\W\d_]+|\d+", preset.lower())
        if not name or preset in evidence.presets or evidence.has(ast.ListPresets):
            continue
        for i in range(len(words) - len(name) + 1):
            span = words[i : i + len(name)]
            if (
                [word.text for word in span] == name
                and not _is_purpose(words, i)
                and not any(word.is_described or word.is_negated or _is_in_used_name(word, evidence) for word in span)
            ):
                found += span
    return found


def presets_left_out(words: Sequence[Word], evidence: Evidence) -> list[Word]:
    """Return the words of presets that the instruction leaves out but the plan visits: "check all presets, but not the roof"."""
    found: list[Word] = []
    for preset in evidence.presets:
        name = re.findall(r"[^\W\d_]+|\d+", preset.lower())
        mentions = [i for i in range(len(words) - len(name) + 1) if [word.text for word in words[i : i + len(name)]] == name]
        if mentions and _LEAVING_OUT.search(" ".join(word.text for word in words[max(0, mentions[-1] - 6) : mentions[-1]])):
            found += words[mentions[-1] : mentions[-1] + len(name)]
    return found


def _is_purpose(words: Sequence[Word], i: int) -> bool:
    """Return whether the words before a position say what a move is for: "pan left 10 so I can see the dock"."""
    before = " ".join(word.text for word in words[max(0, i - 7) : i])
    return _PURPOSE.search(before) is not None


def _is_in_used_name(word: Word, evidence: Evidence) -> bool:
    return any(word.text in re.findall(r"[^\W\d_]+|\d+", name.lower()) for name in evidence.presets)


def _mark_described(words: Sequence[Word], evidence: Evidence) -> None:
    """Mark the words that the plan passes on to perception in a description or question."""
    texts = [word.text for word in words]
    for description in evidence.texts:
        passed_on = [word.text for word in words_of(description)]
        for block in SequenceMatcher(None, texts, passed_on, autojunk=False).get_matching_blocks():
            for word in words[block.a : block.a + block.size]:
                word.is_described = True
    for text, times in Counter(texts).items():
        described = sum([word.text for word in words_of(description)].count(text) for description in evidence.texts)
        if described >= times:  # "which half has more cars, left or right?"
            for word in words:
                word.is_described = word.is_described or word.text == text


def _mark_presets(words: Sequence[Word], evidence: Evidence) -> None:
    """Mark the names of the presets that the plan uses, so that their numbers and directions are not read as amounts."""
    for preset in evidence.presets:
        name = re.findall(r"[^\W\d_]+|\d+", preset.lower())
        for i in range(len(words) - len(name) + 1):
            span = words[i : i + len(name)]
            if tuple(word.text for word in span) == tuple(name) or preset_key(" ".join(w.text for w in span)) == preset_key(preset):
                for word in span:
                    word.is_described = True


def _phrases(instruction: str, words: Sequence[Word], chosen: Sequence[Word]) -> list[str]:
    """Return the chosen words as quotations of the instruction; neighbouring words form one phrase."""
    indices = [words.index(word) for word in chosen]
    runs: list[list[int]] = []
    for index in indices:
        if runs and index == runs[-1][-1] + 1:
            runs[-1].append(index)
        else:
            runs.append([index])
    return list(dict.fromkeys(instruction[words[run[0]].start : words[run[-1]].end] for run in runs))
