"""Tokens, spelling, word classes and preset names."""

from __future__ import annotations

import pytest

from scope_ptz.english.grammar.tokens import tokenise
from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.lexing.lexicon import phrases, spelling_lists
from scope_ptz.planner.grammar.lexing.morphology import verb_forms
from scope_ptz.planner.grammar.lexing.preset_names import preset_at
from scope_ptz.planner.grammar.lexing.spelling import corrected_noun, corrected_word


def words(text: str) -> list[str]:
    return [token.text for token in tokenise(text)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("zoom in 2x", ["zoom", "in", "2", "x"]),
        ("tilt -7.5°", ["tilt", "-7.5", "°"]),
        ("L15 U5", ["l", "15", "u", "5"]),
        ("don't", ["do", "not"]),
        ("what's the man's hat?", ["what", "is", "the", "man", "'s", "hat", "?"]),
        ("10-15", ["10", "-", "15"]),
        ("1/2 turn", ["1/2", "turn"]),
        ("1,000", ["1000"]),
    ],
)
def test_tokens(text: str, expected: list[str]) -> None:
    assert words(text) == expected


def test_a_token_keeps_its_place_in_the_text() -> None:
    text = "Pan LEFT, don't zoom"
    assert [text[token.start : token.end] for token in tokenise(text)][:3] == ["Pan", "LEFT", ","]


@pytest.mark.parametrize(
    ("typed", "meant"),
    [("rihgt", "right"), ("tlit", "tilt"), ("pann", "pan"), ("lfet", "left"), ("pictrue", "picture"), ("rotat", "rotate")],
)
def test_slips_of_the_keys_are_corrected(typed: str, meant: str) -> None:
    assert corrected_word(typed) == meant


@pytest.mark.parametrize("word", ["pane", "tile", "lift", "snowing", "gates", "truck", "book", "flange", "heron", "kiosk", "van"])
def test_words_are_not_turned_into_others(word: str) -> None:
    assert corrected_word(word) == word


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("exavator", "excavator"),
        ("exavators", "excavators"),
        ("bicyle", "bicycle"),
        ("umbrela", "umbrella"),
        ("trafic", "traffic"),
        ("shunter", "shunter"),
        ("skelter", "skelter"),
        ("harrow", "harrow"),
    ],
)
def test_a_misspelt_thing_is_the_only_known_one_within_a_slip(typed: str, meant: str) -> None:
    assert corrected_noun(typed) == meant


def test_no_word_of_the_spelling_lists_is_corrected() -> None:
    lists = spelling_lists()
    assert all(corrected_word(word) == word for word in lists["real"] if word not in lists["fixed"])


@pytest.mark.parametrize(
    ("verb", "form"),
    [
        ("pan", "panning"),
        ("swivel", "swivelling"),
        ("swivel", "swiveling"),
        ("take", "taking"),
        ("see", "seeing"),
        ("move", "moving"),
    ],
)
def test_gerunds(verb: str, form: str) -> None:
    assert form in verb_forms(verb)["ing"]


def test_the_longest_expression_wins_but_not_over_a_preset() -> None:
    assert [x.word for x in lexemes_of("all the way left")] == ["all_the_way", "left"]
    names = lexemes_of("show me the front door", ("front-door",))
    assert [x.preset for x in names] == ["", "", "", "front-door"]


def test_if_there_is_stands_for_an_answer_only_before_a_command() -> None:
    assert "IFSO" in lexemes_of("if there is, go home")[0].classes
    assert "IF" in lexemes_of("if there is a van, go home")[0].classes


@pytest.mark.parametrize(
    ("text", "preset", "used"),
    [
        ("loading dock door", "loading-dock", 2),
        ("loading - dock", "loading-dock", 3),
        ("carpark", "car-park", 1),
        ("gatepost", "", 0),
    ],
)
def test_presets_are_found(text: str, preset: str, used: int) -> None:
    assert preset_at(text.split(), ("gate", "loading-dock", "car-park")) == (preset, used)


def test_every_expression_of_the_lexicon_is_lexed_whole() -> None:
    ends = {"IFSO", "IFNOT", "EACHTIME", "PURPOSE"}
    broken = [
        key
        for key, classes in phrases().items()
        if not classes & ends and len(lexemes_of(" ".join(key))) > 1 and "'" not in "".join(key)
    ]
    assert len(broken) <= len(phrases()) // 50, broken[:20]
