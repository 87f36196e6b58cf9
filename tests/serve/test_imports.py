"""Importing the package, or running commands other than the server, imports no server and no database."""

from __future__ import annotations

import subprocess
import sys

HEAVY = ("fastapi", "mcp", "starlette", "uvicorn", "websockets", "sqlalchemy", "sqlite3")


def loaded(code: str) -> set[str]:
    """Return the heavy modules that a program imports."""
    report = f"import sys\n{code}\nprint(*(name for name in {HEAVY!r} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", report], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_the_package_and_the_command_line_import_no_server() -> None:
    assert (
        loaded("import scope_ptz; scope_ptz.open, scope_ptz.Run; import scope_ptz.cli, scope_ptz.cli.app, scope_ptz.cli.ask")
        == set()
    )


def test_a_remote_session_needs_no_server_packages() -> None:
    assert loaded("import scope_ptz.api.remote.session") == set()


def test_tokens_are_created_without_a_server() -> None:
    assert loaded("import scope_ptz.serve.security.tokens") == set()
