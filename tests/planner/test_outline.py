"""Outlines of plans: loops with their ends and limits, and conditions."""

from __future__ import annotations

import pytest

from scope_ptz.planner.grammar.execution.outline import OutlineBlock, OutlineCall
from scope_ptz.planner.plan import plan


def lines(block: OutlineBlock, depth: int = 0) -> list[str]:
    """Return the outline as indented lines."""
    found = []
    for line in block.lines:
        if isinstance(line, OutlineCall):
            found.append("  " * depth + f"{line.name} {line.arguments}")
        else:
            found += ["  " * depth + line.heading, *lines(line, depth + 1)]
    return found


@pytest.mark.parametrize(
    ("instruction", "expected"),
    [
        ("pan right 20, then tilt down 10", ["adjust_ptz {'pan_deg': 20}", "adjust_ptz {'tilt_deg': -10}"]),
        (
            "pan right in 15 degree steps until you see at least six cones",
            [
                "repeat until at least 6 cones are visible, at most 24 times:",
                "  count_objects {'description': 'cones', 'view': 'current'}",
                "  adjust_ptz {'pan_deg': 15}",
                "if that never happens: stop and report it",
            ],
        ),
        (
            "pan left until you see a bus, at most 3 times",
            [
                "repeat until any buses are visible, at most 3 times:",
                "  count_objects {'description': 'bus', 'view': 'current'}",
                "  adjust_ptz {'pan_deg': -15}",
                "if that never happens: stop and report it",
            ],
        ),
        (
            "if you see a van zoom in on it, otherwise pan left 20",
            [
                "count_objects {'description': 'van', 'view': 'current'}",
                "if any vans are visible:",
                "  zoom_to_object {'description': 'van'}",
                "otherwise:",
                "  adjust_ptz {'pan_deg': -20}",
            ],
        ),
    ],
)
def test_loops_and_conditions_are_shown_as_such(instruction: str, expected: list[str]) -> None:
    assert lines(plan(instruction).outline) == expected


def test_what_is_not_understood_has_no_outline() -> None:
    assert plan("florp the wibble").outline.lines == []


def test_a_long_outline_is_truncated() -> None:
    repeated = plan(" and ".join(["take 2 photos"] * 10)).outline
    assert 0 < len(lines(repeated)) < 50
