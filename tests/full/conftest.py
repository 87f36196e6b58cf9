"""The command line's fixtures, for tests that drive the whole program."""

from __future__ import annotations

from tests.cli.conftest import scenes, scope

__all__ = ["scenes", "scope"]
