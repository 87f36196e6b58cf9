"""Parsing with predictions limited to the next token finds exactly the readings that Lark finds without this limit."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from typing import Any

import pytest
from lark import Lark, Token
from lark.exceptions import LarkError
from lark.lexer import Lexer
from lark.visitors import CollapseAmbiguities

from scope_ptz.perception.ground_truth import language
from scope_ptz.perception.ground_truth.language.earley import EarleyGrammar, readings
from scope_ptz.perception.ground_truth.language.tokeniser import tokenise
from tests.perception.test_language import table

GRAMMAR = files(language).joinpath("grammar.lark").read_text("utf-8")
TEXTS = [text for text, _ in (*table("questions.txt")[::4], *table("descriptions.txt")[::4])] + ["the of of", "where is", "?"]


class Tokens(Lexer):
    """Passes on tokens."""

    __future_interface__ = 1

    def __init__(self, lexer_conf: Any) -> None:
        pass

    def lex(self, lexer_state: Any, _parser_state: Any) -> Iterator[Token]:
        yield from lexer_state.text


@cache
def grammars() -> tuple[Lark, EarleyGrammar]:
    starts = ["description", "question"]
    return Lark(GRAMMAR, parser="earley", lexer=Tokens, ambiguity="explicit", start=starts), EarleyGrammar(GRAMMAR, starts)


def tree(rule: str, children: list[Any]) -> str:
    return f"{rule}({', '.join(map(str, children))})"


def plain(node: Any) -> str:
    return tree(node.data, [plain(child) for child in node.children]) if hasattr(node, "children") else str(node)


@pytest.mark.full
@pytest.mark.parametrize("start", ["description", "question"])
def test_the_readings_are_those_of_lark(start: str) -> None:
    lark, ours = grammars()
    parsed = 0
    for text in TEXTS:
        tokens = tokenise(text)
        try:
            expected = sorted(plain(reading) for reading in CollapseAmbiguities().transform(lark.parse(tokens, start=start)))
        except LarkError:
            with pytest.raises(LarkError):
                ours.parse(tokens, start)
            continue
        parsed += 1
        assert sorted(readings(ours.parse(tokens, start), tree)) == expected, text
    assert parsed > 20
