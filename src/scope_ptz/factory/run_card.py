"""Create run cards, which record the models and settings of evaluations."""

from __future__ import annotations

import platform
import uuid
from datetime import UTC, datetime
from typing import Any

import anyio

from scope_ptz.bench.agents.channel import Isolation
from scope_ptz.bench.engine.entries import Entry, datasets, digest
from scope_ptz.bench.engine.estimate import Price
from scope_ptz.bench.engine.run_cards import AGENT_SOURCE, engine_version
from scope_ptz.bench.engine.token_costs import PRICE_KEY
from scope_ptz.bench.scoring.trials import ModelCard, RunCard
from scope_ptz.builtin_names import DETERMINISTIC
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.factory.models import ResolvedPair, ResolvedPerception, ResolvedPlanner
from scope_ptz.planner.base import Planner
from scope_ptz.version import __version__

SERVER_QUERY_TIMEOUT_S = 10.0
"""Timeout in seconds for querying a server's configuration. Some servers do not respond."""


async def run_card(
    resolved: ResolvedPair,
    planner: Planner | None,
    entries: tuple[Entry, ...],
    *,
    agent: str,
    agent_source: str,
    isolation: Isolation | None,
    concurrency: int,
    contended: bool,
    variant: str,
    price: Price | None,
    **fields: Any,
) -> RunCard:
    """Create the run card for an evaluation that is about to start.

    Args:
        resolved: The resolved planner and perception backend.
        planner: The planner, whose prompt and sampling settings are recorded; None for an external agent.
        entries: The tasks.
        agent: Name of the agent.
        agent_source: Digest of an external agent's source code; empty for the built-in agent loop.
        isolation: How an external agent is isolated from tasks, ground truth and checks; None for the built-in agent loop.
        concurrency: Number of concurrent runs.
        contended: Whether concurrent runs may increase the latencies.
        variant: Label of the evaluation.
        price: Price of the planner's tokens.
        **fields: Additional fields for the card, such as split, seed and epochs.
    """
    details = planner.details if planner is not None else {}
    spec = resolved.perception.spec
    sampling: dict[str, Any] = {"planner": details}
    if agent_source:
        sampling[AGENT_SOURCE] = agent_source
    if price is not None:
        sampling[PRICE_KEY] = {"input": price.input_usd, "output": price.output_usd}
    if spec is not None:
        sampling["perception"] = {"backend": spec.backend, "coordinates": spec.coordinates, **_json_values(spec.options)}
    return RunCard(
        run_id=uuid.uuid4().hex,
        started=datetime.now(UTC).isoformat(timespec="seconds"),
        package_version=__version__,
        engine_version=engine_version(),
        dataset=datasets(entries),
        dataset_digest=digest(entries),
        planner=await _planner_card(resolved.planner) if planner is not None else ModelCard(name=agent),
        perception=await _perception_card(resolved.perception),
        agent=agent,
        isolation=isolation,
        variant=variant,
        sampling=sampling,
        prompt_digest=details.get("prompt_sha256", ""),
        concurrency=concurrency,
        contended=contended,
        host=f"{platform.machine()} {platform.system()}, Python {platform.python_version()}",
        **fields,
    )


async def _planner_card(resolved: ResolvedPlanner) -> ModelCard:
    return await _model_card(resolved.name, resolved.model.name if resolved.model else None, resolved.endpoint)


async def _perception_card(resolved: ResolvedPerception) -> ModelCard:
    card = await _model_card(
        resolved.name, resolved.model.name if resolved.model else None, resolved.spec.endpoint if resolved.spec else None
    )
    return card if resolved.spec is None or card.provider else card.model_copy(update={"provider": resolved.spec.backend})


async def _model_card(name: str, registered: str | None, endpoint: Endpoint | None) -> ModelCard:
    if endpoint is None:
        return ModelCard(name=name, registry=registered, deterministic=name in DETERMINISTIC)
    from scope_ptz.endpoints.serving_facts import serving_facts

    reported: dict[str, str] = {}
    with anyio.move_on_after(SERVER_QUERY_TIMEOUT_S):
        reported = await serving_facts(endpoint)
    served = {"model": endpoint.model} if endpoint.model else {}
    return ModelCard(name=name, registry=registered, provider=endpoint.url, reported=served | reported)


def _json_values(options: dict[str, Any]) -> dict[str, Any]:
    """Convert options to JSON values. Objects are replaced with their names."""
    return {
        name: value if isinstance(value, str | int | float | bool) else str(getattr(value, "name", value))
        for name, value in options.items()
    }
