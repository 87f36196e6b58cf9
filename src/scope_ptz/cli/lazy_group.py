"""Command groups that are loaded when one of their commands is used or listed, so that other commands start fast."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from typer.core import TyperGroup


class LazyGroup(TyperGroup):
    """A command group with the commands of a Typer app in another module. Subclasses set ``module`` and ``attribute``."""

    module = ""
    """Name of the module to import."""
    attribute = ""
    """Name of the Typer app in that module."""

    def list_commands(self, ctx: Any) -> list[str]:
        self._load()
        return super().list_commands(ctx)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        self._load()
        return super().get_command(ctx, cmd_name)

    def _load(self) -> None:
        if not self.commands:
            import typer

            group = typer.main.get_group(getattr(import_module(self.module), self.attribute))
            self.commands.update(group.commands)
