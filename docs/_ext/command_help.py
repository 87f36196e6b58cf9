"""A Sphinx directive that shows the help text of `scope` commands as the installed program prints it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

WIDTH = "100"
_COMMANDS = re.compile(r"^[│|] (?P<name>[a-z][a-z-]*) ", flags=re.MULTILINE)


class CommandHelp(SphinxDirective):
    """``{command-help} scope``: one section per command, sub-commands included."""

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar = {}

    def run(self) -> list[nodes.Node]:
        return list(self._sections(self.arguments[0].split()))

    def _sections(self, command: list[str]) -> list[nodes.Node]:
        text = _help(command[1:])
        title = " ".join(command)
        section = nodes.section(ids=[nodes.make_id(title)], names=[title])
        section += nodes.title(text=title)
        section += nodes.literal_block(text, text, language="none")
        found = [section]
        panels = text.split("Options ─")[-1]
        for name in _COMMANDS.findall(panels):
            found += self._sections([*command, name])
        return found


def _help(arguments: list[str]) -> str:
    environment = os.environ | {"COLUMNS": WIDTH, "TERM": "dumb", "NO_COLOR": "1", "TERMINAL_WIDTH": WIDTH}
    done = subprocess.run(
        [sys.executable, "-m", "scope_ptz.cli", *arguments, "--help"], env=environment, capture_output=True, text=True, check=True
    )
    return "\n".join(line.rstrip() for line in done.stdout.strip("\n").splitlines())


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command-help", CommandHelp)
    return {"parallel_read_safe": True}
