"""The commands of ``scope bench``, loaded when one of them is used or listed."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

HELP = """Measure planners and perception on 536 tasks.

Start with `scope bench browse` to see tasks, and `scope bench run --split lite` for a first score without any model.
"""


class BenchGroup(TyperGroup):
    """The group of benchmark commands. They are loaded on first use, so that other commands start faster."""

    def list_commands(self, ctx: Any) -> list[str]:
        self._load()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        self._load()
        return super().get_command(ctx, cmd_name)

    def _load(self) -> None:
        if not self.commands:
            import typer

            from scope_ptz.cli.bench.app import bench_app

            group = typer.main.get_group(bench_app)
            self.commands.update(group.commands)
