"""The programs of docs/gymnasium.md run one after another and print what the page shows."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

import scope_ptz.gym as scope_gym

PAGE = (Path(__file__).parents[2] / "docs" / "gymnasium.md").read_text("utf-8")


PROGRAMS = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.usefixtures("shipped")
def test_the_first_program_prints_what_the_page_shows(capsys: pytest.CaptureFixture[str]) -> None:
    (shown,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    run([PROGRAMS[0]])
    assert capsys.readouterr().out == shown


@pytest.mark.full
def test_all_programs_of_the_page_run() -> None:
    assert len(PROGRAMS) == 3
    run(PROGRAMS)


def run(programs: list[str]) -> None:
    """Run programs one after another, as in one notebook, and close the environments that they leave open."""
    names: dict[str, Any] = {}
    for program in programs:
        exec(program, names)  # noqa: S102 - text of the documentation
        if (env := names.pop("env", None)) is not None:
            env.close()


def test_the_page_names_every_environment() -> None:
    assert set(re.findall(r"`(scope_ptz/[\w-]+)`", PAGE)) == set(scope_gym.ENVIRONMENTS)
