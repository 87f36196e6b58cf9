"""Run an evaluation and write its log, independently of any user interface.

The command line and the Python API call ``evaluate``, and receive its progress through an ``EvaluationProgress``.
"""

from __future__ import annotations

import anyio

from scope_ptz.errors import ConfigError
from scope_ptz.factory.evaluation_options import (
    BUILT_IN_AGENT,
    DEFAULT_LOG_FOLDER,
    EvaluationOptions,
    EvaluationPlan,
    EvaluationProgress,
    EvaluationResult,
    JudgeSettings,
)
from scope_ptz.factory.models import resolve_models

__all__ = [
    "BUILT_IN_AGENT",
    "DEFAULT_LOG_FOLDER",
    "EvaluationOptions",
    "EvaluationPlan",
    "EvaluationProgress",
    "EvaluationResult",
    "JudgeSettings",
    "evaluate",
    "require_engine",
]  # fmt: skip


def require_engine() -> None:
    """Raise ``ConfigError`` if the evaluation engine is not installed."""
    from importlib.util import find_spec

    if find_spec("inspect_ai") is None:
        raise ConfigError("Evaluations require Inspect AI. Install it with: pip install 'scope-ptz[bench]'")


async def evaluate(options: EvaluationOptions, *, progress: EvaluationProgress | None = None) -> EvaluationResult:
    """Run an evaluation, resume an interrupted one, or read a completed one; then request missing judgements.

    Args:
        options: The tasks, models and settings.
        progress: Receives notes, the estimate, and the start and end of each run.

    Returns:
        The evaluation as stored in its log, and a tally of the judgements. Its trials include runs with infrastructure failures,
        which are repeated when this function is called again.

    Raises:
        ConfigError: The evaluation engine is not installed, or models are not configured.
        InputError: Options contradict each other or name something unknown.
        OutputError: The log folder cannot be written to.
        ScopeError: Too many consecutive runs had infrastructure failures.
    """
    require_engine()
    from scope_ptz.bench.engine.runs import evaluation_lock
    from scope_ptz.factory.evaluation_session import EvaluationSession

    pair = await resolve_models(options.models)
    session = EvaluationSession(options, pair, progress or EvaluationProgress())
    with evaluation_lock(options.out, session.identity):
        stored = await session.stored_logs()
        try:
            if stored and stored[0].finished:
                session.progress.note(f"this evaluation is already complete: {stored[0].path} (--fresh runs it again)")
                return await session.with_judgements(stored[0].path, retry_failed=True)
            log = await session.run(stored)
            return await session.with_judgements(log, retry_failed=False)
        finally:
            with anyio.CancelScope(shield=True):
                await session.close()
