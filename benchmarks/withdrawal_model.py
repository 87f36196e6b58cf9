"""Train the model that tells statements that take a command back from harmless remarks, and measure it.

    python -m benchmarks.withdrawal_model [--write]

Harmless are the segments of the lots' rows without which the plan stays the same, and the statements of the commands that must be
carried out. Four models are trained, each on three quarters of the files, and measured on the rest: for thresholds at which few
instructions of the lots would be asked about, the table shows how many statements are recognised. Only rows of the split ``dev``
are used. With ``--write`` a model that is trained on all files replaces the one in the package; then the planner as it is
delivered is measured on the rows that are kept aside.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from unittest.mock import patch

import numpy as np
from benchmarks.logistic_regression import Example, cross_validated, fitted, write
from rich.progress import track
from tests.planner import withdrawals
from tests.planner.lots import FILES, Row, planned, rows, verdict

from scope_ptz.planner.grammar.binding import understand
from scope_ptz.planner.grammar.parsing.remark_detection.features import statement_features_of
from scope_ptz.planner.grammar.parsing.remark_detection.model import WITHDRAWAL_WEIGHTS_FILE, withdrawal_model
from scope_ptz.planner.grammar.parsing.remark_detection.segments import segments_of
from scope_ptz.planner.grammar.parsing.remark_detection.withdrawing_segments import is_command
from scope_ptz.planner.grammar.parsing.rewording.plain_text import written_out

_MAX_SEGMENTS = 8  # instructions with more segments are not used, because each segment is left out in turn
_MIN_OCCURRENCES = 2  # minimum number of segments with a feature
_MOVES = frozenset({"adjust_ptz", "go_home", "go_to_preset", "zoom_to_object", "track_object"})
_SHARES_ASKED = (0.0025, 0.005, 0.01, 0.02)


def main() -> None:
    """Print the table, write the weights if asked to, and measure the planner on the rows that are kept aside."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the weights into the package")
    options = parser.parse_args()
    with patch.object(understand, "withdrawing_segments", return_value=()):  # otherwise the old model would choose the examples
        harmless = [
            (row, example)
            for lot in track(FILES, "Leaving out segments")
            for row in rows(lot, "dev")
            for example in _harmless_segments(row)
        ]
    statements = [(row, example) for row in withdrawals.rows("dev") for example in _segments_of_statement(row)]
    examples = [example for _, example in (*harmless, *statements)]
    log_odds = cross_validated(examples, min_occurrences=_MIN_OCCURRENCES)
    _print_table(
        _highest([row for row, _ in harmless], log_odds[: len(harmless)]),
        _highest([row for row, _ in statements], log_odds[len(harmless) :]),
    )
    if options.write:
        write(fitted(examples, min_occurrences=_MIN_OCCURRENCES), WITHDRAWAL_WEIGHTS_FILE)
        withdrawal_model.cache_clear()
    _print_kept_aside()


def _harmless_segments(row: Row) -> Iterator[Example]:
    """Yield the segments without which an instruction, which is planned rightly, has the same plan."""
    text = written_out(row.instruction)
    segments = segments_of(text)
    if not row.understood or not 1 < len(segments) <= _MAX_SEGMENTS:
        return
    made = planned(row)
    if verdict(row, made) != "right":
        return
    for index, segment in enumerate(segments):
        if is_command(segment.text, row.presets):
            continue
        following = segments[index + 1].start if index + 1 < len(segments) else len(text)
        shorter = planned(replace(row, instruction=text[: segment.start] + text[following:]))
        if shorter.understood and shorter.calls == made.calls:
            yield Example(row.lot, statement_features_of(segments, index, row.presets), label=False)


def _segments_of_statement(row: withdrawals.Row) -> Iterator[Example]:
    text = written_out(row.instruction)
    segments = segments_of(text)
    for index in withdrawals.statement_indices(text, written_out(row.statement), segments):
        features = statement_features_of(segments, index, withdrawals.PRESETS)
        yield Example(row.source, features, label=not row.carried_out)


def _highest(owners: list[Row] | list[withdrawals.Row], log_odds: np.ndarray) -> dict[tuple[str, bool], float]:
    """Return the highest log-odds of the segments of each row, by instruction and whether it must be asked about."""
    highest: dict[tuple[str, bool], float] = {}
    for row, value in zip(owners, log_odds.tolist(), strict=True):
        is_asked = isinstance(row, withdrawals.Row) and not row.carried_out
        highest[row.instruction, is_asked] = max(highest.get((row.instruction, is_asked), value), value)
    return highest


def _print_table(of_lots: dict[tuple[str, bool], float], of_statements: dict[tuple[str, bool], float]) -> None:
    """Print what each threshold recognises."""
    lots = sorted(of_lots.values(), reverse=True)
    moving = sum(_is_moving(row) for lot in FILES for row in rows(lot, "dev"))
    withdrawing = np.array([value for (_, is_asked), value in of_statements.items() if is_asked])
    harmless = np.array([value for (_, is_asked), value in of_statements.items() if not is_asked])
    print(f"{moving} instructions of the lots that move the camera; {len(withdrawing)} statements that must be asked about")
    print(f"{'asked of the lots':<20}{'log-odds above':>16}{'recognised':>12}{'harmless twins asked':>22}")
    for share in _SHARES_ASKED:
        threshold = lots[round(share * moving)]
        found, wrong = (withdrawing > threshold).mean(), (harmless > threshold).mean()
        print(f"{share:<20.2%}{threshold:>16.2f}{found:>12.1%}{wrong:>22.1%}")


def _is_moving(row: Row) -> bool:
    return any(call["name"] in _MOVES for call in row.calls)


def _print_kept_aside() -> None:
    """Print how often the planner as it is delivered moves the camera on the rows that are kept aside."""
    kept_aside = list(withdrawals.rows("held-out"))
    for carried_out, text in ((True, "must be carried out"), (False, "must not be carried out")):
        moved = [row.moves_the_camera() for row in kept_aside if row.carried_out == carried_out]
        print(f"kept aside, {text}: {sum(moved)} of {len(moved)} move the camera ({np.mean(moved):.1%})")


if __name__ == "__main__":
    main()
