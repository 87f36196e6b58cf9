"""The options by which commands are given a judge, and how they get it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import complain
from scope_ptz.errors import InputError, ScopeError

if TYPE_CHECKING:
    from scope_ptz.bench.judging.server import ServerPort
    from scope_ptz.endpoints.endpoint import Endpoint

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
TIMEOUT_S = 300.0


class UnnamedJudgeError(ScopeError):
    """A judge's server does not say what it serves, and nobody else has said who the judge is."""

    def __init__(self, url: str, why: str) -> None:
        super().__init__(
            f"The judge's server at {url} cannot be asked for its model's name, so nothing was judged: {why} "
            "A server that has no list of models needs --judge-model (or SCOPE_JUDGE_MODEL)."
        )


async def open_judge(
    url: str | None, model: str | None, key_file: Path | None, timeout_s: float, options: list[str] | None = None
) -> ServerPort:
    """The port to a judge, by options and environment. ``client.endpoint.model`` is its name. Close it in the end.

    Raises ``InputError`` when no server is named, or it serves several models and none of them is known; ``UnnamedJudgeError`` when
    no name is given and its server cannot be asked for one.
    """
    from pydantic import ValidationError

    from scope_ptz.bench.judging.server import JudgeOptions, ServerPort
    from scope_ptz.endpoints.endpoint import Endpoint, Timeouts, key_from_file
    from scope_ptz.errors import ConfigError
    from scope_ptz.factory.models import parse_options
    from scope_ptz.settings import load_settings

    settings = load_settings()
    address = url or settings.judge_url
    if not address:
        raise ConfigError("No judge's server is named. Give its address with --judge-url or SCOPE_JUDGE_URL.")
    key = key_from_file(key_file) if key_file else settings.judge_key
    try:
        given = JudgeOptions.model_validate(parse_options(options or (), "--judge-option"))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"--judge-option {where}: {first['msg']}. Known: {', '.join(JudgeOptions.model_fields)}.") from None
    endpoint = Endpoint(url=address, key=key, timeouts=Timeouts.within(timeout_s))
    return ServerPort(await _named(endpoint, model or settings.judge_model), given)


async def _named(endpoint: Endpoint, wanted: str) -> Endpoint:
    """The endpoint with the name under which its server serves the judge."""
    from scope_ptz.bench.judging.judge import DEFAULT_JUDGE
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if wanted:
        return endpoint.model_copy(update={"model": wanted})
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure as failure:  # No name is invented: judgements under it would stand beside the judge's own for good.
        raise UnnamedJudgeError(endpoint.url, str(failure)) from None
    if not served:
        raise UnnamedJudgeError(endpoint.url, "its list of models is empty.")
    usual = [name for name in served if DEFAULT_JUDGE in name.lower()]
    if not usual and len(served) > 1:
        names = ", ".join(served[:20])
        raise InputError(
            f"The server at {endpoint.url} serves several models and no {DEFAULT_JUDGE}. Name one with --judge-model: {names}."
        )
    if not usual:
        complain(f"note: the server at {endpoint.url} serves '{served[0]}'; it judges in place of {DEFAULT_JUDGE}.")
    return endpoint.model_copy(update={"model": (usual or served)[0]})
