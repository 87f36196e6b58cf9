"""Agents for tests: write them as modules, start them as an evaluation does, and run them without a camera."""

from __future__ import annotations

import os
import textwrap
import venv
from collections.abc import Callable
from pathlib import Path
from typing import Any

from scope_ptz.bench.agents.launch import AgentOptions
from scope_ptz.bench.agents.start import LocalAgent, local_agent
from scope_ptz.planner.base import CallTools, Exchange, Finish, State, ToolCall, ToolOutcome
from tests.bench.agents.conformance import STATE

Answer = Callable[[ToolCall], dict[str, Any]]

AGENT_SOURCE = """
{imports}

class Agent:
    sees = {sees}

    async def run(self, session):
{body}
"""


def write_agent(folder: Path, body: str, *, imports: str = "", sees: bool = False, module: str = "their_agent") -> str:
    """Write an agent as a module, and return its name."""
    indented = textwrap.indent(textwrap.dedent(body).strip(), " " * 8)
    (folder / f"{module}.py").write_text(AGENT_SOURCE.format(imports=textwrap.dedent(imports), sees=sees, body=indented))
    return f"{module}:Agent"


def local_agent_in(folder: Path, agent: str, options: AgentOptions | None = None, hidden: tuple[Path, ...] = ()) -> LocalAgent:
    """Return an agent whose working folder is ``folder``."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        return local_agent(agent, options or AgentOptions(), hidden)
    finally:
        os.chdir(before)


def create_environment(folder: Path) -> None:
    """Create an empty virtual environment."""
    venv.create(folder, symlinks=True)


async def run_to_reply(
    agent: LocalAgent, answer: Answer = lambda _: {}, state: State = STATE
) -> tuple[Finish, list[list[ToolCall]]]:
    """Run an agent until it replies, and return the reply and the calls of each step. A failure of the agent is raised."""
    planner, steps = await agent.open(), list[list[ToolCall]]()
    try:
        while True:
            decision = await planner.step(state)
            if isinstance(decision, Finish):
                return decision, steps
            assert isinstance(decision, CallTools)
            steps.append(list(decision.calls))
            outcomes = tuple(ToolOutcome(call=call, result=answer(call)) for call in decision.calls)
            state = state.model_copy(update={"history": (*state.history, Exchange(outcomes=outcomes))})
    finally:
        await planner.close()
