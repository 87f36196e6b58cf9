"""The linear model: the log-odds that a segment is a remark."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

WEIGHTS_FILE = "weights.json"


@dataclass(frozen=True, slots=True)
class RemarkModel:
    """Weights of a logistic regression.

    Attributes:
        bias: The log-odds of a segment without any known feature.
        weights: What each feature adds to the log-odds.
    """

    bias: float
    weights: Mapping[str, float]

    def log_odds(self, features: Iterable[str]) -> float:
        """Return the log-odds that a segment with these features is a remark; 0 means that both are equally likely."""
        return self.bias + sum(self.weights.get(feature, 0.0) for feature in features)


@lru_cache(maxsize=1)
def remark_model() -> RemarkModel:
    """Return the model that is delivered with the package."""
    content = json.loads(files(__package__).joinpath(WEIGHTS_FILE).read_text(encoding="utf-8"))
    return RemarkModel(content["bias"], content["weights"])
