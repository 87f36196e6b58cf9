"""A new tool is one file and one line in a registry: schema, loop, trace and replay need no edit."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path

import anyio
import pytest
from pydantic import Field

from scope_ptz.agent.loop import Agent
from scope_ptz.agent.store import RunFolder
from scope_ptz.agent.trace import TraceWriter, read_trace
from scope_ptz.camera.base import Camera
from scope_ptz.errors import ToolCallError
from scope_ptz.tools.arguments import Arguments, Degrees
from scope_ptz.tools.context import ToolContext
from scope_ptz.tools.registry import TOOLS, ToolRegistry
from scope_ptz.tools.results import PoseData, Result
from scope_ptz.tools.schemas import stored_schemas
from scope_ptz.tools.tool import Tool
from tests.agent.scripted import ScriptedCamera, ScriptedPerception, ScriptedPlanner, answer, calls


class Wobble(Arguments):
    """Turn the camera a little to both sides and back."""

    by_deg: Degrees = Field(2.0, description="Degrees to each side.")


class WobbleResult(Result):
    """The number of turns of the camera."""

    turns: int


async def wobble(context: ToolContext, arguments: Wobble) -> WobbleResult:
    start = await context.camera.pose()
    for pan_deg in (arguments.by_deg, -arguments.by_deg, 0.0):
        await context.camera.move(start.turned(pan_deg=pan_deg))
    return WobbleResult(message="Wobbled.", pose=PoseData.of(start), turns=3)


EXTENDED = ToolRegistry(*TOOLS.values(), Tool("wobble", Wobble, wobble, moves=True))


def test_planners_get_its_schema_after_those_of_the_nine_tools() -> None:
    schemas = EXTENDED.schemas()
    assert schemas[:9] == TOOLS.schemas()
    assert schemas[9] == {
        "type": "function",
        "function": {
            "name": "wobble",
            "description": "Turn the camera a little to both sides and back.",
            "parameters": {
                "additionalProperties": False,
                "properties": {"by_deg": {"default": 2.0, "description": "Degrees to each side.", "type": "number"}},
                "type": "object",
            },
        },
    }


def test_its_properties_are_read_from_the_registry() -> None:
    assert EXTENDED.moving == TOOLS.moving | {"wobble"}
    assert EXTENDED.perceiving == TOOLS.perceiving
    assert EXTENDED["wobble"].defaults() == {"by_deg": 2.0}
    assert EXTENDED["wobble"].result_type() is WobbleResult
    assert all(issubclass(tool.result_type(), Result) for tool in TOOLS.values())
    with pytest.raises(ToolCallError, match=r"Wrong arguments for wobble: by_deg: .*It takes by_deg\."):
        EXTENDED.parse_call("wobble", {"by_deg": "far"})
    with pytest.raises(ToolCallError, match="There is no tool 'wobble'"):
        TOOLS.parse_call("wobble", {})


def test_the_loop_offers_and_runs_it_and_the_trace_keeps_it(tmp_path: Path) -> None:
    planner = ScriptedPlanner(calls(("wobble", {"by_deg": 5.0})), answer("Done."))
    camera: Camera = ScriptedCamera()
    folder = RunFolder.create(tmp_path, "wobble")

    async def work() -> None:
        agent = Agent(planner, camera, ScriptedPerception(), folder, tools=EXTENDED)
        with TraceWriter(folder.trace) as trace:
            await agent.run("wobble a little", listener=trace)

    anyio.run(work)
    assert [tool["function"]["name"] for tool in planner.states[0].tools] == [*TOOLS, "wobble"]
    (called,) = read_trace(folder.path).calls
    assert called.fault is None
    assert called.outcome.result is not None
    assert (called.outcome.result["message"], called.outcome.result["turns"]) == ("Wobbled.", 3)


def test_no_other_module_lists_the_tools() -> None:
    """A list with most of the nine names would have to be extended with the registry. Names in other formats may be listed."""
    source = Path(__file__).parents[2] / "src" / "scope_ptz"
    names = re.compile("|".join(rf'"{name}"' for name in TOOLS))
    lists = []
    for path in set(source.rglob("*.py")) - set((source / "taskgen" / "importing").glob("*.py")):
        for literal in re.findall(r"[\[({]([^\[\](){}]*)[\])}]", path.read_text()):
            if len(set(names.findall(literal))) >= 7:
                lists.append(f"{path.relative_to(source)}: {literal[:60]}")
    assert lists == []


def test_schemas_are_unchanged() -> None:
    """The digest covers every byte of the schemas. Scores are not comparable across a change."""
    text = json.dumps(TOOLS.schemas(), ensure_ascii=False)
    assert hashlib.sha256(text.encode()).hexdigest() == "a6a1b4179787f45017d0093f38ebbd4b727c4959ac9e4ef80cb229e7f0d6f2c2"


def test_the_shipped_schemas_are_up_to_date() -> None:
    assert stored_schemas() == TOOLS.schemas(), (
        'run: python -c "from scope_ptz.tools.schemas import write_stored_schemas; write_stored_schemas()"'
    )
    assert json.dumps(stored_schemas()) == json.dumps(TOOLS.schemas()), "the same, but in another order"
