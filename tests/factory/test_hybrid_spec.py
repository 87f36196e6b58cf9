"""The spec ``hybrid:MODEL``."""

from __future__ import annotations

import pytest

from scope_ptz.errors import ConfigError, InputError, UnknownNameError
from scope_ptz.factory.models import ModelOptions, make_planner, resolve_models
from scope_ptz.planner.chat import ChatPlanner
from scope_ptz.planner.hybrid import HybridPlanner
from tests.support.misbehaving import MODEL, Misbehaving, good

pytestmark = pytest.mark.anyio


async def test_a_served_model_behind_the_grammar() -> None:
    with Misbehaving(then=good()) as server:
        pair = await resolve_models(ModelOptions(planner="hybrid:chat", planner_url=server.url))
    planner = make_planner(pair.planner)
    assert isinstance(planner, HybridPlanner) and isinstance(planner.model, ChatPlanner)
    assert planner.name == pair.planner.name == f"hybrid:{MODEL}"
    assert pair.planner.endpoint is not None
    await planner.close()


async def test_a_registered_model_in_a_pair() -> None:
    with Misbehaving(then=good()) as server:
        pair = await resolve_models(ModelOptions(pair="hybrid:qwen3-4b+ground-truth", planner_url=server.url))
    assert (pair.planner.name, pair.planner.is_hybrid, pair.perception.name) == ("hybrid:qwen3-4b", True, "ground-truth")


@pytest.mark.parametrize("name", ["hybrid:", "hybrid:grammar", "hybrid:hybrid:chat"])
async def test_the_spec_must_name_a_model(name: str) -> None:
    with pytest.raises(InputError, match="does not name a language model"):
        await resolve_models(ModelOptions(planner=name))


async def test_the_model_needs_a_server() -> None:
    with pytest.raises(ConfigError, match="--planner-url"):
        await resolve_models(ModelOptions(planner="hybrid:chat"))


async def test_an_unknown_model() -> None:
    with pytest.raises(UnknownNameError, match="no-such-model"):
        await resolve_models(ModelOptions(planner="hybrid:no-such-model"))
