"""The ``scope bench`` commands, which are loaded when one of them is used or listed."""

from __future__ import annotations

from scope_ptz.cli.lazy_group import LazyGroup

HELP = """Measure planners and perception on 536 tasks.

Start with `scope bench browse` to see tasks, and `scope bench run --split lite` for a first score without any model.
"""


class BenchGroup(LazyGroup):
    """The group of benchmark commands."""

    module = "scope_ptz.cli.bench.app"
    attribute = "bench_app"
