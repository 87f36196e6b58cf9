"""Two linear models of a segment: whether it is a remark, and whether it takes a command back."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

REMARK_WEIGHTS_FILE = "remark_weights.json"
WITHDRAWAL_WEIGHTS_FILE = "withdrawal_weights.json"


@dataclass(frozen=True, slots=True)
class LinearModel:
    """Weights of a logistic regression.

    Attributes:
        bias: The log-odds of a segment without any known feature.
        weights: What each feature adds to the log-odds.
    """

    bias: float
    weights: Mapping[str, float]

    def log_odds(self, features: Iterable[str]) -> float:
        """Return the log-odds that a segment with these features is what the model looks for; 0 means even odds."""
        return self.bias + sum(self.weights.get(feature, 0.0) for feature in features)


@lru_cache(maxsize=1)
def remark_model() -> LinearModel:
    """Return the model that tells remarks from requests, for ``features_of``."""
    return _model(REMARK_WEIGHTS_FILE)


@lru_cache(maxsize=1)
def withdrawal_model() -> LinearModel:
    """Return the model that tells statements that take a command back from harmless remarks, for ``statement_features_of``."""
    return _model(WITHDRAWAL_WEIGHTS_FILE)


def _model(name: str) -> LinearModel:
    content = json.loads(files(__package__).joinpath(name).read_text(encoding="utf-8"))
    return LinearModel(content["bias"], content["weights"])
