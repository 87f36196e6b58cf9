"""Train the model that tells remarks from requests, and measure it on lots that it was not trained on.

    python -m benchmarks.remark_model [--write]

A segment of an instruction is a remark if the instruction without it still gets the expected plan. Four models are trained, each on
three quarters of the lots, and measured on the rest. Only rows of the split ``dev`` are used. With ``--write`` a model that is
trained on all lots replaces the one in the package.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.progress import track
from scipy.optimize import minimize
from scipy.sparse import csr_matrix
from scipy.special import expit
from tests.planner.lots import FILES, Row, planned, rows, verdict

from scope_ptz.planner.grammar.parsing import remark_detection
from scope_ptz.planner.grammar.parsing.remark_detection.features import features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import WEIGHTS_FILE, RemarkModel
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.rewording.plain_text import written_out

_MAX_SEGMENTS = 8  # instructions with more segments are not used, because each segment is left out in turn
_MIN_OCCURRENCES = 3  # minimum number of segments with a feature
_L2 = 1.0  # penalty of the squared weights
_MIN_WEIGHT = 0.15  # features with smaller weights are left out of the file
_FOLDS = 4
_THRESHOLDS = (-1.0, 0.0, 1.0, 2.0, 3.0)


@dataclass(frozen=True, slots=True)
class Example:
    """A segment with its features."""

    lot: str
    features: frozenset[str]
    is_remark: bool


def main() -> None:
    """Print the table, and write the weights if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the weights into the package")
    options = parser.parse_args()
    examples = [example for lot in track(FILES, "Leaving out segments") for row in rows(lot, "dev") for example in _examples(row)]
    labels = np.array([example.is_remark for example in examples])
    print(f"{len(examples)} segments, {labels.sum()} of them remarks")
    log_odds = _cross_validated(examples)
    print(f"{'log-odds above':<16}{'precision':>10}{'recall':>10}")
    for threshold in _THRESHOLDS:
        found = log_odds > threshold
        print(f"{threshold:<16}{labels[found].mean():>10.1%}{labels[found].sum() / labels.sum():>10.1%}")
    if options.write:
        model = _trained(examples)
        path = Path(next(iter(remark_detection.__path__))) / WEIGHTS_FILE
        weights = {name: round(weight, 2) for name, weight in sorted(model.weights.items()) if abs(weight) >= _MIN_WEIGHT}
        path.write_text(json.dumps({"bias": round(model.bias, 2), "weights": weights}, indent=0, ensure_ascii=False) + "\n")
        print(f"{len(weights)} weights written to {path}")


def _examples(row: Row) -> Iterator[Example]:
    """Yield the segments of a row; none if no version of it gets the expected plan.

    Of an instruction that must not be understood, only those segments are used without which it is: they are no remarks.
    """
    text = written_out(row.instruction)
    segments = segments_of(text)
    if not 1 < len(segments) <= _MAX_SEGMENTS:
        return
    are_remarks = [
        _is_right(replace(row, instruction=text[: segment.start] + text[following:]))
        for segment, following in zip(segments, [*(segment.start for segment in segments[1:]), len(text)], strict=True)
    ]
    if row.understood and not any(are_remarks) and not _is_right(row):
        return
    for index, is_remark in enumerate(are_remarks):
        if row.understood or not is_remark:
            yield Example(row.lot, features_of(segments, index, row.presets), is_remark)


def _is_right(row: Row) -> bool:
    return verdict(row, planned(row)) == "right"


def _cross_validated(examples: Sequence[Example]) -> np.ndarray:
    """Return the log-odds of each example from a model that was not trained on its lot."""
    lots = sorted({example.lot for example in examples})
    folds = np.array([lots.index(example.lot) % _FOLDS for example in examples])
    log_odds = np.zeros(len(examples))
    for fold in range(_FOLDS):
        model = _trained([example for example, own in zip(examples, folds, strict=True) if own != fold])
        for index in np.flatnonzero(folds == fold):
            log_odds[index] = model.log_odds(examples[int(index)].features)
    return log_odds


def _trained(examples: Sequence[Example]) -> RemarkModel:
    """Return a logistic regression with a quadratic penalty, fitted with L-BFGS."""
    occurrences = Counter(feature for example in examples for feature in example.features)
    names = sorted(name for name, times in occurrences.items() if times >= _MIN_OCCURRENCES)
    columns = {name: column for column, name in enumerate(names)}
    pairs = [(i, columns[name]) for i, example in enumerate(examples) for name in example.features if name in columns]
    row_numbers, column_numbers = np.array(pairs).T
    features = csr_matrix((np.ones(len(pairs)), (row_numbers, column_numbers)), shape=(len(examples), len(names)))
    signs = np.where([example.is_remark for example in examples], 1.0, -1.0)

    def loss(parameters: np.ndarray) -> tuple[float, np.ndarray]:
        weights, bias = parameters[:-1], parameters[-1]
        margins = signs * (features @ weights + bias)
        slopes = -signs * expit(-margins)
        value = np.logaddexp(0, -margins).sum() + 0.5 * _L2 * weights @ weights
        return float(value), np.append(features.T @ slopes + _L2 * weights, slopes.sum())

    fitted = minimize(loss, np.zeros(len(names) + 1), jac=True, method="L-BFGS-B", options={"maxiter": 300}).x
    return RemarkModel(float(fitted[-1]), dict(zip(names, fitted[:-1].tolist(), strict=True)))


if __name__ == "__main__":
    main()
