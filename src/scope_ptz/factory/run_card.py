"""The run card of an evaluation that begins: who plans and who sees, as registry and servers tell it."""

from __future__ import annotations

import platform
import uuid
from datetime import UTC, datetime
from typing import Any

import anyio

from scope_ptz.bench.engine.entries import Entry, datasets, digest
from scope_ptz.bench.engine.estimate import Price
from scope_ptz.bench.engine.run_cards import AGENT_SOURCE, PRICE, engine_version
from scope_ptz.bench.scoring.trials import ModelCard, RunCard
from scope_ptz.builtin_names import DETERMINISTIC
from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.factory.models import ResolvedPair, ResolvedPerception, ResolvedPlanner
from scope_ptz.planner.base import Planner
from scope_ptz.version import __version__

PATIENCE_S = 10.0
"""For servers that do not say how they were set up."""


async def run_card(
    choice: ResolvedPair,
    planner: Planner | None,
    entries: tuple[Entry, ...],
    *,
    agent: str,
    agent_source: str,
    concurrency: int,
    contended: bool,
    variant: str,
    price: Price | None,
    **facts: Any,
) -> RunCard:
    """The card. ``planner``: for its exact prompt and sampling; None for other agents, which have ``agent_source``, the digest of
    their code; ``facts``: split, seed, epochs, ..."""
    details = planner.details if planner is not None else {}
    spec = choice.perception.spec
    sampling: dict[str, Any] = {"planner": details}
    if agent_source:
        sampling[AGENT_SOURCE] = agent_source
    if price is not None:
        sampling[PRICE] = {"input": price.input_usd, "output": price.output_usd}
    if spec is not None:
        sampling["perception"] = {"backend": spec.backend, "coordinates": spec.coordinates, **_plain(spec.options)}
    return RunCard(
        run_id=uuid.uuid4().hex,
        started=datetime.now(UTC).isoformat(timespec="seconds"),
        package_version=__version__,
        engine_version=engine_version(),
        dataset=datasets(entries),
        dataset_digest=digest(entries),
        planner=await _planner_card(choice.planner) if planner is not None else ModelCard(name=agent),
        perception=await _eyes_card(choice.perception),
        agent=agent,
        variant=variant,
        sampling=sampling,
        prompt_digest=details.get("prompt_sha256", ""),
        concurrency=concurrency,
        contended=contended,
        host=f"{platform.machine()} {platform.system()}, Python {platform.python_version()}",
        **facts,
    )


async def _planner_card(choice: ResolvedPlanner) -> ModelCard:
    return await _card(choice.name, choice.model.name if choice.model else None, choice.endpoint)


async def _eyes_card(choice: ResolvedPerception) -> ModelCard:
    card = await _card(choice.name, choice.model.name if choice.model else None, choice.spec.endpoint if choice.spec else None)
    return card if choice.spec is None or card.provider else card.model_copy(update={"provider": choice.spec.backend})


async def _card(name: str, registered: str | None, endpoint: Endpoint | None) -> ModelCard:
    if endpoint is None:
        return ModelCard(name=name, registry=registered, deterministic=name in DETERMINISTIC)
    from scope_ptz.endpoints.serving_facts import serving_facts

    reported: dict[str, str] = {}
    with anyio.move_on_after(PATIENCE_S):
        reported = await serving_facts(endpoint)
    served = {"model": endpoint.model} if endpoint.model else {}
    return ModelCard(name=name, registry=registered, provider=endpoint.url, reported=served | reported)


def _plain(options: dict[str, Any]) -> dict[str, Any]:
    """Return options as plain values for a card. A perception option that is an object is replaced by its name."""
    return {
        name: value if isinstance(value, str | int | float | bool) else str(getattr(value, "name", value))
        for name, value in options.items()
    }
