"""The ``scope runs`` commands, which are loaded when one of them is used or listed."""

from __future__ import annotations

from scope_ptz.cli.lazy_group import LazyGroup

HELP = """Stored runs: list, show, index, export and prune them; list audit logs.

Runs are stored in the runs folder (SCOPE_RUNS_DIR, or --runs-dir). Its file `store.sqlite` is an index that can be rebuilt.
"""


class RunsGroup(LazyGroup):
    """The group of run commands."""

    module = "scope_ptz.cli.runs.app"
    attribute = "runs_app"
