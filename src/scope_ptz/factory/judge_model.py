"""A judge's server as the model that plays the role "judge"."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from inspect_ai.model import Model

    from scope_ptz.bench.judging.server import ServerPort


def judge_as_model(judge: ServerPort, at_a_time: int) -> Model:
    """The model of the engine that stands for a judge; ``at_a_time``: requests to it."""
    from inspect_ai.model import GenerateConfig, get_model

    import scope_ptz.factory.inspect_plugin  # noqa: F401 - makes the models of this project known

    endpoint = judge.client.endpoint
    config = GenerateConfig(max_connections=at_a_time)
    return get_model(f"scope_ptz/{endpoint.model}", base_url=endpoint.url, config=config, memoize=False, served=endpoint.model)
