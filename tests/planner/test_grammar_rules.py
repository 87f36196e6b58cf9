"""The compiled rules match the grammar."""

from __future__ import annotations

from scope_ptz.planner.grammar.parsing.rules import Rule, is_current, load_rules


def test_the_compiled_rules_are_up_to_date() -> None:
    assert is_current(), 'run: python -c "from scope_ptz.planner.grammar.parsing.rules import renew; renew()"'


def test_rules_survive_being_written() -> None:
    for rule in load_rules():
        assert Rule.from_line(str(rule)) == rule
