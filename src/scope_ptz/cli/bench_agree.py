"""``scope bench agree``: how far judges, checks, people and known faults agree."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import ending, put, put_json

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from scope_ptz.bench.judging.agreement import AgreementReport, Rater
    from scope_ptz.bench.judging.kappa import KappaResult

AsJson = Annotated[bool, typer.Option("--json", help="The whole report as JSON.")]
_DIGITS = 3


def agree(
    logs: Annotated[
        list[Path], typer.Argument(help="Logs with judgements or labels, and verdicts on gold runs (.jsonl of judge-gold).")
    ],
    as_json: AsJson = False,
    seed: Annotated[int, typer.Option(help="Of the bootstrap.")] = 1,
) -> None:
    """How far judges, their repeats, the checks, people and known faults agree: raw, Cohen's and Fleiss' kappa, 95% intervals."""
    with ending(as_json=as_json):
        from scope_ptz.bench.judging.agreement import measure_agreement

        report = measure_agreement(raters_in(logs), seed)
        if as_json:
            put_json(report.as_dict(), indent=1)
        else:
            for line in agreement_lines(report):
                put(line)


def raters_in(logs: Sequence[Path]) -> list[Rater]:
    """Everyone who rated what is in these files. Raises ``InputError`` or ``TraceError``."""
    from scope_ptz.bench.judging.agreement import raters_of
    from scope_ptz.bench.judging.human_labels import labels_file, read_labels, with_labels
    from scope_ptz.taskgen.gold.judge_results import raters_of_gold, read_verdicts

    gold = [path for path in logs if path.suffix == ".jsonl"]
    evaluations = []
    for path in logs:
        if path not in gold:
            from scope_ptz.bench.engine.logs import read_evaluation

            evaluations.append(with_labels(read_evaluation(path), read_labels(labels_file(path))))
    verdicts = [verdict for path in gold for verdict in read_verdicts(path)]
    return [*raters_of(evaluations), *raters_of_gold(verdicts)]


def agreement_lines(report: AgreementReport) -> Iterator[str]:
    """The report as text: who rated, then pairs with verdicts and modes, then groups."""
    if not report.raters:
        yield "Nobody rated anything in these files: judge them with 'scope bench rescore', or label them with 'scope bench label'."
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
        yield f"               {_told(pair.verdicts)}"
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
    """One line of figures; "no value" where everyone said the same, and none where nothing was rated by both."""
    if not agreed.runs:
        return "no run that both have rated"
    raw = f"{agreed.raw:.1%}" if agreed.raw is not None else "-"
    kappa = f"{agreed.kappa:.{_DIGITS}f}" if agreed.kappa is not None else "no value (all ratings are the same)"
    interval = (
        f" [{agreed.low:.{_DIGITS}f}, {agreed.high:.{_DIGITS}f}]" if agreed.low is not None and agreed.high is not None else ""
    )
    return f"{agreed.runs} run{_s(agreed.runs)}, agree on {raw}, kappa {kappa}{interval}"


def _s(number: int) -> str:
    return "" if number == 1 else "s"


def _told(agreed: KappaResult) -> str:
    cells = {(first, second): number for first, second, number in agreed.confusion}
    both = {name: cells.get((name, name), 0) for name in ("correct", "incorrect")}
    one, two = cells.get(("correct", "incorrect"), 0), cells.get(("incorrect", "correct"), 0)
    return (
        f"both correct {both['correct']}, both incorrect {both['incorrect']}, only the first correct {one}, only the second {two}"
    )
