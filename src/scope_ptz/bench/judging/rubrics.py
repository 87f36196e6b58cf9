"""The published prompt for judges, which is stored in a file.

Put another wording into another file, because verdicts are comparable only under the same prompt. Every judgement records the name
of the file and a digest of its text.
"""

from __future__ import annotations

import hashlib
import json
import re
from functools import cache
from importlib.resources import files

from scope_ptz.bench.judging.judge_replies import REPLY_SCHEMA
from scope_ptz.bench.judging.rendering import specimen
from scope_ptz.bench.tasks.task import Category

PROMPT = "judge-1"
_HEADING = re.compile(r"^# (.+)\n", re.MULTILINE)


def system_prompt(category: Category) -> str:
    """Return the system prompt for runs of a category."""
    parts = _sections()
    rubric = f"For tasks of the category {category}:\n{parts[category]}"
    reply = parts["reply"].replace("{schema}", json.dumps(REPLY_SCHEMA))
    return "\n\n".join((parts["task"], rubric, f"Error modes\n{parts['error modes']}", reply))


def mode_lines() -> list[str]:
    """Return the error modes with their definitions, numbered, in the order of precedence."""
    return [line for line in _sections()["error modes"].splitlines() if line[:1].isdigit()]


@cache
def prompt_version() -> str:
    """Return the name of the prompt and a digest of its text and of the layout of runs, as recorded in judgements."""
    text = _text() + json.dumps(REPLY_SCHEMA) + specimen()
    return f"{PROMPT}:{hashlib.sha256(text.encode()).hexdigest()[:12]}"


@cache
def _text() -> str:
    return (files("scope_ptz.bench.judging") / "prompts" / f"{PROMPT}.md").read_text("utf-8")


@cache
def _sections() -> dict[str, str]:
    pieces = _HEADING.split(_text())[1:]
    return {name: body.strip() for name, body in zip(pieces[::2], pieces[1::2], strict=True)}
