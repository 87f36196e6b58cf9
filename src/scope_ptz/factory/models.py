"""Resolve model options, and create planners and perception backends from the results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from scope_ptz.builtin_names import BUILT_IN_PERCEPTION, GRAMMAR, GROUND_TRUTH, NOISY, SERVED_TRUTH
from scope_ptz.errors import ConfigError, InputError
from scope_ptz.factory.model_specs import (
    ModelOptions,
    ResolvedPair,
    ResolvedPerception,
    ResolvedPlanner,
)

if TYPE_CHECKING:
    from scope_ptz.perception.base import Perception
    from scope_ptz.perception.ground_truth import TruthReader
    from scope_ptz.perception.ground_truth.served import ServedTruth
    from scope_ptz.planner.base import Planner
    from scope_ptz.planner.spec import PlannerSpec
    from scope_ptz.simulator.pack import Scene

__all__ = [
    "GROUND_TRUTH_NOTE",
    "NOISY_NOTE",
    "SERVED_TRUTH_NOTE",
    "ModelOptions",
    "ResolvedPair",
    "ResolvedPerception",
    "ResolvedPlanner",
    "dry_run_note",
    "make_perception",
    "make_planner",
    "perception_note",
    "resolve_models",
]

GROUND_TRUTH_NOTE = "Perception is the simulator's own ground truth, not a model."
NOISY_NOTE = "Perception is the simulator's ground truth with seeded mistakes, not a model."
SERVED_TRUTH_NOTE = "Simulation only: perception is the ground truth that the virtual camera serves, not a model."
_NOTES = {GROUND_TRUTH: GROUND_TRUTH_NOTE, NOISY: NOISY_NOTE, SERVED_TRUTH: SERVED_TRUTH_NOTE}


async def resolve_models(options: ModelOptions) -> ResolvedPair:
    """Resolve model options to a planner and a perception backend.

    If the options do not include a model's served name, it is looked up in the server's model list.

    Raises:
        InputError: A name, a URL or a combination of options is invalid.
    """
    if options.planner_instance is not None or options.perception_instance is not None:
        pair = await resolve_models(replace(options, planner_instance=None, perception_instance=None))
        if (planner := options.planner_instance) is not None:
            pair = replace(pair, planner=ResolvedPlanner(planner.name, instance=planner))
        if (perception := options.perception_instance) is not None:
            pair = replace(pair, perception=ResolvedPerception(perception.name, instance=perception))
        return pair
    if _only_built_in(options):
        return ResolvedPair(ResolvedPlanner(GRAMMAR), ResolvedPerception(options.perception or BUILT_IN_PERCEPTION[0]))
    from scope_ptz.factory.model_resolver import ModelResolver
    from scope_ptz.settings import load_settings

    return await ModelResolver(options, load_settings()).resolve()


def _only_built_in(options: ModelOptions) -> bool:
    """Return whether the options name only built-in planners and perception backends, so that the registry is not needed."""
    names_only = ModelOptions(planner=options.planner, perception=options.perception)
    return options == names_only and options.planner in (None, GRAMMAR) and options.perception in (None, *BUILT_IN_PERCEPTION)


def make_planner(resolved: ResolvedPlanner) -> Planner:
    """Create a planner.

    Raises:
        ConfigError: A plug-in cannot be loaded or does not return a planner.
    """
    if resolved.instance is not None:
        return resolved.instance
    if resolved.is_hybrid:
        from scope_ptz.planner.hybrid import HybridPlanner

        return HybridPlanner(make_planner(replace(resolved, is_hybrid=False)), resolved.name)
    if resolved.plugin is not None:
        return make_plugin_planner(resolved.plugin)
    if resolved.endpoint is None:
        from scope_ptz.planner.grammar import GrammarPlanner

        return GrammarPlanner()
    from scope_ptz.planner.chat import ChatPlanner

    return ChatPlanner(resolved.endpoint, resolved.options)


def make_plugin_planner(spec: PlannerSpec) -> Planner:
    """Create a plug-in's planner.

    Raises:
        ConfigError: The plug-in is not installed or cannot be loaded, or its factory fails or does not return a planner.
    """
    from scope_ptz.entry_points import PLANNERS, call_factory, find
    from scope_ptz.planner.base import Planner

    entry = find(PLANNERS, spec.name)
    if entry is None:
        raise ConfigError(
            f"No installed package provides the planner '{spec.name}'. Install the plug-in, or choose another planner."
        )
    return call_factory(entry, Planner, spec)  # type: ignore[type-abstract]


def make_perception(
    resolved: ResolvedPerception,
    scenes: Callable[[str], Scene] | None,
    seed: int,
    read_truth: TruthReader | None = None,
    served_truth: Callable[[], ServedTruth] | None = None,
) -> Perception:
    """Create a perception backend.

    Args:
        resolved: The resolved perception backend.
        scenes: A function that opens the scenes of simulated frames by name; None for a camera without ground truth.
        seed: Seed for the random errors of ``noisy``.
        read_truth: A function that reads the ground truth of a view; the default does not cache it.
        served_truth: A function that connects to a virtual camera's ground truth; None for other cameras.

    Raises:
        InputError: A built-in perception backend is requested for a camera without ground truth.
        ConfigError: A backend's options are invalid, or a package is not installed or cannot be loaded.
    """
    if resolved.instance is not None:
        return resolved.instance
    if resolved.spec is not None:
        from scope_ptz.perception.backends import make_backend

        return make_backend(resolved.spec)
    if resolved.name == SERVED_TRUTH:
        return _make_served_truth(served_truth)
    if scenes is None:
        raise InputError(
            f"The backend '{resolved.name}' uses the ground truth of a simulated scene, but this camera has none. Choose a "
            "vision model with --perception. `scope models --role perception` lists them."
        )
    from scope_ptz.perception.ground_truth import GroundTruthPerception

    truth = GroundTruthPerception(scenes) if read_truth is None else GroundTruthPerception(scenes, read_truth)
    if resolved.name == GROUND_TRUTH:
        return truth
    from scope_ptz.perception.ground_truth.noisy import NoisyPerception

    return NoisyPerception(truth, seed=seed)


def _make_served_truth(served_truth: Callable[[], ServedTruth] | None) -> Perception:
    if served_truth is None:
        raise InputError(
            f"The backend '{SERVED_TRUTH}' requires a virtual camera on this machine, such as axis://root@127.0.0.1:8080, "
            "without rules in scope.yaml. Choose another backend with --perception."
        )
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.perception.ground_truth.served import ServedTruthPerception
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.library import Library

    return ServedTruthPerception(served_truth(), Library(scene_search(load_settings())))


def dry_run_note(note: str) -> str:
    """Return a note for the user about a dry run, followed by ``note``, which is about perception."""
    return f"Dry run: nothing has moved, and answers are about the view at the start. {note}".rstrip()


def perception_note(resolved: ResolvedPerception) -> str:
    """Return a sentence for the user that describes a built-in perception backend; empty for models."""
    return _NOTES.get(resolved.name, "") if resolved.spec is None and resolved.instance is None else ""
