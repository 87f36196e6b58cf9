"""Format the agreement between raters as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.judging.agreement import AgreementReport
from scope_ptz.bench.judging.kappa import KappaResult

_KAPPA_DECIMAL_PLACES = 3
"""Number of decimal places of kappa."""


def agreement_lines(report: AgreementReport) -> Iterator[str]:
    """Yield lines with the raters, the agreement between each pair of raters, and the agreement within each group."""
    if not report.raters:
        yield "These files contain no ratings. Judge runs with 'scope bench rescore', or label them with 'scope bench label'."
        return
    yield "raters"
    for rater in report.raters:
        correct = sum(rating.correct for rating in rater.ratings.values())
        others = "".join(f", {number} {name}" for name, number in sorted(rater.other_verdicts.items()))
        yield f"  {rater.name:<44} {len(rater.ratings):>6} run{_plural_suffix(len(rater.ratings))} rated, {correct} correct{others}"
    for pair in report.pairs:
        yield ""
        yield f"{pair.first}  against  {pair.second}"
        yield f"  verdicts     {agreement_text(pair.verdicts)}"
        yield f"               {_cells_line(pair.verdicts)}"
        if pair.modes.runs:
            yield f"  error modes  {agreement_text(pair.modes)}"
            differing = [cell for cell in pair.modes.confusion if cell[0] != cell[1]]
            for first, second, number in sorted(differing, key=lambda cell: -cell[2]):
                runs = f"run{_plural_suffix(number)}"
                yield f"               {number:>5} {runs}: {first} (first rater), {second} (second rater)"
    for group in report.groups:
        yield ""
        verb = "was" if group.partly_rated == 1 else "were"
        partly_rated = (
            f"; {group.partly_rated} run{_plural_suffix(group.partly_rated)} {verb} not rated by all" if group.partly_rated else ""
        )
        yield f"{group.title} ({len(group.raters)}), Fleiss"
        yield f"  verdicts     {agreement_text(group.verdicts)}{partly_rated}"


def agreement_text(agreement: KappaResult) -> str:
    """Format raw agreement and kappa as one line. Kappa is undefined if all ratings are the same."""
    if not agreement.runs:
        return "no run was rated by both"
    raw = f"{agreement.raw:.1%}" if agreement.raw is not None else "-"
    kappa = f"{agreement.kappa:.{_KAPPA_DECIMAL_PLACES}f}" if agreement.kappa is not None else "no value (all ratings are the same)"
    interval = (
        f" [{agreement.low:.{_KAPPA_DECIMAL_PLACES}f}, {agreement.high:.{_KAPPA_DECIMAL_PLACES}f}]"
        if agreement.low is not None and agreement.high is not None
        else ""
    )
    return f"{agreement.runs} run{_plural_suffix(agreement.runs)}, agree on {raw}, kappa {kappa}{interval}"


def _plural_suffix(number: int) -> str:
    return "" if number == 1 else "s"


def _cells_line(agreement: KappaResult) -> str:
    cells = {(first, second): number for first, second, number in agreement.confusion}
    both = {name: cells.get((name, name), 0) for name in ("correct", "incorrect")}
    first_correct, second_correct = cells.get(("correct", "incorrect"), 0), cells.get(("incorrect", "correct"), 0)
    same = f"both correct {both['correct']}, both incorrect {both['incorrect']}"
    return f"{same}, only the first correct {first_correct}, only the second {second_correct}"
