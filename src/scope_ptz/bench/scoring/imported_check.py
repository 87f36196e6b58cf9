"""The only executable check for imported tasks: whether the expected calls were made."""

from __future__ import annotations

from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.required_calls import matches_required_call, missing_in_any_order, missing_in_order
from scope_ptz.bench.scoring.trials import CheckRecord
from scope_ptz.bench.tasks.imported import ImportedTask

CHECK_NAME = "calls"


def check_imported_calls(imported: ImportedTask, episode: Episode) -> CheckRecord:
    """Check that a run made the calls that an imported task expects. Without expected calls, the check cannot decide."""
    required = imported.calls
    if not required or imported.policy == "none":
        return CheckRecord(name=CHECK_NAME, passed=None, reason="the file demands no tools")
    if imported.policy == "any":
        passed = any(matches_required_call(spec, call) for spec in required for call in episode.calls)
        reason = (
            "one of the expected tools was used" if passed else f"none of {', '.join(spec.tool for spec in required)} succeeded"
        )
        return CheckRecord(name=CHECK_NAME, passed=passed, reason=reason)
    missing = (missing_in_order if imported.order == "ordered" else missing_in_any_order)(required, episode.calls)
    if missing is not None:
        return CheckRecord(name=CHECK_NAME, passed=False, reason=missing)
    unexpected = {call.name for call in episode.calls if call.succeeded} - {spec.tool for spec in required}
    if imported.policy == "exact" and unexpected:
        return CheckRecord(
            name=CHECK_NAME, passed=False, reason=f"only the expected tools may be used, and {', '.join(sorted(unexpected))} was"
        )
    return CheckRecord(name=CHECK_NAME, passed=True, reason="every expected call was made")
