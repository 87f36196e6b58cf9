"""The one executable check of imported tasks: whether the expected tools were called."""

from __future__ import annotations

from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.scoring.matching import fits, in_any_order, in_order
from scope_ptz.bench.scoring.trials import Check
from scope_ptz.bench.tasks.imported import ImportedTask

NAME = "calls"


def check_calls_of(imported: ImportedTask, episode: Episode) -> Check:
    """Whether a run made the expected calls. It cannot be told where the file expects none."""
    wanted = imported.calls
    if not wanted or imported.policy == "none":
        return Check(name=NAME, passed=None, reason="the file demands no tools")
    if imported.policy == "any":
        found = any(fits(spec, call) for spec in wanted for call in episode.calls)
        reason = "one of the expected tools was used" if found else f"none of {', '.join(spec.tool for spec in wanted)} succeeded"
        return Check(name=NAME, passed=found, reason=reason)
    missing = (in_order if imported.order == "ordered" else in_any_order)(wanted, episode.calls)
    if missing is not None:
        return Check(name=NAME, passed=False, reason=missing)
    strangers = {call.name for call in episode.calls if call.succeeded} - {spec.tool for spec in wanted}
    if imported.policy == "exact" and strangers:
        return Check(name=NAME, passed=False, reason=f"only the expected tools may be used, and {', '.join(sorted(strangers))} was")
    return Check(name=NAME, passed=True, reason="every expected call was made")
