"""The results of verifying runs, and their description."""

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
        status: Whether the run came out as recorded, differs, or cannot be verified.
        differences: What differs, or why the run cannot be verified.
        frames: Number of frames that were compared.
        replies: Whether perception replies were computed again. Those of models cannot be.
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
        """Return the results with a status."""
        return [run for run in self.runs if run.status == status]

    @property
    def summary(self) -> Iterator[str]:
        """The result as lines of text."""
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
        """Return the result as JSON data."""
        return {
            "runs": len(self.runs),
            **{status.replace("-", "_"): len(self.of(status)) for status in ("verified", "differs", "not-verifiable")},
            "frames": sum(run.frames for run in self.runs),
            "each": [
                {"run": r.run, "status": r.status, "differences": list(r.differences), "frames": r.frames, "replies": r.replies}
                for r in self.runs
            ],
        }
