"""Perception from the simulator's ground truth instead of pixels."""

from scope_ptz.perception.ground_truth.backend import GroundTruthPerception, TruthReader

__all__ = ["GroundTruthPerception", "TruthReader"]
