"""Robust ground truth contains only certain facts."""

from __future__ import annotations

from dataclasses import replace

import pytest

from scope_ptz.geometry import Perspective, Pose
from scope_ptz.simulator.models import SceneInstance
from scope_ptz.simulator.pack import Scene
from scope_ptz.simulator.truth import ViewTruth, view_truth
from scope_ptz.taskgen.facts import robust
from scope_ptz.taskgen.facts.kinds import Kind, kinds_in, own_colour
from scope_ptz.taskgen.facts.robust import TASK_CAMERA, RobustTruth, is_legible, is_visible

YARD = Pose(0.0, -8.0, 1.0)


@pytest.fixture(scope="module")
def yard(analytic_scene: Scene) -> RobustTruth:
    return RobustTruth(analytic_scene, "mast", YARD, 0.0)


def thing(category: str, name: str, **attributes: str) -> SceneInstance:
    return SceneInstance(
        id="x", number=1, category=category, name=name, attributes=dict(attributes), box_min_m=(0, 0, 0), box_max_m=(1, 1, 1)
    )


def test_counts_hold_for_all_thresholds_and_nearby_poses(yard: RobustTruth, analytic_scene: Scene) -> None:
    blocks = yard.all_of(Kind("block"))
    assert blocks is not None
    for a, b, c in ((0.5, 0.5, 1.03), (-0.5, 0.5, 0.97), (0.5, -0.5, 1.0), (0.0, 0.0, 1.0)):
        truth = view_truth(analytic_scene, "mast", TASK_CAMERA.view(Pose(a, -8.0 + b, c)), 0.0)
        for scale in (0.7, 1.0, 1.3):
            visible_blocks = [s for s in truth.sightings if s.instance.category == "block" and is_visible(s, scale)]
            assert len(visible_blocks) == len(blocks)


@pytest.mark.full
def test_a_barely_visible_object_makes_its_kind_uncertain(analytic_scene: Scene) -> None:
    """The border of the frame cuts off a block by more or by less than the thresholds allow."""
    certain, uncertain = 0, 0
    for pan in range(0, 60, 3):
        truth = RobustTruth(analytic_scene, "mast", Pose(float(pan), -15.0, 2.0), 0.0)
        blocks = truth.all_of(Kind("block"))
        certain, uncertain = certain + (blocks is not None), uncertain + (blocks is None)
    assert certain and uncertain


def test_a_passing_actor_is_neither_counted_nor_absent(yard: RobustTruth) -> None:
    assert yard.passing_actors
    assert yard.all_of(Kind("roller")) is None
    assert not yard.certainly_lacks(Kind("roller"))


def test_a_taxi_among_cars_and_a_coach_among_buses_make_their_number_uncertain() -> None:
    taxi, saloon = thing("car", "black taxi"), thing("car", "black saloon")
    assert Kind("car").is_ambiguous_with(taxi) and not Kind("car").fits(taxi)
    assert Kind("car").fits(saloon) and not Kind("car").is_ambiguous_with(saloon)
    assert Kind("vehicle").fits(taxi)
    assert Kind("bus").is_ambiguous_with(thing("bus", "white coach"))


def test_an_object_across_the_ends_of_a_sweep_is_detected(yard: RobustTruth, analytic_scene: Scene) -> None:
    around = RobustTruth(analytic_scene, "mast", None, 0.0)
    sighting = around.clear_sightings[0]
    across = replace(sighting, box=(0.0, 0.4, 1.0, 0.6))
    assert around.is_split_by_sweep(across) and not around.is_split_by_sweep(replace(sighting, box=(0.1, 0.4, 0.3, 0.6)))
    assert not yard.is_split_by_sweep(across)


def test_a_kind_is_absent_when_nothing_could_be_mistaken_for_it(yard: RobustTruth) -> None:
    assert yard.certainly_lacks(Kind("zebra"))
    assert not yard.certainly_lacks(Kind("ball"))


def test_nothing_is_stated_about_categories_in_the_backdrop(
    yard: RobustTruth, analytic_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert yard.all_of(Kind("block")) and yard.certainly_lacks(Kind("zebra"))
    monkeypatch.setattr(robust, "INCOMPLETE_CATEGORIES", {analytic_scene.name: frozenset({"block", "zebra"})})
    truth = RobustTruth(analytic_scene, "mast", YARD, 0.0)
    assert truth.all_of(Kind("block")) is None and not truth.certainly_lacks(Kind("zebra"))
    assert not any(s.instance.category == "block" for s in truth.clear_sightings)


def test_a_sign_has_no_colour_but_a_shop_sign_does() -> None:
    assert own_colour(thing("sign", "no parking sign", colour="yellow")) is None
    assert own_colour(thing("lorry", "green box lorry", colour="green")) is None
    assert own_colour(thing("shop sign", "bakery sign", colour="blue")) == "blue"


def test_ambiguous_names() -> None:
    assert Kind("drum").is_ambiguous_with(thing("cable drum", "wooden cable drum"))
    assert Kind("sign").is_ambiguous_with(thing("message sign", "variable message sign"))
    assert Kind("person").is_ambiguous_with(thing("cyclist", "cyclist on a red bicycle"))
    assert Kind("litter bin").is_ambiguous_with(thing("recycling bin", "blue recycling bin"))
    assert Kind("vehicle").is_ambiguous_with(thing("tram", "red and cream tram"))
    assert Kind("car", "blue").is_ambiguous_with(thing("car", "dark blue saloon", colour="dark blue"))
    assert Kind("car", "grey").is_ambiguous_with(thing("car", "silver saloon", colour="silver"))
    assert Kind("car", "red").is_ambiguous_with(thing("car", "estate"))
    assert not Kind("car", "red").is_ambiguous_with(thing("car", "white van", colour="white"))
    assert not Kind("worker").is_ambiguous_with(thing("traffic cone", "traffic cone"))
    assert not Kind("car").is_ambiguous_with(thing("skip", "yellow skip", colour="yellow"))


def test_groups_include_their_categories() -> None:
    assert Kind("person").fits(thing("worker", "walking worker"))
    assert Kind("vehicle").fits(thing("van", "white van"))
    assert Kind("person") in kinds_in([thing("worker", "walking worker")])
    assert Kind("worker", None, ("vest", "orange")) in kinds_in([thing("worker", "worker", vest="orange")])
    assert not Kind("worker", None, ("vest", "orange")).fits(thing("worker", "worker", vest="yellow"))


def test_sides_and_order_agree_with_the_frame(yard: RobustTruth) -> None:
    things = [s for s in yard.clear_sightings if yard.side(s, 0) is not None]
    assert things
    for sighting in things:
        middle = (sighting.box[0] + sighting.box[2]) / 2
        assert yard.side(sighting, 0) == (middle > 0.5)
    order = yard.sort_by_position(things[:2], 0)
    if order is not None:
        assert order[0].box[0] + order[0].box[2] < order[1].box[0] + order[1].box[2]


def test_texts_are_legible_only_from_close_by(analytic_scene: Scene) -> None:
    near, far = (RobustTruth(analytic_scene, "mast", Pose(-16.7, -2.0, zoom), 0.0) for zoom in (4.0, 1.0))
    assert [t.text.text for t in near.legible] == ["NO ENTRY"]
    assert all(is_legible(t, 1.3) for t in near.legible)
    assert len(far.legible) <= len(near.legible)


def test_evidence_is_inside_its_own_frame(yard: RobustTruth) -> None:
    from scope_ptz.bench.scoring.coverage import is_clearly_shown
    from scope_ptz.bench.scoring.episode import Observation

    assert isinstance(yard.projection, Perspective)
    observation = Observation("mast", yard.projection, 0.0, "count")
    assert all(is_clearly_shown(yard.item(s), observation) for s in yard.clear_sightings)


def test_results_are_reproducible(yard: RobustTruth, analytic_scene: Scene) -> None:
    calls: list[float] = []

    def read_and_count(scene: Scene, viewpoint: str, projection: object, time_s: float) -> ViewTruth:
        calls.append(time_s)
        return view_truth(scene, viewpoint, projection, time_s)  # type: ignore[arg-type]

    recomputed = replace(yard, read_truth=read_and_count)
    assert [s.instance.id for s in recomputed.clear_sightings] == [s.instance.id for s in yard.clear_sightings]
    assert len(calls) == 9
    assert kinds_in([]) == []
