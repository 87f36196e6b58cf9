"""Run an evaluation from its options to its log, without a console.

The command line and the Python interface call ``evaluate``; both watch it through an ``EvaluationProgress``.
"""

from __future__ import annotations

import anyio

from scope_ptz.errors import ConfigError
from scope_ptz.factory.evaluation_options import (
    DEFAULT_LOG_FOLDER,
    OWN_AGENT,
    EvaluationOptions,
    EvaluationPlan,
    EvaluationProgress,
    EvaluationResult,
    JudgeSettings,
)
from scope_ptz.factory.models import resolve_models

__all__ = [
    "DEFAULT_LOG_FOLDER", "OWN_AGENT", "EvaluationOptions", "EvaluationPlan", "EvaluationProgress", "EvaluationResult",
    "JudgeSettings", "evaluate", "require_engine",
]  # fmt: skip


def require_engine() -> None:
    """Raise ``ConfigError`` when the evaluation engine is not installed."""
    from importlib.util import find_spec

    if find_spec("inspect_ai") is None:
        raise ConfigError("Evaluations need Inspect AI. Install it with: pip install 'scope-ptz[bench]'")


async def evaluate(options: EvaluationOptions, *, progress: EvaluationProgress | None = None) -> EvaluationResult:
    """Run an evaluation, resume an interrupted one, or read one that is complete; then ask for missing judgements.

    Args:
        options: What to evaluate.
        progress: Receives notes, the estimate, and every run that begins and ends.

    Returns:
        The evaluation in the log, and the outcome of the judgements. Runs that failed because of infrastructure are
        among its trials; the same call repeats them.

    Raises:
        ConfigError: The evaluation engine is not installed, or models are not configured.
        InputError: Options contradict each other or name something unknown.
        OutputError: The log folder cannot be written.
        ScopeError: Too many consecutive runs failed because of infrastructure.
    """
    require_engine()
    from scope_ptz.bench.engine.runs import exclusive
    from scope_ptz.factory.evaluation_session import EvaluationSession

    pair = await resolve_models(options.models)
    session = EvaluationSession(options, pair, progress or EvaluationProgress())
    with exclusive(options.out, session.identity):
        stored = await session.stored_logs()
        try:
            if stored and stored[0].finished:
                session.progress.note(f"this evaluation is complete: {stored[0].path} (--fresh runs it again)")
                return await session.with_judgements(stored[0].path, retry_failed=True)
            log = await session.run(stored)
            return await session.with_judgements(log, retry_failed=False)
        finally:
            with anyio.CancelScope(shield=True):
                await session.close()
