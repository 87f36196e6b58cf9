"""The independent reading: sure, or not told at all."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.geometry import Perspective, Pose
from scope_ptz.simulator.models import SceneInstance
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth
from scope_ptz.taskgen.facts import robust as ground
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in, own_colour
from scope_ptz.taskgen.facts.robust import EYES, Sight, legible, visible

YARD = Pose(0.0, -8.0, 1.0)


@pytest.fixture(scope="module")
def yard(analytic_scene: Scene) -> Sight:
    return Sight(analytic_scene, "mast", YARD, 0.0)


def thing(category: str, name: str, **attributes: str) -> SceneInstance:
    return SceneInstance(
        id="x", number=1, category=category, name=name, attributes=dict(attributes), box_min_m=(0, 0, 0), box_max_m=(1, 1, 1)
    )


def test_what_it_says_holds_for_every_threshold_and_pose_around(yard: Sight, analytic_scene: Scene) -> None:
    blocks = yard.of(Kind("block"))
    assert blocks is not None
    for a, b, c in ((0.5, 0.5, 1.03), (-0.5, 0.5, 0.97), (0.5, -0.5, 1.0), (0.0, 0.0, 1.0)):
        truth = view_truth(analytic_scene, "mast", EYES.view(Pose(a, -8.0 + b, c)), 0.0)
        for scale in (0.7, 1.0, 1.3):
            seen = [s for s in truth.sightings if s.instance.category == "block" and visible(s, scale)]
            assert len(seen) == len(blocks)


def test_a_thing_at_the_edge_of_visible_is_not_told(analytic_scene: Scene) -> None:
    """A block of which the frame's border cuts off more or less than what the thresholds allow."""
    told, doubtful = 0, 0
    for pan in range(0, 60, 3):
        sight = Sight(analytic_scene, "mast", Pose(float(pan), -15.0, 2.0), 0.0)
        blocks = sight.of(Kind("block"))
        told, doubtful = told + (blocks is not None), doubtful + (blocks is None)
    assert told and doubtful


def test_what_moves_through_the_view_is_neither_counted_nor_absent(yard: Sight) -> None:
    assert yard.passing
    assert yard.of(Kind("roller")) is None
    assert not yard.lacks(Kind("roller"))


def test_a_taxi_among_cars_and_a_coach_among_buses_leave_their_number_open() -> None:
    taxi, saloon = thing("car", "black taxi"), thing("car", "black saloon")
    assert Kind("car").doubtful(taxi) and not Kind("car").fits(taxi)
    assert Kind("car").fits(saloon) and not Kind("car").doubtful(saloon)
    assert Kind("vehicle").fits(taxi)
    assert Kind("bus").doubtful(thing("bus", "white coach"))


def test_what_lies_across_the_ends_of_a_sweep_has_no_place_in_it(yard: Sight, analytic_scene: Scene) -> None:
    around = Sight(analytic_scene, "mast", None, 0.0)
    sighting = around.clear[0]
    across = replace(sighting, box=(0.0, 0.4, 1.0, 0.6))
    assert around.parted(across) and not around.parted(replace(sighting, box=(0.1, 0.4, 0.3, 0.6)))
    assert not yard.parted(across)


def test_absent_is_what_nothing_could_be_taken_for(yard: Sight) -> None:
    assert yard.lacks(Kind("zebra"))
    assert not yard.lacks(Kind("ball"))


def test_nothing_is_said_of_what_a_backdrop_shows_without_being_annotated(
    yard: Sight, analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert yard.of(Kind("block")) and yard.lacks(Kind("zebra"))
    monkeypatch.setattr(ground, "BACKDROP", {analytic_scene.name: frozenset({"block", "zebra"})})
    sight = Sight(analytic_scene, "mast", YARD, 0.0)
    assert sight.of(Kind("block")) is None and not sight.lacks(Kind("zebra"))
    assert not any(s.instance.category == "block" for s in sight.clear)


def test_a_sign_has_no_colour_but_a_shops_board_has() -> None:
    assert own_colour(thing("sign", "no parking sign", colour="yellow")) is None
    assert own_colour(thing("lorry", "green box lorry", colour="green")) is None
    assert own_colour(thing("shop sign", "bakery sign", colour="blue")) == "blue"


def test_doubtful_names() -> None:
    assert Kind("drum").doubtful(thing("cable drum", "wooden cable drum"))
    assert Kind("sign").doubtful(thing("message sign", "variable message sign"))
    assert Kind("person").doubtful(thing("cyclist", "cyclist on a red bicycle"))
    assert Kind("litter bin").doubtful(thing("recycling bin", "blue recycling bin"))
    assert Kind("vehicle").doubtful(thing("tram", "red and cream tram"))
    assert Kind("car", "blue").doubtful(thing("car", "dark blue saloon", colour="dark blue"))
    assert Kind("car", "grey").doubtful(thing("car", "silver saloon", colour="silver"))
    assert Kind("car", "red").doubtful(thing("car", "estate"))
    assert not Kind("car", "red").doubtful(thing("car", "white van", colour="white"))
    assert not Kind("worker").doubtful(thing("traffic cone", "traffic cone"))
    assert not Kind("car").doubtful(thing("skip", "yellow skip", colour="yellow"))


def test_groups_take_in_their_categories() -> None:
    assert Kind("person").fits(thing("worker", "walking worker"))
    assert Kind("vehicle").fits(thing("van", "white van"))
    assert Kind("person") in kinds_in([thing("worker", "walking worker")])
    assert Kind("worker", None, ("vest", "orange")) in kinds_in([thing("worker", "worker", vest="orange")])
    assert not Kind("worker", None, ("vest", "orange")).fits(thing("worker", "worker", vest="yellow"))


def test_sides_and_order_agree_with_the_frame(yard: Sight) -> None:
    things = [s for s in yard.clear if yard.side(s, 0) is not None]
    assert things
    for sighting in things:
        middle = (sighting.box[0] + sighting.box[2]) / 2
        assert yard.side(sighting, 0) == (middle > 0.5)
    order = yard.in_order(things[:2], 0)
    if order is not None:
        assert order[0].box[0] + order[0].box[2] < order[1].box[0] + order[1].box[2]


def test_texts_are_read_only_when_near_enough(analytic_scene: Scene) -> None:
    near, far = (Sight(analytic_scene, "mast", Pose(-16.7, -2.0, zoom), 0.0) for zoom in (4.0, 1.0))
    assert [t.text.text for t in near.legible] == ["NO ENTRY"]
    assert all(legible(t, 1.3) for t in near.legible)
    assert len(far.legible) <= len(near.legible)


def test_evidence_lies_inside_its_own_frame(yard: Sight) -> None:
    from scope_ptz.bench.scoring.coverage import shows
    from scope_ptz.bench.scoring.episode import Observation

    assert isinstance(yard.projection, Perspective)
    look = Observation("mast", yard.projection, 0.0, "count")
    assert all(shows(yard.item(s), look) for s in yard.clear)


def test_the_reading_is_repeatable(yard: Sight, analytic_scene: Scene) -> None:
    calls: list[float] = []

    def look(scene: Scene, viewpoint: str, projection: object, time_s: float) -> ViewTruth:
        calls.append(time_s)
        return view_truth(scene, viewpoint, projection, time_s)  # type: ignore[arg-type]

    again = replace(yard, look=look)
    assert [s.instance.id for s in again.clear] == [s.instance.id for s in yard.clear]
    assert len(calls) == 9
    assert kinds_in([]) == []
