"""Steps that add, subtract and rank counts, as a program runs them."""

from __future__ import annotations

import pytest

from scope_ptz.geometry import Limits, Pose
from scope_ptz.planner.grammar import instruction_tree as ast
from scope_ptz.planner.grammar.execution.program import Program
from scope_ptz.planner.grammar.execution.run_state import AssumedOutcome
from tests.planner.stage import Stage

GATE, YARD, DOCKS, ROAD = (ast.PresetRef(name) for name in ("gate", "yard", "docks", "road"))
CARS, VANS = ast.Thing("cars"), ast.Thing("vans")


def run(step: ast.Step, *counts: int) -> tuple[str, list[str]]:
    """Run a step with a perception that counts as scripted. Return the answer and the presets that the camera went to."""
    program, left, visited = Program(Limits(), Pose()), list(counts), list[str]()
    steps = program.run([step])
    try:
        name, arguments = next(steps)
        while True:
            if name == "go_to_preset":
                visited.append(arguments["name"])
            result = {"count": left.pop(0)} if name == "count_objects" else {"pose": Pose().as_dict()}
            name, arguments = steps.send(AssumedOutcome(result))
    except StopIteration:
        return program.answer(), visited


def at(thing: ast.Thing, *places: ast.PresetRef) -> tuple[ast.Tally, ...]:
    return tuple(ast.Tally(thing, place) for place in places)


HERE = (ast.Tally(CARS), ast.Tally(VANS))


@pytest.mark.parametrize(
    ("step", "counts", "answer"),
    [
        (ast.Total(HERE), (2, 1), "I can see 2 cars and 1 van in this view, which makes 3 altogether."),
        (ast.Total(HERE), (0, 0), "I can see no cars and no vans in this view, which makes 0 altogether."),
        (ast.Total(at(CARS, GATE, YARD)), (3, 2), "I can see 3 cars at gate and 2 at yard, which makes 5 altogether."),
        (ast.Difference(*HERE), (7, 2), "I can see 7 cars and 2 vans in this view. There are 5 more cars than vans."),
        (ast.Difference(*HERE), (1, 2), "I can see 1 car and 2 vans in this view. There is 1 fewer car than vans."),
        (
            ast.Difference(*HERE), (2, 2),
            "I can see 2 cars and 2 vans in this view. That is the same number of both, so the difference is 0.",
        ),
        (
            ast.Difference(*at(CARS, GATE, YARD)), (3, 0),
            "I can see 3 cars at gate and none at yard, so there are 3 more at gate.",
        ),
        (
            ast.Difference(*(ast.Tally(ast.Thing(f"people in the {side} half")) for side in ("right", "left"))), (3, 2),
            "I can see 3 people in the right half and 2 people in the left half in this view. "
            "There is 1 more person in the right half than in the left half.",
        ),
        (
            ast.Total(at(CARS, GATE, YARD, DOCKS, ROAD)), (2, 0, 0, 0),
            "I can see 2 cars at gate, and none at the other 3 presets, which makes 2 altogether.",
        ),
        (ast.RankCounts(HERE), (0, 0), "I can see no cars and no vans in this view. That is the same number of both."),
        (
            ast.RankCounts(at(CARS, GATE, YARD, DOCKS)), (2, 2, 2),
            "I can see 2 cars at gate, 2 at yard and 2 at docks. All three numbers are the same.",
        ),
        (
            ast.RankCounts(at(CARS, GATE, YARD, DOCKS)), (0, 1, 0),
            "From most to fewest: 1 car at yard, no cars at gate and no cars at docks.",
        ),
        (ast.RankCounts(HERE), (1, 4), "From most to fewest: 4 vans and 1 car."),
        (ast.RankCounts(HERE, "fewer"), (1, 4), "From fewest to most: 1 car and 4 vans."),
        (
            ast.RankCounts(at(CARS, GATE, YARD, DOCKS)), (1, 4, 1),
            "From most to fewest: 4 cars at yard, 1 car at gate and 1 car at docks. Gate and docks are equal.",
        ),
        (ast.Compare(CARS, VANS, yes_no=True), (3, 1), "Yes: I can see 3 cars and 1 van in this view."),
        (ast.Compare(CARS, VANS, "fewer", yes_no=True), (3, 1), "No: I can see 3 cars and 1 van in this view."),
        (ast.Compare(CARS, VANS), (1, 3), "I can see 1 car and 3 vans in this view. There are 2 more vans than cars."),
    ],
)  # fmt: skip
def test_calculations(step: ast.Step, counts: tuple[int, ...], answer: str) -> None:
    said, visited = run(step, *counts)
    assert said == answer + (f" The camera is now at {visited[-1]}." if visited else "")


def test_places_are_visited_in_their_order() -> None:
    assert run(ast.Total(at(CARS, DOCKS, GATE)), 1, 1)[1] == ["docks", "gate"]


@pytest.mark.parametrize(
    ("step", "counts", "ending"),
    [
        (ast.WhichPreset(CARS, "more", (GATE, YARD)), (1, 4), "Preset yard shows more cars."),
        (ast.WhichPreset(CARS, "more", (GATE, YARD, DOCKS)), (1, 4, 2), "Preset yard shows the most cars."),
        (ast.WhichPreset(CARS, "more", (GATE, YARD, DOCKS), rank=2), (1, 4, 2), "Preset docks shows the second most cars."),
        (ast.WhichPreset(CARS, "fewer", (GATE, YARD, DOCKS)), (1, 4, 2), "Preset gate shows the fewest cars."),
        (ast.WhichPreset(CARS, "more", (GATE, YARD), rank=3), (1, 4), "There are only 2 presets to compare."),
        (ast.WhichPreset(CARS, "more", (GATE, YARD, DOCKS), rank=2), (1, 4, 1), "It is a tie between gate and docks."),
        (
            ast.WhichPreset(CARS, "more", (GATE, YARD, DOCKS, ROAD)),
            (0, 3, 0, 0),
            "I can see 3 cars at yard, and none at the other 3 presets. Preset yard shows the most cars.",
        ),
        (
            ast.WhichPreset(CARS, any_of=True, yes_no=True, places=(GATE, YARD)),
            (1, 0),
            "Yes: I can see 1 car at gate, but none at yard.",
        ),
        (ast.WhichPreset(CARS, any_of=True, yes_no=True, places=(GATE, YARD)), (0, 0), "No: I can see no cars at gate or yard."),
        (ast.WhichPreset(CARS, any_of=True, places=(GATE,)), (2,), "I can see 2 cars at gate."),
    ],
)
def test_comparisons_of_presets(step: ast.WhichPreset, counts: tuple[int, ...], ending: str) -> None:
    said, visited = run(step, *counts)
    assert said.endswith(ending + (f" The camera is now at {visited[-1]}." if len(visited) > 1 else ""))


def test_the_camera_goes_to_the_preset_of_the_requested_rank() -> None:
    assert run(ast.WhichPreset(CARS, "more", (GATE, YARD, DOCKS), go=True, rank=2), 1, 4, 2)[1][-1] == "docks"


def test_counts_on_a_tour_are_reported_together() -> None:
    steps = [step for place in (GATE, YARD, DOCKS) for step in (ast.GoToPreset(place), ast.Count((CARS,)))]
    program, left, calls = Program(Limits(), Pose()), [2, 0, 1], list[str]()
    run_steps = program.run([*steps, ast.GoToPreset(GATE)])
    try:
        name, arguments = next(run_steps)
        while True:
            calls.append(arguments.get("name", "count"))
            name, arguments = run_steps.send(
                AssumedOutcome({"count": left.pop(0)} if name == "count_objects" else {"pose": Pose().as_dict()})
            )
    except StopIteration:
        pass
    assert calls == ["gate", "count", "yard", "count", "docks", "count", "gate"]
    assert program.answer() == "I can see 2 cars at gate, none at yard and 1 at docks. I went to preset gate."


MINIMUM = "because there may be more"


@pytest.mark.parametrize(
    ("instruction", "looks", "expected"),
    [
        ("are there more vans than cars?", ((5, False), (2, True)), "Yes: I can see at least 5 vans and 2 cars in this view."),
        ("how many more vans than cars are there?", ((5, False), (2, True)), MINIMUM),
        ("how many vans and cars are there altogether?", ((5, False), (2, True)), "which makes at least 7 altogether"),
        (
            "which preset has more vans?",
            ((5, False), (2, True)),
            "I can see at least 5 vans at gate and 2 vans at highway. Preset gate",
        ),
        ("which preset has more vans?", ((5, False), (2, False)), "As far as I can see, preset gate shows more vans."),
        ("which preset has more vans?", ((2, False), (2, False)), "I cannot tell which, because there may be more"),
        ("which preset has more vans?", ((2, True), (2, True)), "It is a tie between gate and highway."),
        ("which preset has more vans?", ((0, False), (2, True)), "I can see no vans clearly at gate and 2 vans at highway."),
    ],
)
def test_minimum_counts_stay_minimum_counts(instruction: str, looks: tuple[tuple[int, bool], ...], expected: str) -> None:
    assert expected in Stage(looks).run(instruction).text
