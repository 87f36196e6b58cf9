"""Format the agreement of raters as lines of text."""

from __future__ import annotations

from collections.abc import Iterator

from scope_ptz.bench.judging.agreement import AgreementReport
from scope_ptz.bench.judging.kappa import KappaResult

_DIGITS = 3


def agreement_lines(report: AgreementReport) -> Iterator[str]:
    """Yield the raters, the agreement of each pair of raters, and the agreement of each group."""
    if not report.raters:
        yield "These files contain no ratings. Judge runs with 'scope bench rescore', or label them with 'scope bench label'."
        return
    yield "raters"
    for rater in report.raters:
        correct = sum(rating.correct for rating in rater.ratings.values())
        apart = "".join(f", {number} {name}" for name, number in sorted(rater.apart.items()))
        yield f"  {rater.name:<44} {len(rater.ratings):>6} run{_s(len(rater.ratings))} rated, {correct} correct{apart}"
    for pair in report.pairs:
        yield ""
        yield f"{pair.first}  against  {pair.second}"
        yield f"  verdicts     {figures(pair.verdicts)}"
        yield f"               {_cells_line(pair.verdicts)}"
        if pair.modes.runs:
            yield f"  error modes  {figures(pair.modes)}"
            off = [cell for cell in pair.modes.confusion if cell[0] != cell[1]]
            for first, second, number in sorted(off, key=lambda cell: -cell[2]):
                yield f"               {number:>5} x {first} was {second}"
    for group in report.groups:
        yield ""
        were = "was" if group.left_out == 1 else "were"
        left_out = f"; {group.left_out} run{_s(group.left_out)} {were} not rated by all" if group.left_out else ""
        yield f"{group.what} ({len(group.raters)}), Fleiss"
        yield f"  verdicts     {figures(group.verdicts)}{left_out}"


def figures(agreed: KappaResult) -> str:
    """Return raw agreement and kappa on one line. Kappa has no value if all ratings are the same."""
    if not agreed.runs:
        return "no run was rated by both"
    raw = f"{agreed.raw:.1%}" if agreed.raw is not None else "-"
    kappa = f"{agreed.kappa:.{_DIGITS}f}" if agreed.kappa is not None else "no value (all ratings are the same)"
    interval = (
        f" [{agreed.low:.{_DIGITS}f}, {agreed.high:.{_DIGITS}f}]" if agreed.low is not None and agreed.high is not None else ""
    )
    return f"{agreed.runs} run{_s(agreed.runs)}, agree on {raw}, kappa {kappa}{interval}"


def _s(number: int) -> str:
    return "" if number == 1 else "s"


def _cells_line(agreed: KappaResult) -> str:
    cells = {(first, second): number for first, second, number in agreed.confusion}
    both = {name: cells.get((name, name), 0) for name in ("correct", "incorrect")}
    one, two = cells.get(("correct", "incorrect"), 0), cells.get(("incorrect", "correct"), 0)
    return (
        f"both correct {both['correct']}, both incorrect {both['incorrect']}, only the first correct {one}, only the second {two}"
    )
