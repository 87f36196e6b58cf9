"""The features of a segment from which the models tell what it does."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from scope_ptz.english.grammar.parts_of_speech import lemmas_of, parts_of_speech, verb_form
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.clause import VERBS
from scope_ptz.planner.grammar.parsing.parts.questions import is_question
from scope_ptz.planner.grammar.parsing.parts.statements import is_comment, is_statement
from scope_ptz.planner.grammar.parsing.remark_detection.segments import Segment

_WORD = re.compile(r"[a-z']+|\d+")
_MAX_LENGTH = 8  # longer segments count as this many words
_TAGGED_WORDS = 3  # number of words at the beginning whose parts of speech are a feature
_NEGATIONS = frozenset({"not", "no", "never", "nobody", "none", "nothing", "nor", "neither", "cannot", "without"})
_SUBJECTS = frozenset({"i", "we", "you", "he", "she", "it", "they", "this", "that", "there"})


def features_of(segments: Sequence[Segment], index: int, presets: tuple[str, ...]) -> frozenset[str]:
    """Return the features of a segment: its words, their classes and parts of speech, its form, and the words beside it.

    Args:
        segments: All segments of the instruction.
        index: The index of the segment.
        presets: The camera's presets. Their words are not features, because they differ between cameras.
    """
    found = _own_features(segments, index, presets)
    if index and (before := _words(segments[index - 1].text, presets)):
        found |= {f"before {before[0]}", f"just before {before[-1]}"}
    if index + 1 < len(segments) and (after := _words(segments[index + 1].text, presets)):
        found.add(f"after {after[0]}")
    return frozenset(found)


def statement_features_of(segments: Sequence[Segment], index: int, presets: tuple[str, ...]) -> frozenset[str]:
    """Return the features of a statement beside a command: as for remarks, but not the words beside it, and with its negations.

    What a statement means does not depend on the command that it stands beside.

    Args:
        segments: All segments of the instruction.
        index: The index of the segment.
        presets: The camera's presets.
    """
    found = _own_features(segments, index, presets)
    words = _words(segments[index].text, presets)
    lemmas = {lemma for word in words for lemma in lemmas_of(word)}
    found |= {f"lemma {lemma}" for lemma in lemmas}
    is_negative = any(word in _NEGATIONS or word.endswith("n't") for word in words)
    subject = next((word for word in words if word.split("'")[0] in _SUBJECTS), "none")
    found |= {f"negative {is_negative}", f"negative {is_negative} of {subject}"}
    if is_negative:
        found |= {f"negated {lemma}" for lemma in lemmas}
    return frozenset(found)


def _own_features(segments: Sequence[Segment], index: int, presets: tuple[str, ...]) -> set[str]:
    """Return the features of a segment that do not depend on the words of the others."""
    segment = segments[index]
    words = _words(segment.text, presets)
    lexemes = lexemes_of(segment.text, presets)
    found = {f"word {word}" for word in words}
    found |= {f"pair {first} {second}" for first, second in pairwise(words)}
    found |= {f"class {name}" for lexeme in lexemes for name in lexeme.classes}
    found.add(f"length {min(len(words), _MAX_LENGTH)}")
    found.add(f"position {'first' if index == 0 else 'last' if index == len(segments) - 1 else 'middle'}")
    found.add(f"mark before {segments[index - 1].mark if index else 'none'}")
    found.add(f"mark after {segment.mark}")
    if words:
        found |= {f"first {words[0]}", f"first two {' '.join(words[:2])}", f"last {words[-1]}"}
        tags = [_tag(word) for word in words[:_TAGGED_WORDS]]
        found |= {f"tags {' '.join(tags)}", f"tags {' '.join(tags[:2])}"}
    if lexemes:
        found |= {f"first class {name}" for name in lexemes[0].classes}
        forms = {
            "statement": is_statement(lexemes),
            "comment": is_comment(lexemes),
            "question": is_question(lexemes),
            "command": lexemes[0].has(*VERBS),
            "with command": any(lexeme.has(*VERBS) for lexeme in lexemes),
        }
        found |= {f"form {name}" for name, is_so in forms.items() if is_so}
    return found


def _words(text: str, presets: tuple[str, ...]) -> list[str]:
    """Return the words of a text in lower case, with placeholders for numbers and the words of preset names."""
    names = {word for preset in presets for word in re.findall(r"[a-z]+", preset.lower())}
    words = _WORD.findall(text.lower().replace("’", "'"))
    return ["NUMBER" if word.isdigit() else "PRESET" if word in names else word for word in words]


def _tag(word: str) -> str:
    """Return the form of a verb, or otherwise the possible parts of speech of a word."""
    return verb_form(word) or "/".join(sorted(parts_of_speech(word))) or "unknown"
