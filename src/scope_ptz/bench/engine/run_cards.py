"""The run card of a log, which records the conditions of its runs."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

from inspect_ai.log import EvalLog
from pydantic import ValidationError

from scope_ptz.agent.trace import Trace
from scope_ptz.bench.scoring.trials import ModelCard, RunCard
from scope_ptz.builtin_names import DETERMINISTIC
from scope_ptz.errors import TraceError

ENGINE = "inspect-ai"
CARD = "card"
SCOPE = "scope"
PRICE = "price_usd_per_million_tokens"
AGENT_SOURCE = "agent_source"
"""Key, among the settings of a run, for the digest of an external agent's source."""


def engine_version() -> str:
    """Return the name and version of the installed engine, in the form that logs record."""
    return f"{ENGINE} {version(ENGINE.replace('-', '_'))}"


def card_of(header: EvalLog, trace: Trace | None) -> RunCard:
    """Return the run card stored in a log. For a log that Inspect's own command wrote, derive it from the header.

    Args:
        header: The header of the log.
        trace: The trace of any run of the log, which describes the planner.

    Raises:
        TraceError: The card is damaged.
    """
    metadata = header.eval.metadata or {}
    try:
        if CARD in metadata:
            return RunCard.model_validate(metadata[CARD])
        return _derived_card(header, metadata[SCOPE], trace.started.planner_details if trace is not None else {})
    except (ValidationError, KeyError) as error:
        raise TraceError(f"The run card of {header.location} is damaged: {error}.") from error


def cost_usd(card: RunCard, input_tokens: int, output_tokens: int) -> float | None:
    """Return the cost of a run's planner tokens; None if no prices were given."""
    price = card.sampling.get(PRICE)
    return (input_tokens * price["input"] + output_tokens * price["output"]) / 1e6 if price else None


def _derived_card(header: EvalLog, facts: Mapping[str, Any], planner: Mapping[str, str]) -> RunCard:
    config = header.eval.config
    known = {name: value for name, value in facts.items() if name != AGENT_SOURCE}
    source = {AGENT_SOURCE: facts[AGENT_SOURCE]} if AGENT_SOURCE in facts else {}
    return RunCard(
        run_id=header.eval.run_id,
        started=str(header.eval.created),
        engine_version=f"{ENGINE} {header.eval.packages.get('inspect_ai', '')}".strip(),
        planner=_model(header, "planner"),
        perception=_model(header, "eyes"),
        epochs=config.epochs or 1,
        prompt_digest=planner.get("prompt_sha256", ""),
        sampling={**planner, **source},
        concurrency=config.max_samples or 1,
        contended=(config.max_samples or 0) != 1,
        **known,
    )


def _model(header: EvalLog, role: str) -> ModelCard:
    bound = (header.eval.model_roles or {}).get(role)
    bound = bound[0] if isinstance(bound, list) else bound
    if bound is None:
        return ModelCard(name="none")
    provider, _, name = bound.model.partition("/")
    own = provider == SCOPE + "_ptz"
    deterministic = own and name in DETERMINISTIC
    return ModelCard(
        name=name or provider,
        registry=name if own and not deterministic else None,
        provider=bound.base_url or provider,
        deterministic=deterministic,
    )
