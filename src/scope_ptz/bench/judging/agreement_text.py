"""Format the agreement of raters as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.judging.agreement import AgreementReport
from scope_ptz.bench.judging.kappa import KappaResult

_DIGITS = 3
"""Number of decimals of kappa."""


def agreement_lines(report: AgreementReport) -> Iterator[str]:
    """Yield the raters, the agreement of each pair of raters, and the agreement of each group."""
    if not report.raters:
        yield "These files contain no ratings. Judge runs with 'scope bench rescore', or label them with 'scope bench label'."
        return
    yield "raters"
    for rater in report.raters:
        correct = sum(rating.correct for rating in rater.ratings.values())
        others = "".join(f", {number} {name}" for name, number in sorted(rater.other_verdicts.items()))
        yield f"  {rater.name:<44} {len(rater.ratings):>6} run{_plural(len(rater.ratings))} rated, {correct} correct{others}"
    for pair in report.pairs:
        yield ""
        yield f"{pair.first}  against  {pair.second}"
        yield f"  verdicts     {figures(pair.verdicts)}"
        yield f"               {_cells_line(pair.verdicts)}"
        if pair.modes.runs:
            yield f"  error modes  {figures(pair.modes)}"
            differing = [cell for cell in pair.modes.confusion if cell[0] != cell[1]]
            for first, second, number in sorted(differing, key=lambda cell: -cell[2]):
                yield f"               {number:>5} x {first} was {second}"
    for group in report.groups:
        yield ""
        were = "was" if group.left_out == 1 else "were"
        left_out = f"; {group.left_out} run{_plural(group.left_out)} {were} not rated by all" if group.left_out else ""
        yield f"{group.title} ({len(group.raters)}), Fleiss"
        yield f"  verdicts     {figures(group.verdicts)}{left_out}"


def figures(agreement: KappaResult) -> str:
    """Return raw agreement and kappa on one line. Kappa is undefined if all ratings are the same."""
    if not agreement.runs:
        return "no run was rated by both"
    raw = f"{agreement.raw:.1%}" if agreement.raw is not None else "-"
    kappa = f"{agreement.kappa:.{_DIGITS}f}" if agreement.kappa is not None else "no value (all ratings are the same)"
    interval = (
        f" [{agreement.low:.{_DIGITS}f}, {agreement.high:.{_DIGITS}f}]"
        if agreement.low is not None and agreement.high is not None
        else ""
    )
    return f"{agreement.runs} run{_plural(agreement.runs)}, agree on {raw}, kappa {kappa}{interval}"


def _plural(number: int) -> str:
    return "" if number == 1 else "s"


def _cells_line(agreement: KappaResult) -> str:
    cells = {(first, second): number for first, second, number in agreement.confusion}
    both = {name: cells.get((name, name), 0) for name in ("correct", "incorrect")}
    one, two = cells.get(("correct", "incorrect"), 0), cells.get(("incorrect", "correct"), 0)
    return (
        f"both correct {both['correct']}, both incorrect {both['incorrect']}, only the first correct {one}, only the second {two}"
    )
