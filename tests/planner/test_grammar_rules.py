"""The compiled rules and phrases match the grammar and the vocabulary."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

import pytest

from scope_ptz.planner.grammar.compiled import compiled_lines, heading
from scope_ptz.planner.grammar.lexing import phrases
from scope_ptz.planner.grammar.parsing import rules
from scope_ptz.planner.grammar.parsing.rules import RULES_FOR_KNOWN_PRESETS, Rule, RuleBook, load_rules, symbols_of


@pytest.fixture(scope="module")
def compiled() -> dict[Path, str]:
    return rules.compiled_texts()


@pytest.fixture(scope="module")
def lines(compiled: dict[Path, str]) -> list[str]:
    return next(iter(compiled.values())).splitlines()[1:]


def test_the_compiled_rules_are_up_to_date(compiled: dict[Path, str]) -> None:
    how = 'run: python -c "from scope_ptz.planner.grammar.parsing.rules import write_stored_rules; write_stored_rules()"'
    assert {path.name for path in compiled} == {"language.rules", "language.symbols"}
    for path, text in compiled.items():
        assert path.read_text(encoding="utf-8") == text, how


def test_the_compiled_phrases_are_up_to_date() -> None:
    assert phrases.is_current(), (
        'run: python -c "from scope_ptz.planner.grammar.lexing.phrases import write_stored_phrases; write_stored_phrases()"'
    )
    assert phrases.phrase_table().phrases() == phrases.expanded()


def test_rules_survive_being_written(lines: list[str]) -> None:
    assert lines
    for line in lines:
        assert str(Rule.from_line(line)) == line


@pytest.mark.parametrize("presets_known", [True, False])
def test_rules_are_found_by_their_first_symbol(presets_known: bool, lines: list[str]) -> None:
    wanted = [rule for rule in map(Rule.from_line, lines) if presets_known or rule.name not in RULES_FOR_KNOWN_PRESETS]
    book = load_rules(presets_known=presets_known)
    assert list(book.symbols) == symbols_of(wanted)
    assert [
        rule for _, rule in sorted((pair for s in book.symbols for pair in book.starting_with(s)), key=lambda pair: pair[0])
    ] == wanted
    assert RuleBook([], []).starting_with("NUM") == []


def test_an_unknown_phrase_has_no_terminals() -> None:
    table = phrases.phrase_table()
    words, kinds = next(islice(table.phrases().items(), 100, None))
    assert words in table and table[words] == table.get(words) == kinds
    for unknown in (("xyzzy",), (words[0], "xyzzy")):
        assert unknown not in table and table.get(unknown) == frozenset()
        with pytest.raises(KeyError):
            table[unknown]


def test_what_was_compiled_from_another_source_is_not_used(tmp_path: Path) -> None:
    source, compiled = tmp_path / "source.txt", tmp_path / "source.compiled"
    source.write_text("one")
    compiled.write_text(f"{heading(source)}\nfirst\nsecond\n")
    assert compiled_lines(source, compiled) == ["first", "second"]
    source.write_text("two")
    assert compiled_lines(source, compiled) is None
