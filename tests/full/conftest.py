"""Fixtures of the command line, for tests of the whole program."""

from __future__ import annotations

from tests.cli.conftest import scenes, scope

__all__ = ["scenes", "scope"]
