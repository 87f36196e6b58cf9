"""A Sphinx directive that shows the help text of `scope` commands as the installed program prints it."""

from __future__ import annotations

import os
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

# Typer reads these variables when it is imported. The text then has a fixed width and no colours in every terminal.
os.environ |= {"TERMINAL_WIDTH": "96", "_TYPER_FORCE_DISABLE_TERMINAL": "1", "NO_COLOR": "1"}

from typer.main import get_command
from typer.testing import CliRunner

from scope_ptz.cli.app import app


class CommandHelp(SphinxDirective):
    """``{command-help} scope``: one section per command, including subcommands. Help texts are rendered in the Sphinx process."""

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        self.env.note_reread()
        name, *path = self.arguments[0].split()
        command: Any = get_command(app)
        for step in path:
            command = command.commands[step]
        return [_section(" ".join([name, *words]), words) for words in _walk(command, path)]


def _walk(command: Any, path: list[str]) -> list[list[str]]:
    """Return the words of a command and of all commands below it, in the order of the help."""
    if not hasattr(command, "list_commands"):
        return [path]
    context = command.make_context(" ".join(["scope", *path]), [], resilient_parsing=True)
    children = {name: command.get_command(context, name) for name in command.list_commands(context)}
    return [path, *(words for name, child in children.items() for words in _walk(child, [*path, name]))]


def _section(title: str, words: list[str]) -> nodes.section:
    text = help_text(words)
    section = nodes.section(ids=[nodes.make_id(title)], names=[title])
    section += nodes.title(text=title)
    section += nodes.literal_block(text, text, language="none")
    return section


def help_text(words: list[str]) -> str:
    """Return what ``scope WORDS... --help`` prints."""
    result = CliRunner().invoke(app, [*words, "--help"], prog_name="scope", catch_exceptions=False)
    if result.exit_code != 0:
        raise RuntimeError(f"`scope {' '.join(words)} --help` exited with code {result.exit_code}: {result.output}")
    return "\n".join(line.rstrip() for line in result.output.strip("\n").splitlines())


def setup(app_: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app_.add_directive("command-help", CommandHelp)
    return {"parallel_read_safe": True}
