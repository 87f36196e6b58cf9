"""The tables of ``scope bench sweep`` fit in terminals of every width."""

from __future__ import annotations

import io
from collections import Counter

import pytest
from rich.console import Console
from rich.table import Table

from scope_ptz.bench.engine.run_totals import CATEGORIES
from scope_ptz.bench.scoring.trials import Evaluation
from scope_ptz.cli.bench.run import sweep_tables
from tests.bench.reports.sample_evaluations import evaluation, facts

TASKS = facts(2)
NOT_INSTALLED = "This feature needs torch. Install with: pip install 'scope-ptz[local]'"
UNLIMITED_WIDTH = 10_000


def sample_results(planner: str) -> dict[str, Evaluation | str]:
    """Return results that yield all four tables."""
    return {
        f"{planner}+moondream2-4bit": evaluation(planner, "moondream2-4bit", TASKS, 0.6, epochs=7, broken_share=0.1),
        "qwen3-4b+moondream2": evaluation("qwen3-4b", "moondream2", TASKS, 0.3, broken_share=0.2),
        "grammar+ground-truth": evaluation("grammar", "ground-truth", TASKS, 1.2, broken_share=0.0),
        "qwen3-4b+locate": NOT_INSTALLED,
    }


SHORT_NAMES, LONG_NAME = sample_results("qwen3-next-80b-a3b"), sample_results("qwen3-next-80b-a3b-instruct-my-own-finetune")


def printed(table: Table, width: int) -> str:
    console = Console(width=width, file=io.StringIO(), record=True)
    console.print(table)
    return console.export_text()


def tables(results: dict[str, Evaluation | str], width: int) -> list[Table]:
    return list(sweep_tables(results, Console(width=width)))


def characters(text: str) -> Counter[str]:
    """Count the characters except white space, because wrapping moves words and changes nothing else."""
    return Counter("".join(text.split()))


@pytest.mark.parametrize("results", [SHORT_NAMES, LONG_NAME], ids=["short names", "long name"])
def test_no_cell_is_cut(results: dict[str, Evaluation | str]) -> None:
    for width in range(60, 221):
        shown = tables(results, width)
        assert len(shown) == 4
        for table in shown:
            text = printed(table, width)
            assert "…" not in text
            assert characters(text) == characters(printed(table, UNLIMITED_WIDTH)), f"{width} columns:\n{text}"


def test_categories_are_shown_where_they_fit() -> None:
    layouts = []
    for width in range(60, 221):
        table = tables(SHORT_NAMES, width)[0]
        headers = [str(column.header) for column in table.columns]
        assert headers[:3] == ["pair", "macro", "micro"] and headers[-2:] == ["runs", "failed"]
        categories = headers[3:-2]
        assert not categories or [header.split() for header in categories] == [name.split("_") for name in CATEGORIES]
        layouts.append("none" if not categories else "two lines" if any("\n" in header for header in categories) else "one line")
    assert list(dict.fromkeys(layouts)) == ["none", "two lines", "one line"]
    assert layouts == sorted(layouts, key=["none", "two lines", "one line"].index)


def test_pair_names_are_wrapped_only_in_narrow_terminals() -> None:
    name = next(iter(SHORT_NAMES))
    assert name not in printed(tables(SHORT_NAMES, 60)[0], 60)
    for width in (70, 80, 160, 220):
        assert name in printed(tables(SHORT_NAMES, width)[0], width)


def test_reasons_are_printed_as_plain_text() -> None:
    assert NOT_INSTALLED in printed(tables(SHORT_NAMES, 160)[3], 160)
