"""The parser finds exactly the readings that Lark's Earley parser finds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import Any

import lark
import pytest
from lark.exceptions import LarkError
from lark.lexer import Lexer
from lark.visitors import CollapseAmbiguities

from scope_ptz.english.grammar import questions
from scope_ptz.english.grammar.questions.chart_parser import ChartParser
from scope_ptz.english.grammar.questions.typed_tokens import Token, tokenise
from tests.perception.test_language import table

GRAMMAR = files(questions).joinpath("grammar.lark").read_text("utf-8")
TEXTS = [text for text, _ in (*table("questions.txt")[::4], *table("descriptions.txt")[::4])] + ["the of of", "where is", "?"]


class Tokens(Lexer):
    """Passes on tokens."""

    __future_interface__ = 1

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, lexer_state: Any, _parser_state: Any) -> Iterator[lark.Token]:
        yield from (lark.Token(token.type, str(token)) for token in lexer_state.text)


@cache
def lark_parser() -> lark.Lark:
    return lark.Lark(GRAMMAR, parser="earley", lexer=Tokens, ambiguity="explicit", start=["description", "question"])


def tree(rule: str, children: list[Any]) -> str:
    return f"{rule}({', '.join(map(str, children))})"


def plain(node: Any) -> str:
    return tree(node.data, [plain(child) for child in node.children]) if hasattr(node, "children") else str(node)


@pytest.mark.full
@pytest.mark.parametrize("start", ["description", "question"])
def test_the_readings_are_those_of_lark(start: str) -> None:
    parser = ChartParser(GRAMMAR)
    parsed = 0
    for text in TEXTS:
        tokens = tokenise(text)
        try:
            expected = sorted(plain(r) for r in CollapseAmbiguities().transform(lark_parser().parse(tokens, start=start)))
        except LarkError:
            expected = []
        parsed += bool(expected)
        assert sorted(parser.readings(tokens, start, tree)) == expected, text
    assert parsed > 20


def readings(grammar: str, kinds: str) -> list[str]:
    return sorted(ChartParser(grammar).readings([Token(kind, kind.lower()) for kind in kinds.split()], "s", tree))


@pytest.mark.parametrize(
    ("rule", "kinds", "expected"),
    [
        ("s: A B", "A B", ["s(a, b)"]),
        ("s: A? B", "B", ["s(b)"]),
        ("s: A* B+", "A A B B", ["s(a, a, b, b)"]),
        ("s: (A | B)+", "A B A", ["s(a, b, a)"]),
        ("s: A -> first\n | B -> second // a comment", "B", ["second(b)"]),
        ("s: _pair B\n_pair: A A", "A A B", ["s(a, a, b)"]),
        ("s: part part\npart: A+", "A A A", ["s(part(a), part(a, a))", "s(part(a, a), part(a))"]),
        ("s: A B", "A", []),
        ("s: A", "", []),
        ("s: A*", "", ["s()"]),
    ],
)
def test_notation(rule: str, kinds: str, expected: list[str]) -> None:
    assert readings(f"{rule}\n%declare A B\n", kinds) == expected


@pytest.mark.parametrize("rule", ["s: A other", "s: (A", "s: A)", "s: A -> x y", "s: ~A"])
def test_faults_of_the_notation_are_errors(rule: str) -> None:
    with pytest.raises(ValueError, match="the rule 's'"):
        ChartParser(f"{rule}\n%declare A\n")
