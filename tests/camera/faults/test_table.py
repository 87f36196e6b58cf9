"""The table of faults in the documentation names tests that exist, and that run for both drivers."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

HERE = Path(__file__).parent
PAGE = (HERE.parents[2] / "docs" / "camera-faults.md").read_text(encoding="utf-8")
NAMED = re.findall(r"^\|.*`(test_\w+\.py)::(test_\w+)` \|$", PAGE, flags=re.MULTILINE)
ROWS = [line for line in PAGE.splitlines() if re.match(r"\| (?!-|fault|event)", line) and "test" in line]

FAULTS = (
    "unreachable at the start", "unreachable during a move", "unreachable during a sweep", "slow", "wrong password", "rebooted",
    "truncated", "frozen", "black", "another size", "the camera never reaches the position", "preset deleted during",
    "two controllers", "clock skew", "network partition", "1,000",
)  # fmt: skip
"""The faults that the drivers promise to survive."""


def test_every_row_names_a_test() -> None:
    assert len(NAMED) == len(ROWS) > 30


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_has_a_row(fault: str) -> None:
    assert any(fault in row for row in ROWS)


@pytest.mark.parametrize(("file", "name"), NAMED, ids=lambda part: part)
def test_the_test_of_a_row_runs_for_both_drivers(file: str, name: str) -> None:
    tree = ast.parse((HERE / file).read_text(encoding="utf-8"))
    functions = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}
    assert name in functions, f"docs/camera-faults.md names {file}::{name}, which does not exist"
    assert "driver" in [argument.arg for argument in functions[name].args.args]
