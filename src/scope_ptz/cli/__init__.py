"""The command line ``scope``. Importing this package is cheap, because each command imports what it needs when it runs."""

from __future__ import annotations

import os
import sys


def main() -> None:
    """Run ``scope``. This is the entry point of the installed program."""
    from scope_ptz.cli.exit import decode_arguments, safe_streams
    from scope_ptz.cli.startup import pause_garbage_collection, prepare_help

    # Disable pydantic's plug-ins: the command line uses none, and searching for them reads the metadata of every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    with safe_streams():
        with pause_garbage_collection():
            from scope_ptz.cli.app import app

            sys.argv[1:] = decode_arguments(sys.argv[1:])
            prepare_help(sys.argv[1:])
        app(prog_name="scope")
