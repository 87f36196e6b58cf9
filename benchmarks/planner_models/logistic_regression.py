"""Fit the linear models of the built-in planner, and write their weights."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix
from scipy.special import expit

from scope_ptz.planner.grammar.parsing import remark_detection
from scope_ptz.planner.grammar.parsing.remark_detection.model import LinearModel

_L2 = 1.0  # penalty of the squared weights
_MIN_WEIGHT = 0.15  # features with smaller weights are left out of the file


@dataclass(frozen=True, slots=True)
class Example:
    """A segment with its features.

    Attributes:
        source: The file that it is from.
        features: The names of its features.
        label: Whether it is what the model looks for.
    """

    source: str
    features: frozenset[str]
    label: bool


def fitted(examples: Sequence[Example], *, min_occurrences: int) -> LinearModel:
    """Return a logistic regression with a quadratic penalty, fitted with L-BFGS.

    Args:
        examples: The segments.
        min_occurrences: The minimum number of segments with a feature; rarer features are not used.
    """
    occurrences = Counter(feature for example in examples for feature in example.features)
    names = sorted(name for name, times in occurrences.items() if times >= min_occurrences)
    columns = {name: column for column, name in enumerate(names)}
    pairs = [(i, columns[name]) for i, example in enumerate(examples) for name in example.features if name in columns]
    row_numbers, column_numbers = np.array(pairs).T
    features = csr_matrix((np.ones(len(pairs)), (row_numbers, column_numbers)), shape=(len(examples), len(names)))
    signs = np.where([example.label for example in examples], 1.0, -1.0)

    def loss(parameters: np.ndarray) -> tuple[float, np.ndarray]:
        weights, bias = parameters[:-1], parameters[-1]
        margins = signs * (features @ weights + bias)
        slopes = -signs * expit(-margins)
        value = np.logaddexp(0, -margins).sum() + 0.5 * _L2 * weights @ weights
        return float(value), np.append(features.T @ slopes + _L2 * weights, slopes.sum())

    optimum = minimize(loss, np.zeros(len(names) + 1), jac=True, method="L-BFGS-B", options={"maxiter": 300}).x
    return LinearModel(float(optimum[-1]), dict(zip(names, optimum[:-1].tolist(), strict=True)))


def cross_validated(examples: Sequence[Example], *, min_occurrences: int, folds: int = 4) -> np.ndarray:
    """Return the log-odds of each example from a model that was not trained on any example of its source."""
    sources = sorted({example.source for example in examples})
    own_folds = np.array([sources.index(example.source) % folds for example in examples])
    log_odds = np.zeros(len(examples))
    for fold in range(folds):
        others = [example for example, own in zip(examples, own_folds, strict=True) if own != fold]
        model = fitted(others, min_occurrences=min_occurrences)
        for index in np.flatnonzero(own_folds == fold):
            log_odds[index] = model.log_odds(examples[int(index)].features)
    return log_odds


def write(model: LinearModel, name: str) -> None:
    """Write the weights of a model into the package, and print where."""
    path = Path(next(iter(remark_detection.__path__))) / name
    weights = {feature: round(weight, 2) for feature, weight in sorted(model.weights.items()) if abs(weight) >= _MIN_WEIGHT}
    path.write_text(json.dumps({"bias": round(model.bias, 2), "weights": weights}, indent=0, ensure_ascii=False) + "\n")
    print(f"{len(weights)} weights written to {path}")
