"""Measure the hybrid planner on the test instructions: which part plans, how long it takes, and which calls need a confirmation.

    python -m benchmarks.hybrid_planner [--lot NAME] [--planner-url URL [--planner-model NAME] [--limit N]]

Without a server, two scripted models plan the instructions that the grammar does not understand. The expert model makes the
expected calls of each instruction. The random model makes a random move. With ``--planner-url``, the served model plans instead. A
move counts as wrong if it is carried out without a confirmation although the instruction does not ask for it. Only first steps are
planned.
"""

from __future__ import annotations

import argparse
import random
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from statistics import median, quantiles
from typing import Any

import anyio
from tests.planner.lots import FILES, Row, rows

from scope_ptz.endpoints.endpoint import Endpoint
from scope_ptz.errors import PlannerError, ToolCallError
from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.base import Briefing, CallTools, Decision, Finish, Planner, State, ToolCall
from scope_ptz.planner.chat import ChatOptions, ChatPlanner
from scope_ptz.planner.hybrid import HybridPlanner
from scope_ptz.tools.registry import TOOLS

SEED = 1
MAX_DEGREES = 170


class ScriptedModel(Planner):
    """A fake language model. Its calls depend only on the row of the instruction."""

    def __init__(self, name: str, calls_for: Callable[[Row], Sequence[ToolCall]]) -> None:
        self.name, self._calls_for = name, calls_for
        self.row: Row | None = None

    async def step(self, state: State) -> Decision:  # noqa: ARG002 - the contract
        calls = tuple(self._calls_for(self.row)) if self.row is not None else ()
        return CallTools(calls=calls) if calls else Finish(kind="answered", text="I do not know.")


@dataclass
class Tally:
    """The number of instructions by outcome, and the durations of their first steps in seconds."""

    by_grammar: int = 0
    carried_out: int = 0
    asked: int = 0
    other: int = 0
    failed: int = 0
    wrong_moves: list[str] = field(default_factory=list)
    grammar_s: list[float] = field(default_factory=list)
    model_s: list[float] = field(default_factory=list)


def main() -> None:
    """Print one block for each model."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lot", choices=FILES, help="use only this lot")
    parser.add_argument("--planner-url", help="address of a chat server, ending in /v1")
    parser.add_argument("--planner-model", default="", help="name of the model on the server")
    parser.add_argument("--limit", type=int, help="use at most this many instructions, evenly spread")
    options = parser.parse_args()
    chosen = [row for lot in ([options.lot] if options.lot else FILES) for row in rows(lot)]
    if options.limit:
        chosen = chosen[:: max(1, len(chosen) // options.limit)][: options.limit]
    models: list[Planner] = [ScriptedModel("expert", _expected_calls), ScriptedModel("random", _random_call)]
    if options.planner_url:
        models = [ChatPlanner(Endpoint(url=options.planner_url, model=options.planner_model), ChatOptions())]
    for model in models:
        _print_tally(model.name, len(chosen), anyio.run(_measure, model, chosen))


def _expected_calls(row: Row) -> Sequence[ToolCall]:
    known = [
        call for call in row.calls if call["name"] in TOOLS and not any(isinstance(v, dict) for v in call["arguments"].values())
    ]
    return [ToolCall(id=f"c{i}", name=call["name"], arguments=call["arguments"]) for i, call in enumerate(known)]


def _random_call(row: Row) -> Sequence[ToolCall]:
    rng = random.Random(f"{SEED} {row.instruction}")
    name = rng.choice(("adjust_ptz", "go_to_preset", "go_home", "zoom_to_object"))
    degrees = rng.choice((-1, 1)) * rng.randint(1, MAX_DEGREES)
    choices: dict[str, dict[str, Any]] = {
        "adjust_ptz": {rng.choice(("pan_deg", "tilt_deg")): degrees},
        "go_to_preset": {"name": rng.choice(row.presets or ("home",))},
        "go_home": {},
        "zoom_to_object": {"description": rng.choice(("van", "person", "red car", "gate"))},
    }
    return [ToolCall(id="c0", name=name, arguments=choices[name])]


async def _measure(model: Planner, chosen: Sequence[Row]) -> Tally:
    tally, planner = Tally(), HybridPlanner(model)
    for row in chosen:
        if isinstance(model, ScriptedModel):
            model.row = row
        briefing = Briefing(presets=row.presets, pose=Pose(), limits=Limits(), simulated=True)
        state = State(instruction=row.instruction, briefing=briefing, tools=tuple(TOOLS.schemas()))
        start = time.perf_counter()
        try:
            decision = await planner.step(state)
        except PlannerError:
            tally.failed += 1
            continue
        seconds = time.perf_counter() - start
        if decision.planned_by == "grammar":
            tally.by_grammar += 1
            tally.grammar_s.append(seconds)
            continue
        tally.model_s.append(seconds)
        if isinstance(decision, CallTools):
            tally.carried_out += 1
            tally.wrong_moves += [f"{row.instruction!r}: {c.name}({c.arguments})" for c in decision.calls if _is_wrong_move(c, row)]
        elif "Shall I do this: " in decision.text:
            tally.asked += 1
        else:
            tally.other += 1
    await planner.close()
    return tally


def _is_wrong_move(call: ToolCall, row: Row) -> bool:
    """Return whether a valid call moves the camera although the row does not expect the call."""
    if call.name not in TOOLS.moving or call.problem is not None:
        return False
    try:
        TOOLS.parse_call(call.name, call.arguments)
    except ToolCallError:
        return False  # the tool refuses the call
    return not any(call.name == expected["name"] and call.arguments == expected["arguments"] for expected in row.calls)


def _print_tally(name: str, total: int, tally: Tally) -> None:
    print(f"{name}: {total} instructions")
    print(f"  planned without the model    {tally.by_grammar:>5}  {tally.by_grammar / total:.1%}")
    print(f"  model, carried out           {tally.carried_out:>5}")
    print(f"  model, confirmation asked    {tally.asked:>5}")
    print(f"  model, answered or asked     {tally.other:>5}")
    print(f"  model, no usable reply       {tally.failed:>5}")
    print(f"  wrong moves                  {len(tally.wrong_moves):>5}")
    for label, seconds in (("without", tally.grammar_s), ("with", tally.model_s)):
        if len(seconds) > 1:
            p99 = quantiles(seconds, n=100)[98]
            print(f"  first step {label} the model: median {1000 * median(seconds):.1f} ms, 99th percentile {1000 * p99:.1f} ms")
    print("".join(f"    {move}\n" for move in tally.wrong_moves), end="")


if __name__ == "__main__":
    main()
