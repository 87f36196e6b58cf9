"""Create the context for run verification: scenes, ground-truth perception and true counts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scope_ptz.builtin_names import GROUND_TRUTH, NOISY_SOURCE
from scope_ptz.factory.evaluation import MAX_CACHED_VIEWS, eval_context
from scope_ptz.simulator.library import Library

if TYPE_CHECKING:
    from scope_ptz.bench.engine.traces.verification import VerificationContext
    from scope_ptz.perception.base import Perception


def verification_context() -> VerificationContext:
    """Create the context for run verification with the configured scenes.

    Raises:
        ConfigError: SCOPE_SCENES_DIR is not a folder.
    """
    from scope_ptz.bench.engine.traces.verification import VerificationContext
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.factory.validation_perception import TruthCache
    from scope_ptz.perception.ground_truth import GroundTruthPerception
    from scope_ptz.perception.ground_truth.noisy import NoisyPerception
    from scope_ptz.settings import load_settings

    scenes = Library(scene_search(load_settings()))
    truth = GroundTruthPerception(scenes, TruthCache(MAX_CACHED_VIEWS).read)
    context = eval_context(seed=1)
    assert context.true_count is not None  # noqa: S101 - an evaluation context can always count

    def make_perception(name: str, seed: int | None) -> Perception | None:
        if name == GROUND_TRUTH:
            return truth
        return NoisyPerception(truth, seed) if name == NOISY_SOURCE and seed is not None else None

    return VerificationContext(scenes, make_perception, context.true_count)
