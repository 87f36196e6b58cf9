"""The options that name a judge."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scope_ptz.factory.judges import TIMEOUT_S

__all__ = ["TIMEOUT_S", "JudgeKey", "JudgeModel", "JudgeOption", "JudgeTimeout", "JudgeUrl"]

_PANEL = "Judge"
JudgeUrl = Annotated[
    str | None,
    typer.Option("--judge-url", help="Address of the judge's server, with its /v1 (or SCOPE_JUDGE_URL).", rich_help_panel=_PANEL),
]
JudgeModel = Annotated[
    str | None,
    typer.Option(
        "--judge-model",
        help="What the server calls the judge (or SCOPE_JUDGE_MODEL; default: gpt-oss-120b, else its only model).",
        rich_help_panel=_PANEL,
    ),
]
JudgeKey = Annotated[
    Path | None,
    typer.Option("--judge-key-file", help="File with the key of the judge's server (or SCOPE_JUDGE_KEY).", rich_help_panel=_PANEL),
]
JudgeTimeout = Annotated[
    float, typer.Option("--judge-timeout", min=0.1, help="Seconds for a judgement, retries included.", rich_help_panel=_PANEL)
]
JudgeOption = Annotated[
    list[str] | None,
    typer.Option(
        "--judge-option", metavar="NAME=VALUE", help="temperature=0, seed=1, reasoning_effort=high, ...", rich_help_panel=_PANEL
    ),
]
