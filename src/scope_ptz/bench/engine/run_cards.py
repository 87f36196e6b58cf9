"""Read the run card of a log, which records the conditions of an evaluation."""

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
"""Name of the Python package that runs evaluations."""
CARD = "card"
"""Key for the run card in a log's metadata. Logs written by Inspect's own CLI do not have this key."""
METADATA_KEY = "scope"
"""Key for data about the tasks and the agent loop in a log's metadata."""
AGENT_SOURCE = "agent_source"
"""Key for the digest of an external agent's source in a card's ``sampling``."""


def engine_version() -> str:
    """Return the name and version of the installed engine, as recorded in logs."""
    return f"{ENGINE} {version(ENGINE.replace('-', '_'))}"


def card_of(header: EvalLog, trace: Trace | None) -> RunCard:
    """Return the run card of a log. For a log written by Inspect's own CLI, derive the card from the header.

    Args:
        header: The header of the log.
        trace: The trace of any run in the log, which contains the details of the planner; None if there is no trace.

    Raises:
        TraceError: The card is damaged.
    """
    metadata = header.eval.metadata or {}
    try:
        if CARD in metadata:
            return RunCard.model_validate(metadata[CARD])
        return _derive_card(header, metadata[METADATA_KEY], trace.started.planner_details if trace is not None else {})
    except (ValidationError, KeyError) as error:
        raise TraceError(f"The run card in the log {header.location} is damaged: {error}.") from error


def _derive_card(header: EvalLog, facts: Mapping[str, Any], planner: Mapping[str, str]) -> RunCard:
    config = header.eval.config
    fields = {name: value for name, value in facts.items() if name != AGENT_SOURCE}
    source = {AGENT_SOURCE: facts[AGENT_SOURCE]} if AGENT_SOURCE in facts else {}
    return RunCard(
        run_id=header.eval.run_id,
        started=str(header.eval.created),
        engine_version=f"{ENGINE} {header.eval.packages.get('inspect_ai', '')}".strip(),
        planner=_model_card(header, "planner"),
        perception=_model_card(header, "eyes"),
        epochs=config.epochs or 1,
        prompt_digest=planner.get("prompt_sha256", ""),
        sampling={**planner, **source},
        concurrency=config.max_samples or 1,
        contended=(config.max_samples or 0) != 1,
        **fields,
    )


def _model_card(header: EvalLog, role: str) -> ModelCard:
    config = (header.eval.model_roles or {}).get(role)
    config = config[0] if isinstance(config, list) else config
    if config is None:
        return ModelCard(name="none")
    provider, _, name = config.model.partition("/")
    is_scope_model = provider == METADATA_KEY + "_ptz"
    deterministic = is_scope_model and name in DETERMINISTIC
    return ModelCard(
        name=name or provider,
        registry=name if is_scope_model and not deterministic else None,
        provider=config.base_url or provider,
        deterministic=deterministic,
    )
