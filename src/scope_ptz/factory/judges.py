"""Connect to the judge's server, as specified by options or environment variables."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import ConfigError, InputError, ScopeError
from scope_ptz.factory.option_values import parse_options

if TYPE_CHECKING:
    from scope_ptz.bench.judging.server import JudgeServer
    from scope_ptz.endpoints.endpoint import Endpoint

TIMEOUT_S = 300.0
"""Default timeout in seconds for a judgement, including retries."""

_LOG = logging.getLogger(__name__)


class UnnamedJudgeError(ScopeError):
    """A judge's server did not report its model, and no option names the judge."""

    def __init__(self, url: str, reason: str) -> None:
        super().__init__(
            f"The judge's server at {url} did not report the name of its model, so nothing was judged: {reason} "
            "Specify the model with --judge-model or SCOPE_JUDGE_MODEL."
        )


async def open_judge(
    url: str | None, model: str | None, key_file: Path | None, timeout_s: float, options: Iterable[str] | None = None
) -> JudgeServer:
    """Connect to a judge's server. The caller closes the connection.

    Args:
        url: URL of the server; None to use ``SCOPE_JUDGE_URL``.
        model: The judge's served name; None to use ``SCOPE_JUDGE_MODEL`` or, if that is not set, the server's model list.
        key_file: File that contains the server's API key; None to use the key in ``SCOPE_JUDGE_KEY``.
        timeout_s: Timeout in seconds for a judgement, including retries.
        options: ``NAME=VALUE`` options for the judge.

    Returns:
        The connection. ``client.endpoint.model`` is the judge's name.

    Raises:
        InputError: No server is specified, an option is invalid, or the server serves several models but not the default judge.
        UnnamedJudgeError: No model is specified, and the server does not report one.
    """
    from pydantic import ValidationError

    from scope_ptz.bench.judging.server import JudgeModelOptions, JudgeServer
    from scope_ptz.endpoints.endpoint import Endpoint, Timeouts, key_from_file
    from scope_ptz.settings import load_settings

    settings = load_settings()
    address = url or settings.judge_url
    if not address:
        raise ConfigError("The judge requires a server. Specify its URL with --judge-url or SCOPE_JUDGE_URL.")
    key = key_from_file(key_file) if key_file else settings.judge_key
    try:
        judge_options = JudgeModelOptions.model_validate(parse_options(options or (), "--judge-option"))
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        path = ".".join(str(part) for part in first["loc"])
        raise ConfigError(
            f"--judge-option {path}: {first['msg']}. Known options: {', '.join(JudgeModelOptions.model_fields)}."
        ) from None
    endpoint = Endpoint(url=address, key=key, timeouts=Timeouts.within(timeout_s))
    return JudgeServer(await _with_judge_name(endpoint, model or settings.judge_model), judge_options)


async def _with_judge_name(endpoint: Endpoint, name: str) -> Endpoint:
    """Return the endpoint with the judge's served name."""
    from scope_ptz.bench.judging.judge import DEFAULT_JUDGE
    from scope_ptz.endpoints.catalogue import find_api
    from scope_ptz.endpoints.failures import ServerFailure

    if name:
        return endpoint.model_copy(update={"model": name})
    try:
        endpoint, served = await find_api(endpoint)
    except ServerFailure as failure:  # do not guess the name, because that could permanently mix two judges' judgements
        raise UnnamedJudgeError(endpoint.url, str(failure)) from None
    if not served:
        raise UnnamedJudgeError(endpoint.url, "its model list is empty.")
    defaults = [name for name in served if DEFAULT_JUDGE in name.lower()]
    if not defaults and len(served) > 1:
        names = ", ".join(served[:20])
        raise InputError(
            f"The server at {endpoint.url} serves several models, but not {DEFAULT_JUDGE}. Choose one with --judge-model: {names}."
        )
    if not defaults:
        _LOG.warning(
            "note: the server at %s serves '%s', which is used as the judge instead of %s.", endpoint.url, served[0], DEFAULT_JUDGE
        )
    return endpoint.model_copy(update={"model": (defaults or served)[0]})
