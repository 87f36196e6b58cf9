"""Format a validation report as lines of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.taskgen.validation.validation_report import ValidationFault, ValidationReport

MAX_LISTED = 40  # maximum number of faults to list for each kind
_PAIRS_NOTE = "right-hand numbers: paired tasks count only if both tasks of the pair pass"


def report_lines(report: ValidationReport) -> Iterator[str]:
    """Yield the counts by category, the results of correct and adversarial attempts, then the faults."""
    content = report.as_dict()
    yield f"{report.tasks} tasks: " + ", ".join(f"{number} {name}" for name, number in sorted(report.by_stratum.items()))
    for name, number in report.by_category.items():
        yield f"  {name:<22}{number:>5}"
    yield f"  with the answer 'there is none': {report.absences}, each paired with a task about a present object"
    yield f"  answerable from the start view: {report.from_start}"
    yield "correct attempts (must pass)"
    for name, row in content["right_ways"].items():
        yield f"  {name:<22}{row['passed']:>5} of {row['of']}"
    yield "adversarial attempts (must fail)"
    for name, row in content["cheats"].items():
        yield f"  {name:<22}{row['passed']:>5} of {row['of']}  ({row['share_of_all']:.1%} of all tasks)"
    if content["looked_and_guessed"]:
        yield f"core tasks that fixed answers pass ({_PAIRS_NOTE})"
    for name, row in content["looked_and_guessed"].items():
        guess = name.removeprefix("looked-and-guessed: ")
        yield f"  {guess:<22}{row['passed']:>5}  ({row['share']:.1%})  {row['pairs_whole']:>5}  ({row['share_pairs_whole']:.1%})"
    if report.adaptive:
        yield f"core tasks that answers adapted to the form of the question pass ({_PAIRS_NOTE})"
    for name, row in report.adaptive_as_dict().items():
        agent = name.removeprefix("adaptive: ")
        yield f"  {agent:<28}{row['passed']:>5}  ({row['share']:.1%})  {row['pairs_whole']:>5}  ({row['share_pairs_whole']:.1%})"
    yield from _fault_lines("correct attempts and checks that failed", report.faults)
    yield from _fault_lines("adversarial attempts that passed", report.adversarial_passes)
    yield from _fault_lines("differences between ground-truth perception and the evidence", report.disagreements)
    yield "sound" if report.sound else "NOT SOUND"


def _fault_lines(title: str, faults: Sequence[ValidationFault]) -> Iterator[str]:
    if faults:
        yield f"{title}: {len(faults)}"
    for fault in faults[:MAX_LISTED]:
        yield f"  {fault.task} [{fault.attempt}] {fault.reason}"
    if len(faults) > MAX_LISTED:
        yield f"  ... and {len(faults) - MAX_LISTED} more"
