"""Format a validation report as lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.taskgen.validation.validation_report import ValidationFault, ValidationReport

MOST_LISTED = 40


def report_lines(report: ValidationReport) -> Iterator[str]:
    """Yield counts by category, correct programs, adversarial answers, then every failure."""
    content = report.as_dict()
    yield f"{report.tasks} tasks: " + ", ".join(f"{number} {name}" for name, number in sorted(report.by_stratum.items()))
    for name, number in report.by_category.items():
        yield f"  {name:<22}{number:>5}"
    yield f"  there is none: {report.absences}, each with a twin; can be done from the start view: {report.from_start}"
    yield "right ways"
    for name, row in content["right_ways"].items():
        yield f"  {name:<22}{row['passed']:>5} of {row['of']}"
    yield "cheats"
    for name, row in content["cheats"].items():
        yield f"  {name:<22}{row['passed']:>5} of {row['of']}  ({row['share_of_all']:.1%} of all tasks)"
    if content["looked_and_guessed"]:
        yield "right by chance after looking: of the core tasks, and with pairs counting only when both are"
    for name, row in content["looked_and_guessed"].items():
        guess = name.removeprefix("looked-and-guessed: ")
        yield f"  {guess:<22}{row['passed']:>5}  ({row['share']:.1%})  {row['pairs_whole']:>5}  ({row['share_pairs_whole']:.1%})"
    yield from _listed("failed", report.faults)
    yield from _listed("cheated", report.adversarial_passes)
    yield from _listed("seen otherwise by the ground-truth perception", report.disagreements)
    yield "sound" if report.sound else "NOT SOUND"


def _listed(title: str, faults: Sequence[ValidationFault]) -> Iterator[str]:
    if faults:
        yield f"{title}: {len(faults)}"
    for fault in faults[:MOST_LISTED]:
        yield f"  {fault.task} [{fault.attempt}] {fault.reason}"
    if len(faults) > MOST_LISTED:
        yield f"  ... and {len(faults) - MOST_LISTED} more"
