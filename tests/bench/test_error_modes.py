"""Error modes: inserted faults and obvious cases get the expected mode."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.scoring.episode import Episode, Observation
from scope_ptz.bench.scoring.error_modes import ErrorMode, error_mode
from scope_ptz.bench.scoring.verdict import score_episode
from scope_ptz.bench.tasks.expected import ActionOnly, Choice, Number, Text
from scope_ptz.bench.tasks.task import Argument, Behaviour, Item, RequiredCall, Task
from scope_ptz.taskgen.gold.mutations import FaultContext, GoldRun, count_assigned_modes, mutate
from tests.bench.sample_runs import (
    FRAME,
    GO_BRIDGE,
    GO_HIGHWAY,
    PRESETS,
    SIGN_BOX,
    START,
    Step,
    count_step,
    play,
    query_step,
    samples,
    task,
    view,
)

SAMPLES = samples()
BY_NAME = {scored_task.id.removeprefix("scope1-test-"): scored_task for scored_task, _ in SAMPLES}
CONTEXT = FaultContext(PRESETS, FRAME)


def gold() -> list[GoldRun]:
    candidates = (
        mutate(scored_task, episode, mode, CONTEXT, random.Random(seed))
        for scored_task, episode in SAMPLES
        for mode in ErrorMode
        for seed in range(4)
    )
    return [one for one in candidates if one is not None]


def test_every_known_fault_has_its_mode_and_none_passes() -> None:
    runs = gold()
    matrix = count_assigned_modes(runs)
    assert len(runs) >= 200
    assert {mode for mode, _ in matrix} == set(ErrorMode)
    assert {(mode, named): n for (mode, named), n in matrix.items() if mode != named} == {}


def test_a_run_that_passes_or_cannot_be_scored_has_no_mode() -> None:
    for scored_task, episode in SAMPLES:
        assert error_mode(scored_task, episode) is None
    scored_task, episode = SAMPLES[0]
    assert error_mode(scored_task, replace(episode, answer="several cones")) is None
    assert error_mode(scored_task, replace(episode, outcome="camera_error")) is None


FAILED_COUNT: Step = ("count_objects", {"description": "cones", "view": "current"}, {"error": "timeout", "fault": "perception"})
WRONG_PRESET: Step = ("go_to_preset", {"name": "motorway"}, {"error": "no such preset"})
FULL_CARS: Step = count_step(12, "cars", "full")
UNKNOWN_COLOUR: dict[str, object] = {"answer": "I cannot tell: there is no van in view", "known": False, "view": "current"}
NO_ANSWER: Step = ("query_answer", {"question": "What colour is the van?", "view": "current"}, UNKNOWN_COLOUR)
TO_SIGN = {"found": True, "matches": 1, "chosen": "sign", "pose": {"pan_deg": 22.0, "tilt_deg": -5.0, "zoom": 5.0}}
TO_SKY = TO_SIGN | {"pose": {"pan_deg": 60.0, "tilt_deg": 15.0, "zoom": 5.0}}
ZOOM_HOME: list[Step] = [("zoom_to_object", {"description": "the sign"}, TO_SIGN), ("go_home", {})]


@pytest.mark.parametrize(
    ("name", "steps", "text", "mode"),
    [
        ("counting-001", [], "There are 5 cones.", ErrorMode.LACK_OF_TOOL_CALL),
        ("counting-001", [count_step(5)], "There are 5 cones.", ErrorMode.LACK_OF_TOOL_CALL),
        ("counting-001", [GO_HIGHWAY], "There are 5 cones.", ErrorMode.LACK_OF_TOOL_CALL),
        ("counting-001", [GO_HIGHWAY, ("take_image", {})], "There are 5 cones.", ErrorMode.TOOL_ROUTING),
        ("counting-001", [WRONG_PRESET, count_step(5)], "There are 5 cones.", ErrorMode.TOOL_ARGS),
        ("counting-001", [GO_BRIDGE, count_step(5)], "There are 5 cones.", ErrorMode.TOOL_ARGS),
        ("counting-001", [GO_HIGHWAY, count_step(9, "cars")], "There are 9 cones.", ErrorMode.TOOL_ARGS),
        ("counting-001", [GO_HIGHWAY, count_step(8, view="full")], "There are 8 cones.", ErrorMode.SCOPE),
        ("counting-001", [GO_HIGHWAY, count_step(4)], "There are 4 cones.", ErrorMode.VLM_COUNTING),
        ("counting-001", [GO_HIGHWAY, query_step("four cones", "How many cones?")], "Four cones.", ErrorMode.VLM_COUNTING),
        ("counting-001", [GO_HIGHWAY, count_step(5)], "There are 7 cones.", ErrorMode.HALLUCINATION),
        ("counting-001", [GO_HIGHWAY, FAILED_COUNT], "There are 7 cones.", ErrorMode.HALLUCINATION),
        ("counting-001", [GO_HIGHWAY, FAILED_COUNT], "There are 5 cones.", ErrorMode.HALLUCINATION),
        ("counting-001", [GO_HIGHWAY, count_step(5)], "I cannot tell.", ErrorMode.REASONING),
        ("counting-002", [count_step(3, "cars")], "There are 3 cars.", ErrorMode.SCOPE),
        ("counting-002", [count_step(11, "cars", "full")], "There are 11 cars.", ErrorMode.VLM_COUNTING),
        ("counting-002", [FULL_CARS, count_step(3, "cars")], "There are 3 cars.", ErrorMode.REASONING),
        (
            "descriptor-003",
            [GO_BRIDGE, query_step("The van is blue.", "What colour is the van?")],
            "It is blue.",
            ErrorMode.VLM_QUERY,
        ),
        (
            "descriptor-003",
            [GO_BRIDGE, query_step("The van is red.", "What colour is the van?")],
            "It is blue.",
            ErrorMode.HALLUCINATION,
        ),
        ("descriptor-003", [query_step("The van is red.", "What colour is the van?")], "It is red.", ErrorMode.LACK_OF_TOOL_CALL),
        ("ocr-004", [query_step("ROAD CLOSED", "What does the sign say?")], "ROAD CLOSED", ErrorMode.LACK_OF_TOOL_CALL),
        ("location-005", [GO_HIGHWAY, count_step(2, "bicycles")], "There are 2 bicycles.", ErrorMode.VLM_COUNTING),
        ("location-005", [GO_HIGHWAY, count_step(0, "bicycles")], "Yes, there is a bicycle.", ErrorMode.HALLUCINATION),
        ("location-006", [GO_HIGHWAY, count_step(1, "van")], "No, there is no van.", ErrorMode.REASONING),
        ("location-006", [GO_HIGHWAY, count_step(0, "van")], "No, there is no van.", ErrorMode.VLM_COUNTING),
        (
            "comparative-007",
            [count_step(5, "cars"), GO_HIGHWAY, count_step(3, "cars")],
            "The highway has more cars.",
            ErrorMode.REASONING,
        ),
        (
            "comparative-007",
            [count_step(2, "cars"), GO_HIGHWAY, count_step(3, "cars")],
            "The highway has more cars.",
            ErrorMode.VLM_COUNTING,
        ),
        ("comparative-007", [count_step(5, "cars")], "The gate has more cars.", ErrorMode.LACK_OF_TOOL_CALL),
        ("single-call-009", [("adjust_ptz", {"pan_deg": -20.0, "tilt_deg": -10.0})], "Done.", ErrorMode.TOOL_ARGS),
        ("single-call-009", [], "Done.", ErrorMode.LACK_OF_TOOL_CALL),
        ("single-call-009", [GO_HIGHWAY], "Done.", ErrorMode.TOOL_ROUTING),
        ("single-call-009", [("take_image", {})], "Done.", ErrorMode.TOOL_ROUTING),
        ("multi-step-command-010", [GO_HIGHWAY, ("go_home", {})], "Done.", ErrorMode.LACK_OF_TOOL_CALL),
        ("multi-step-command-010", [("take_image", {}), GO_HIGHWAY, ("go_home", {})], "Done.", ErrorMode.TOOL_ROUTING),
        ("multi-step-command-010", [GO_BRIDGE, ("take_image", {}), ("go_home", {})], "Done.", ErrorMode.TOOL_ARGS),
        ("single-call-011", [("adjust_ptz", {"zoom_factor": 3.0})], "Done.", ErrorMode.TOOL_ROUTING),
        (
            "single-call-011",
            [("zoom_to_object", {"description": "the sign"}, {"found": False, "matches": 0})],
            "It is not there.",
            ErrorMode.VLM_QUERY,
        ),
        # The right question in the right view got no answer, so the failure is not one of aiming.
        ("descriptor-003", [GO_BRIDGE, NO_ANSWER], "I cannot tell: there is no van in view.", ErrorMode.VLM_QUERY),
        ("descriptor-003", [GO_BRIDGE, NO_ANSWER], "The van is blue.", ErrorMode.HALLUCINATION),
        ("descriptor-003", [GO_HIGHWAY, NO_ANSWER], "I cannot tell: there is no van in view.", ErrorMode.TOOL_ARGS),
        # The search succeeded or had another target, so the agent is responsible for the final pose.
        ("single-call-011", ZOOM_HOME, "Done.", ErrorMode.TOOL_ARGS),
        ("single-call-011", [("zoom_to_object", {"description": "the sign"}, TO_SKY)], "Done.", ErrorMode.VLM_QUERY),
        ("single-call-011", [("zoom_to_object", {"description": "a person"}, TO_SKY)], "Done.", ErrorMode.TOOL_ARGS),
        # A search is relevant even while the text is too small to read.
        (
            "ocr-004",
            [
                ("zoom_to_object", {"description": "the sign"}, {"found": False, "matches": 0}),
                query_step("ROAD", "What does the sign say?"),
            ],
            "It says ROAD.",
            ErrorMode.VLM_QUERY,
        ),
        # With one question per machine, only the reply about that machine counts.
        (
            "descriptor-013",
            [GO_HIGHWAY, query_step("Yes, there is an excavator.", "Is there an excavator?")],
            "An excavator, nothing else.",
            ErrorMode.REASONING,
        ),
        (
            "descriptor-013",
            [
                GO_HIGHWAY,
                query_step("Yes, there is an excavator.", "Is there an excavator?"),
                query_step("No.", "Is there a roller?"),
            ],
            "An excavator, nothing else.",
            ErrorMode.VLM_QUERY,
        ),
        (
            "descriptor-013",
            [
                GO_HIGHWAY,
                query_step("Yes.", "Is there an excavator?"),
                query_step("Yes.", "Is there a roller?"),
                query_step("Yes.", "Is there a van?"),
            ],
            "An excavator, a roller and a van.",
            ErrorMode.VLM_QUERY,
        ),
        (
            "descriptor-013",
            [
                GO_HIGHWAY,
                query_step("There is no van in view.", "Is there a van?"),
                query_step("an excavator", "Which machines are there?"),
            ],
            "An excavator and a van.",
            ErrorMode.HALLUCINATION,
        ),
    ],
)
def test_obvious_cases(name: str, steps: list[Step], text: str, mode: ErrorMode) -> None:
    assert error_mode(BY_NAME[name], play(steps, text)) is mode


def test_ground_truth_of_the_observed_view_takes_precedence_over_evidence() -> None:
    """A count in another view is compared with the ground truth of that view, which the evidence does not include."""
    scored_task: Task = BY_NAME["comparative-007"]
    extra = play(
        [count_step(5, "cars"), GO_BRIDGE, count_step(9, "cars"), GO_HIGHWAY, count_step(3, "cars")], "The highway has more."
    )
    assert error_mode(scored_task, extra) is ErrorMode.REASONING

    def true_count(observation: Observation) -> int | None:
        return {"mast": None, "bridge": 8}.get(observation.viewpoint or "")

    assert error_mode(scored_task, extra, true_count) is ErrorMode.VLM_COUNTING
    assert (
        error_mode(scored_task, extra, lambda observation: 9 if observation.viewpoint == "bridge" else None) is ErrorMode.REASONING
    )


def test_a_correct_perception_reply_about_one_of_two_objects_is_not_an_error_about_both() -> None:
    which = Choice(value="van", options={"van": (), "sign": ()}, picks=("nearer",))
    scored_task = task(
        98, "comparative", which, [query_step("6 m", "How far is the van?")],
        evidence=[view(START, items=[Item(instance=one, box_deg=SIGN_BOX) for one in ("van-01", "sign-02")], shows=which)],
    )  # fmt: skip
    far, near = (
        query_step("The sign is 9 m away.", "How far is the sign?"),
        query_step("The van is 6 m away.", "How far is the van?"),
    )
    denied = query_step("There is no van in view.", "How far is the van?")
    assert error_mode(scored_task, play([far, near], "The sign is nearer.")) is ErrorMode.REASONING
    assert error_mode(scored_task, play([far, denied], "The sign is nearer.")) is ErrorMode.VLM_QUERY


def test_words_of_several_texts_are_grounded_in_different_perception_calls() -> None:
    both = Text(accepted=("A482 / Harrowfield",), ocr=True)
    scored_task = task(97, "ocr", both, [query_step("A482", "What does it say?")], evidence=[view(START, shows=both)])
    queries = [
        query_step("It says A483.", "What does the upper line say?"),
        query_step("It says HARROWFIELD.", "And the lower one?"),
    ]
    assert error_mode(scored_task, play(queries, 'It says "A483" and "HARROWFIELD".')) is ErrorMode.VLM_QUERY


def test_an_unfound_target_is_a_perception_error_and_an_unrequested_one_is_an_agent_error() -> None:
    van = Argument(mentions=("van",))
    calls = (RequiredCall(tool="track_object", arguments={"description": van}),)
    track = task(
        99, "single_call", ActionOnly(), [("track_object", {"description": "white van"})], behaviour=Behaviour(calls=calls)
    )

    def tracking_run(description: str, found: bool) -> Episode:
        return play([("track_object", {"description": description}, {"found": found, "held_share": float(found)})], "Done.")

    assert error_mode(track, tracking_run("the van", True)) is None
    assert error_mode(track, tracking_run("the van", False)) is ErrorMode.VLM_QUERY
    assert error_mode(track, tracking_run("the bus", True)) is ErrorMode.TOOL_ARGS


PERCEPTION_MODES = {ErrorMode.VLM_COUNTING, ErrorMode.VLM_QUERY}


def test_exact_perception_is_never_blamed() -> None:
    """Inserted perception faults count as errors of the agent if perception is known to be exact."""
    faulty = [one for one in gold() if one.mode in PERCEPTION_MODES]
    modes = {error_mode(one.task, one.episode, exact_perception=True) for one in faulty}
    assert faulty and modes and not modes & PERCEPTION_MODES and None not in modes


def test_a_question_that_exact_perception_could_not_answer_is_an_argument_error() -> None:
    scored_task = task(
        96, "descriptor", Choice(value="red", options={"red": (), "blue": ()}),
        [query_step("It is red.", "What colour is the van?")],
        evidence=[view(START, shows=Choice(value="red", options={"red": (), "blue": ()}), must_look=True, whole=True)],
    )  # fmt: skip
    unanswered_query = ("query_answer", {"question": "What colour is the van?"}, {"answer": "I cannot tell.", "known": False})
    episode = play([unanswered_query], "I cannot tell.")
    assert error_mode(scored_task, episode) is ErrorMode.VLM_QUERY
    assert error_mode(scored_task, episode, exact_perception=True) is ErrorMode.TOOL_ARGS


def test_a_reply_about_something_else_is_not_an_error_about_the_evidence() -> None:
    cars = Number(value=3, unit=("car",))
    scored_task = task(95, "counting", cars, [count_step(3, "cars")], evidence=[view(START, shows=cars, whole=True)])
    other, matching = count_step(5, "people"), count_step(5, "cars")
    assert error_mode(scored_task, play([other], "There are 5 cars.")) is ErrorMode.REASONING
    assert error_mode(scored_task, play([matching], "There are 5 cars.")) is ErrorMode.VLM_COUNTING


STEPS: st.SearchStrategy[Step] = st.sampled_from(
    [
        GO_HIGHWAY,
        GO_BRIDGE,
        FAILED_COUNT,
        WRONG_PRESET,
        count_step(0),
        count_step(5),
        count_step(12, "cars", "full"),
        query_step("It is red.", "What colour is the van?"),
        query_step("I cannot tell.", "What does the sign say?"),
        ("adjust_ptz", {"pan_deg": 15.0}),
        ("adjust_ptz", {"pan_deg": -20.0, "tilt_deg": -10.0}),
        ("zoom_to_object", {"description": "the sign"}, {"found": False, "matches": 0}),
        ("take_image", {}),
        ("get_presets", {}, {"presets": ["gate", "highway", "bridge"]}),
        ("go_home", {}),
    ]
)
TEXTS = st.sampled_from(["Done.", "5", "12 cars", "none", "yes", "no", "It is red.", "The gate.", "I cannot tell.", "several"])
ENDS = st.sampled_from(["answered", "clarification", "refused", "step_limit", "budget", "planner_error", "camera_error"])


@given(st.sampled_from(SAMPLES), st.lists(STEPS, max_size=6), TEXTS, ENDS)
def test_exactly_the_incorrect_runs_have_one_mode(sample: tuple[Task, Episode], steps: list[Step], text: str, end: str) -> None:
    scored_task, _ = sample
    episode = play(steps, text, outcome=end)
    verdict = score_episode(scored_task, episode)
    assert (error_mode(scored_task, episode) is not None) == (verdict.headline == "incorrect")
    if verdict.headline == "correct":
        assert all(check.passed for check in verdict.checks)
        assert end == "answered"
