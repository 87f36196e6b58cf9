"""Train the model that tells remarks from requests, and measure it on lots that it was not trained on.

    python -m benchmarks.planner_models.remark_model [--write]

A segment of an instruction is a remark if the instruction without it still gets the expected plan. Four models are trained, each on
three quarters of the lots, and measured on the rest. Only rows of the split ``dev`` are used. With ``--write`` a model that is
trained on all lots replaces the one in the package.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from rich.progress import track
from tests.planner.lots import FILES, Row, planned, rows, verdict

from scope_ptz.planner.grammar.parsing.remark_detection.features import features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import REMARK_WEIGHTS_FILE
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.rewording.plain_text import written_out

from .logistic_regression import Example, cross_validated, fitted, write

_MAX_SEGMENTS = 8  # instructions with more segments are not used, because each segment is left out in turn
_MIN_OCCURRENCES = 3  # minimum number of segments with a feature
_THRESHOLDS = (-1.0, 0.0, 1.0, 2.0, 3.0)


def main() -> None:
    """Print the table, and write the weights if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the weights into the package")
    options = parser.parse_args()
    examples = [example for lot in track(FILES, "Leaving out segments") for row in rows(lot, "dev") for example in _examples(row)]
    labels = np.array([example.label for example in examples])
    print(f"{len(examples)} segments, {labels.sum()} of them remarks")
    log_odds = cross_validated(examples, min_occurrences=_MIN_OCCURRENCES)
    print(f"{'log-odds above':<16}{'precision':>10}{'recall':>10}")
    for threshold in _THRESHOLDS:
        found = log_odds > threshold
        print(f"{threshold:<16}{labels[found].mean():>10.1%}{labels[found].sum() / labels.sum():>10.1%}")
    if options.write:
        write(fitted(examples, min_occurrences=_MIN_OCCURRENCES), REMARK_WEIGHTS_FILE)


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


if __name__ == "__main__":
    main()
