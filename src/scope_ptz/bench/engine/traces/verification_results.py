"""The results of verifying runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

Status = Literal["verified", "differs", "not-verifiable"]


@dataclass(frozen=True, slots=True)
class RunVerification:
    """The result of verifying a run.

    Attributes:
        run: Name of the run's sample.
        status: Whether the run matches its record, differs from it, or cannot be verified.
        differences: The differences, or the reason why the run cannot be verified.
        frames: Number of compared frames.
        replies: Whether perception replies were recomputed. Replies from models cannot be recomputed.
    """

    run: str
    status: Status
    differences: tuple[str, ...] = ()
    frames: int = 0
    replies: bool = False


@dataclass(frozen=True, slots=True)
class VerificationResult:
    """The results of verifying the runs of a log or a submission."""

    runs: tuple[RunVerification, ...] = ()

    def of(self, status: Status) -> list[RunVerification]:
        """Return the results with the given status."""
        return [run for run in self.runs if run.status == status]

    @property
    def summary(self) -> Iterator[str]:
        """The results as lines of text."""
        frames = sum(run.frames for run in self.runs)
        yield (
            f"{len(self.of('verified'))} of {len(self.runs)} runs verified, {len(self.of('differs'))} differ, "
            f"{len(self.of('not-verifiable'))} not verifiable; {frames} frames compared"
        )
        only_poses = sum(not run.replies for run in self.of("verified"))
        if only_poses:
            yield f"{only_poses} verified runs used model perception, so their poses and frames were verified, not the replies"
        reasons: dict[str, int] = {}
        for run in self.of("not-verifiable"):
            for reason in run.differences[:1]:
                reasons[reason] = reasons.get(reason, 0) + 1
        yield from (f"not verifiable: {reason} ({number} runs)" for reason, number in reasons.items())

    def as_dict(self) -> dict[str, Any]:
        """Return the results as JSON data."""
        return {
            "runs": len(self.runs),
            **{status.replace("-", "_"): len(self.of(status)) for status in ("verified", "differs", "not-verifiable")},
            "frames": sum(run.frames for run in self.runs),
            "each": [
                {"run": r.run, "status": r.status, "differences": list(r.differences), "frames": r.frames, "replies": r.replies}
                for r in self.runs
            ],
        }
