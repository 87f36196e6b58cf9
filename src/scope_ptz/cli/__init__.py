"""The command line ``scope``. Importing this package is cheap, because each command imports what it needs when it runs."""

from __future__ import annotations

import sys


def main() -> None:
    """Run ``scope``. This is the entry point of the installed program."""
    from scope_ptz.cli.exit import guarded_streams, readable_arguments

    with guarded_streams():
        from scope_ptz.cli.app import app

        sys.argv[1:] = readable_arguments(sys.argv[1:])
        app(prog_name="scope")
