"""A planner server that misbehaves as scripted, task by task, and records its behaviour."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from tests.full.evaluation_sweep import instruction_of
from tests.support.misbehaving import (
    Behaviour,
    Exchange,
    Request,
    Say,
    body,
    cut_off,
    empty_choices,
    good,
    malformed,
    reset,
    slow_first_byte,
    stalls,
    status,
    wrong_type,
)

LIMIT = 12
RATE_LIMITED = status(429, headers={"Retry-After": "0"})
GARBAGE = body('{"choices": [{"message": {"tool_calls": [1]}}]}')
OK = "answers"
BEHAVIOURS: dict[str, tuple[str, Behaviour]] = {
    "429": ("rate-limited", RATE_LIMITED),
    "is silent": ("timeout", slow_first_byte(600)),
    "stalls": ("timeout", stalls(600)),
    "resets": ("cut-off", reset()),
    "cuts off": ("cut-off", cut_off()),
    "truncated JSON": ("malformed", malformed()),
    "garbage": ("malformed", GARBAGE),
    "nothing": ("empty", empty_choices()),
    "a web page": ("wrong-content-type", wrong_type()),
}
"""Behaviours of the server by name, each with the program's name for the failure."""

SCRIPT = [
    ["429", "429", OK, OK],
    ["stalls"],
    [OK, "resets", OK],
    ["cuts off", OK, "truncated JSON", OK],
    ["429", "429", "429"],
    ["garbage", OK, "nothing", OK],
    [OK, "is silent"],
    [OK, OK],
    ["a web page"],
    [OK, "truncated JSON", "429", OK],
]
"""The behaviours for each task, in execution order. All later requests get valid replies."""
FAILING_ROWS = [row for row in SCRIPT if row[-1] != OK]


def reply_without_perception(request: Request) -> Say:
    if request.data["messages"][-1]["role"] == "tool":
        return Say("There is nothing to see.")
    return Say("", tool_calls=(("get_presets", {}),))


@dataclass
class ScriptedBehaviour:
    """The behaviour of a server that follows a script. ``record`` contains pairs of instruction and behaviour."""

    script: list[str] = field(default_factory=list)
    record: list[tuple[str, str]] = field(default_factory=list)

    async def __call__(self, exchange: Exchange) -> None:
        if not exchange.request.chat:
            return await good()(exchange)
        act = self.script.pop(0) if self.script else OK
        self.record.append((instruction_of(exchange.request), act))
        return await (BEHAVIOURS[act][1] if act != OK else good(reply_without_perception))(exchange)

    def failures(self, instruction: str) -> Counter[str]:
        """Return the failures of a task under the program's names."""
        return Counter(
            BEHAVIOURS[act][0] for asked_instruction, act in self.record if asked_instruction == instruction and act != OK
        )


def failures_by_kind(events: dict[str, int]) -> Counter[str]:
    """Return server failures by kind. Timeouts are merged, because two timeouts with equal limits can expire in either order."""
    counts = Counter[str]()
    for kind, number in events.items():
        counts["timeout" if kind.endswith("-timeout") else kind] += number
    return counts
