"""Load the published judge prompt from its file.

Never change a published prompt; add a new file instead, because verdicts are comparable only if the judges had the same prompt.
Every judgement records the name of the file and a digest of its text.
"""

from __future__ import annotations

import hashlib
import json
import re
from functools import cache
from importlib.resources import files

from scope_ptz.bench.judging.judge_replies import REPLY_SCHEMA
from scope_ptz.bench.judging.rendering import layout_sample
from scope_ptz.bench.tasks.task import Category

PROMPT = "judge-1"
"""Name of the current prompt, which is also the name of its file."""
_HEADING = re.compile(r"^# (.+)\n", re.MULTILINE)


def system_prompt(category: Category) -> str:
    """Return the system prompt for tasks in a category."""
    parts = _sections()
    rubric = f"For tasks of the category {category}:\n{parts[category]}"
    reply = parts["reply"].replace("{schema}", json.dumps(REPLY_SCHEMA))
    return "\n\n".join((parts["task"], rubric, f"Error modes\n{parts['error modes']}", reply))


def mode_lines() -> list[str]:
    """Return the numbered error modes with their definitions, in order of precedence."""
    return [line for line in _sections()["error modes"].splitlines() if line[:1].isdigit()]


@cache
def prompt_version() -> str:
    """Return the version that judgements record: the prompt's name and a digest of its text, the reply schema and the layout."""
    text = _text() + json.dumps(REPLY_SCHEMA) + layout_sample()
    return f"{PROMPT}:{hashlib.sha256(text.encode()).hexdigest()[:12]}"


@cache
def _text() -> str:
    return (files("scope_ptz.bench.judging") / "prompts" / f"{PROMPT}.md").read_text("utf-8")


@cache
def _sections() -> dict[str, str]:
    parts = _HEADING.split(_text())[1:]
    return {name: body.strip() for name, body in zip(parts[::2], parts[1::2], strict=True)}
