"""A planner's server that misbehaves by a script, task by task, and notes what it did."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from tests.full.evaluation_sweep import asked
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
AGAIN = status(429, headers={"Retry-After": "0"})
GARBAGE = body('{"choices": [{"message": {"tool_calls": [1]}}]}')
OK = "answers"
BEHAVIOURS: dict[str, tuple[str, Behaviour]] = {
    "429": ("rate-limited", AGAIN),
    "is silent": ("timeout", slow_first_byte(600)),
    "stalls": ("timeout", stalls(600)),
    "hangs up": ("cut-off", reset()),
    "breaks off": ("cut-off", cut_off()),
    "half a JSON": ("malformed", malformed()),
    "garbage": ("malformed", GARBAGE),
    "nothing": ("empty", empty_choices()),
    "a web page": ("wrong-content-type", wrong_type()),
}
"""What the server does, and what the program calls it."""

SCRIPT = [
    ["429", "429", OK, OK],
    ["stalls"],
    [OK, "hangs up", OK],
    ["breaks off", OK, "half a JSON", OK],
    ["429", "429", "429"],
    ["garbage", OK, "nothing", OK],
    [OK, "is silent"],
    [OK, OK],
    ["a web page"],
    [OK, "half a JSON", "429", OK],
]
"""Task by task, in the order in which they are run. What comes after it is answered well."""
BROKEN = [row for row in SCRIPT if row[-1] != OK]


def ignores_pictures(request: Request) -> Say:
    if request.data["messages"][-1]["role"] == "tool":
        return Say("There is nothing to see.")
    return Say("", tool_calls=(("get_presets", {}),))


@dataclass
class Scripted:
    """A server that does what the script says, and notes for which task it did it."""

    script: list[str] = field(default_factory=list)
    did: list[tuple[str, str]] = field(default_factory=list)

    async def __call__(self, exchange: Exchange) -> None:
        if not exchange.request.chat:
            return await good()(exchange)
        act = self.script.pop(0) if self.script else OK
        self.did.append((asked(exchange.request), act))
        return await (BEHAVIOURS[act][1] if act != OK else good(ignores_pictures))(exchange)

    def failures(self, instruction: str) -> Counter[str]:
        """What went wrong at a task, as the program calls it."""
        return Counter(BEHAVIOURS[act][0] for words, act in self.did if words == instruction and act != OK)


def mentions(events: dict[str, int]) -> Counter[str]:
    """Failures of servers by kind; of the two timeouts it is chance which one comes first where both have the same limit."""
    counted = Counter[str]()
    for kind, number in events.items():
        counted["timeout" if kind.endswith("-timeout") else kind] += number
    return counted
