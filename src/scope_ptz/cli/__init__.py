"""The command line: ``scope ...``. Importing it costs next to nothing; each command imports what it needs when it runs."""

from __future__ import annotations


def main() -> None:
    """Entry point of ``scope``."""
    from scope_ptz.cli.app import app

    app(prog_name="scope")
