"""The judge's server as the engine's model that plays the role "judge"."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inspect_ai.model import Model

    from scope_ptz.bench.judging.server import JudgeServer


def judge_as_model(judge: JudgeServer, max_requests: int) -> Model:
    """Return the engine's model that plays the role "judge".

    Args:
        judge: The judge's server.
        max_requests: The most requests that run at the same time.
    """
    from inspect_ai.model import GenerateConfig, get_model

    import scope_ptz.factory.inspect_plugin  # noqa: F401 - registers the models of this project

    endpoint = judge.client.endpoint
    config = GenerateConfig(max_connections=max_requests)
    return get_model(f"scope_ptz/{endpoint.model}", base_url=endpoint.url, config=config, memoize=False, served=endpoint.model)
