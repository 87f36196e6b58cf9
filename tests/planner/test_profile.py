"""Prompt sensitivity of planners: the measurement, applied to planners with known faults."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from scope_ptz.errors import PlannerError
from scope_ptz.planner.base import CallTools, Decision, Planner, State
from scope_ptz.planner.chat.prompts import Prompt, load_prompt, prompt_names
from scope_ptz.planner.grammar import GrammarPlanner
from scope_ptz.planner.plan import plan
from scope_ptz.planner.profile import INSTRUCTION_EDITS, PROMPT_EDITS, InstructionRow, Sensitivity, load_rows, measure_sensitivity
from scope_ptz.planner.profile.first_calls import PRESETS, CallRecord, is_expected_call, is_inverted
from scope_ptz.planner.profile.prompt_sensitivity import Rate

pytestmark = pytest.mark.anyio
PROMPT = load_prompt()
ROWS = load_rows()
TURN = InstructionRow(instruction="pan left 20", kind="move", calls=(CallRecord(name="adjust_ptz", arguments={"pan_deg": -20}),))


class Altered(Planner):
    """The grammar planner with modified calls."""

    name = "altered"

    def __init__(self, alter: Callable[[State, Decision], Decision] = lambda _, decision: decision) -> None:
        self._grammar, self._alter = GrammarPlanner(), alter

    async def step(self, state: State) -> Decision:
        return self._alter(state, await self._grammar.step(state))


async def measure(
    make: Callable[[Prompt], Planner], rows: tuple[InstructionRow, ...] = ROWS[::6], **options: object
) -> Sensitivity:
    return await measure_sensitivity(make, PROMPT, rows=rows, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.instruction)
def test_the_grammar_plans_the_packaged_instructions_as_expected(row: InstructionRow) -> None:
    made = plan(row.instruction, PRESETS)
    assert [call.name for call in made.calls] == [call.name for call in row.calls]
    assert is_expected_call(row, CallRecord(name=made.calls[0].name, arguments=made.calls[0].arguments))


def test_the_instructions_are_balanced_between_directions() -> None:
    pans = [c.arguments["pan_deg"] for row in ROWS for c in row.calls[:1] if "pan_deg" in c.arguments]
    assert len(ROWS) == 60
    assert abs(sum(p > 0 for p in pans) - sum(p < 0 for p in pans)) <= 3


def test_edits_keep_directions_and_numbers() -> None:
    for edit in INSTRUCTION_EDITS:
        assert any(edit.apply(row.instruction) != row.instruction for row in ROWS), edit.name
        for row in ROWS:
            edited = edit.apply(row.instruction).lower()
            for word in re.findall(r"\b(?:left|right|up|down|in|out|gate|highway)\b", row.instruction.lower()):
                assert word in edited, (edit.name, edited)
    for edit in PROMPT_EDITS:
        for name in prompt_names():
            edited = edit.apply(load_prompt(name).text)
            assert "$presets" in edited
            assert "ositive" in edited
        assert edit.apply(PROMPT.text) != PROMPT.text, edit.name


async def test_a_planner_that_does_not_depend_on_wording_is_reported_as_such() -> None:
    calls: list[tuple[int, int]] = []
    report = await measure(lambda _: Altered(), edits=PROMPT_EDITS, progress=lambda done, of: calls.append((done, of)))
    assert (report.valid.share, report.right.share, report.inverted.count, report.failed.count) == (1.0, 1.0, 0, 0)
    assert (report.noise.count, report.by_prompt.count, report.inverted_anywhere.count) == (0, 0, 0)
    assert len(report.edits) == len(PROMPT_EDITS)
    assert calls[-1] == (len(calls), len(calls)) == (120, 120)


async def test_inverted_moves_are_found() -> None:
    def invert_turns(state: State, decision: Decision) -> Decision:
        if not isinstance(decision, CallTools) or "please" not in state.instruction.lower():
            return decision
        turned = {k: -v if k in ("pan_deg", "tilt_deg") else v for k, v in decision.calls[0].arguments.items()}
        return CallTools(calls=(decision.calls[0].model_copy(update={"arguments": turned}),))

    report = await measure(lambda _: Altered(invert_turns), rows=(TURN,), edits=INSTRUCTION_EDITS)
    assert report.inverted.count == 0
    assert report.inverted_anywhere.count == 2
    assert {e.edit for e in report.edits if e.inverted.count} == {"please first", "please last"}
    assert "adjust_ptz(pan_deg=20)" in report.inversions[0]


async def test_a_planner_that_depends_on_its_prompt_is_detected() -> None:
    def go_home(_: State, decision: Decision) -> Decision:
        assert isinstance(decision, CallTools)
        return CallTools(calls=(decision.calls[0].model_copy(update={"name": "go_home", "arguments": {}}),))

    def make(prompt: Prompt) -> Planner:
        return Altered(go_home) if "assistant" in prompt.text else Altered()

    report = await measure(make, rows=ROWS[:5], edits=PROMPT_EDITS)
    changed = {e.edit: e.tools_changed.count for e in report.edits if e.tools_changed.count}
    assert changed == {"assistant sentence first": 5}
    assert report.by_prompt.share == round(1 / len(PROMPT_EDITS), 4)


async def test_failures_and_wrong_calls_are_counted_separately() -> None:
    def spoil(state: State, decision: Decision) -> Decision:
        assert isinstance(decision, CallTools)
        if "left" in state.instruction:
            raise PlannerError("the connection failed", kind="refused")
        return CallTools(calls=(decision.calls[0].model_copy(update={"arguments": {"speed": 1}}),))

    report = await measure(lambda _: Altered(spoil), rows=ROWS[:2], edits=())
    assert (report.failed.count, report.valid.count, report.right.count) == (1, 0, 0)
    assert report.valid.of == report.right.of == 1


async def test_a_failing_server_does_not_count_as_a_changed_choice() -> None:
    def fail_to_connect(state: State, decision: Decision) -> Decision:
        raise PlannerError("the connection failed", kind="refused")

    def make(prompt: Prompt) -> Planner:
        return Altered(fail_to_connect) if "assistant" in prompt.text else Altered()

    report = await measure(make, rows=ROWS[:5], edits=PROMPT_EDITS)
    assert report.by_prompt.count == 0
    assert report.by_prompt.of == 5 * (len(PROMPT_EDITS) - 1)
    assert {e.edit: e.tools_changed.of for e in report.edits}["assistant sentence first"] == 0


def test_inversion_and_rates() -> None:
    assert is_inverted(TURN, [CallRecord(name="adjust_ptz", arguments={"pan_deg": 20})])
    assert not is_inverted(TURN, [CallRecord(name="adjust_ptz", arguments={"pan_deg": -90})])
    assert not is_inverted(TURN, [CallRecord(name="go_home")])
    out = InstructionRow(
        instruction="zoom out", kind="zoom", calls=(CallRecord(name="adjust_ptz", arguments={"zoom_limit": "out"}),)
    )
    assert is_inverted(out, [CallRecord(name="adjust_ptz", arguments={"zoom_factor": 2})])
    assert not is_inverted(out, [CallRecord(name="adjust_ptz", arguments={"zoom_percent": -50})])
    assert Rate.over([]) == Rate(count=0, of=0, share=None, low=None, high=None)
    rate = Rate.over([True, False, False, False])
    assert rate.low is not None
    assert rate.high is not None
    assert 0 < rate.low < 0.25 < rate.high < 1


def test_expected_texts_may_be_lists_of_words() -> None:
    words = {"question": {"contains": ["gantry sign"]}, "view": "current"}
    row = InstructionRow(instruction="read it", kind="object", calls=(CallRecord(name="query_answer", arguments=words),))
    assert is_expected_call(row, CallRecord(name="query_answer", arguments={"question": "What does it say?"}))
    assert not is_expected_call(row, CallRecord(name="query_answer", arguments={"question": "What does it say?", "view": "full"}))
    row = InstructionRow(
        instruction="go",
        kind="object",
        calls=(CallRecord(name="zoom_to_object", arguments={"description": {"contains": ["van"]}}),),
    )
    assert is_expected_call(row, CallRecord(name="zoom_to_object", arguments={"description": "the white van"}))
    assert not is_expected_call(row, CallRecord(name="zoom_to_object", arguments={"description": "the lorry"}))
    wrong = InstructionRow(instruction="go", kind="move", calls=(CallRecord(name="adjust_ptz", arguments={"speed": 1}),))
    assert not is_expected_call(wrong, CallRecord(name="adjust_ptz", arguments={"pan_deg": 1}))
    assert not is_inverted(wrong, [CallRecord(name="adjust_ptz", arguments={"pan_deg": 1})])
