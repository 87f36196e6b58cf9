"""Patterns of word classes: matching, groups, and the test that spares compiling a pattern that cannot match."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.planner.grammar.lexing.lexer import lexemes_of
from scope_ptz.planner.grammar.parsing.parts.patterns import full_match, match_start, search
from scope_ptz.planner.grammar.parsing.parts.required_words import is_met, requirement_of

WORDS = ("pan", "tilt", "cars", "left", "20")
NAMES = ("PAN", "TILT", "FREE", "LEFT", "NUM", "cars", "left", "_")


def _grouped(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.lists(parts, min_size=1, max_size=3).map(" ".join),
        st.lists(parts, min_size=1, max_size=3).map(lambda branches: f"({'|'.join(branches)})"),
        st.tuples(parts, st.sampled_from("?*+")).map(lambda pair: f"({pair[0]}){pair[1]}"),
        parts.map(lambda part: f"(?!{part}) _"),
    )


PATTERNS = st.recursive(st.sampled_from(NAMES), _grouped, max_leaves=6)


@given(PATTERNS, st.lists(st.sampled_from(WORDS), min_size=1, max_size=4))
def test_a_pattern_that_matches_has_the_words_that_it_needs(pattern: str, words: list[str]) -> None:
    lexemes = lexemes_of(" ".join(words))
    names = {lexeme.word for lexeme in lexemes} | {name for lexeme in lexemes for name in lexeme.classes}
    # With an alternative that always matches, the pattern is compiled whatever it needs.
    match = full_match(f"(?P<needed>{pattern})|_*", lexemes)
    assert match is not None
    matched = match.has("needed")
    assert (full_match(pattern, lexemes) is not None) == matched
    assert not matched or is_met(requirement_of(pattern), names)


@pytest.mark.parametrize(
    ("pattern", "names", "expected"),
    [
        ("PAN LEFT", {"PAN"}, False),
        ("PAN LEFT?", {"PAN"}, True),
        ("(PAN|TILT) NUM", {"TILT", "NUM"}, True),
        ("(PAN|TILT) NUM", {"LEFT", "NUM"}, False),
        ("(?P<verb>PAN)* _+", set(), True),
        ("(?!PAN) LEFT", {"LEFT"}, True),
        ("", set(), True),
    ],
)
def test_needed_words(pattern: str, names: set[str], expected: bool) -> None:
    assert is_met(requirement_of(pattern), names) == expected


def test_groups_hold_lexemes() -> None:
    lexemes = lexemes_of("pan left 20")
    match = full_match("PAN (?P<way>LEFT|RIGHT) (?P<amount>NUM)", lexemes)
    assert match is not None
    assert [lexeme.word for lexeme in match["way"]] == ["left"]
    assert match["amount"][0].value == 20
    assert match_start("PAN LEFT", lexemes) is not None
    assert match_start("LEFT", lexemes) is None
    assert search("LEFT NUM", lexemes) is not None
