"""Phrasings that were once misunderstood, and instructions that must never cause a move."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "highway", "works-overview")
NEVER_A_MOVE = [
    "fly up",
    "drive forward",
    "move forward",
    "roll 20 degrees",
    "walk left",
    "tilt left",
    "pan left and right 10",
    "zoom in and out",
    "zoom left",
    "pan right 10 metres",
    "move the camera 2 metres to the left",
    "turn on the lights",
    "pan right 20, then make me a sandwich",
    "go to gate and then fly over the fence",
    "zoom in on 3",
    "do not zoom",
    "go to the moon",
    "zoom in on the red car the blue van",
    "track the man the dog",
    "zoom in on the man next to",
    "tell me a joke",
    "zoom in on it",
    "crank it up",
    "turn it down",
    "all left",
    "this is the gate",
    "turn your back to us",
    "pan slowly right until something moves",
    "go to the gate, zoom in and return",
    "go to the gate, pan left 20 and come back",
    "visit every preset and return",
    "visit gate and highway in turn and zoom in 2x",
    "pause",
    "go to the gate, no the highway, no forget it, I don't know where I want it yet",
    "go to the gate, forget it",
    "no photos",
    "take no photos",
    "pan left 20 and at the same time pan right 20",
    "take a picture, after go home",
    "take a picture, after panning left 10, go home",
    "go to the gate. Let's go to the highway instead",
    "gate, highway, then a photo at every preset",
    "the camera at the gate panned left",
    "take a picture of the gate zoomed in",
    "zoom in there",
    "take a picture at 3x",
    "pan left 10 and after you zoom in take a picture",
]
AT_EACH = "go_to_preset(name=gate); {act}; go_to_preset(name=highway); {act}"
EVERY_PRESET = "; ".join(f"go_to_preset(name={name}){{act}}" for name in PRESETS)
COUNT_PEOPLE = "count_objects(description=people, view=current)"
PLANS = [
    ("go to the gate. No photos.", "go_to_preset(name=gate)"),
    ("is there a train at the gate?", "go_to_preset(name=gate); query_answer(question=is there a train?, view=current)"),
    ("is there a swing at the gate?", "go_to_preset(name=gate); query_answer(question=is there a swing?, view=current)"),
    ("are there any frames at the gate?", "go_to_preset(name=gate); query_answer(question=are there any frames?, view=current)"),
    ("which vans are at the gate?", "go_to_preset(name=gate); query_answer(question=which vans are there?, view=current)"),
    ("remind me which presets we've got", "get_presets()"),
    ("pan left 20 then tell me where you're pointing", "adjust_ptz(pan_deg=-20)"),
    ("what's your current pan and tilt?", ""),
    ("the boss wants a photo of the gate. Go there and take one.", "go_to_preset(name=gate); take_image()"),
    (
        "Jo wants pics of the van at the gate. Go there, zoom in on the van, take one.",
        "go_to_preset(name=gate); zoom_to_object(description=van); take_image()",
    ),
    (
        "zoom in on the hopper - scratch that, the boxcar with the open door",
        "zoom_to_object(description=boxcar with the open door)",
    ),
    ("follow the van, sorry, I meant the red car", "track_object(description=red car, duration_s=10)"),
    ("zoom in on the van, scratch that, pan left 10", "adjust_ptz(pan_deg=-10)"),
    ("train the camera on the gate", "go_to_preset(name=gate)"),
    ("is the highway still busy?", "go_to_preset(name=highway); query_answer(question=is the highway still busy?, view=current)"),
    (
        "if the highway is empty go to the gate",
        "go_to_preset(name=highway); query_answer(question=is the highway empty?, view=current); go_to_preset(name=gate)",
    ),
    ("if the gate is open, go home", "query_answer(question=is the gate open?, view=current); go_home()"),
    (
        "if the gate has a queue of over 30 cars, go home",
        "go_to_preset(name=gate); query_answer(question=does the gate have a queue of over 30 cars?, view=current); go_home()",
    ),
    ("zoom out a lot, I want the wide view", "adjust_ptz(zoom_factor=0.25)"),
    ("zoom in 2x, I want the wide view", "adjust_ptz(zoom_factor=2); adjust_ptz(zoom_limit=out)"),
    ("take a picture and after go home", "take_image(); go_home()"),
    ("take a picture and after panning left 10, go home", "take_image(); adjust_ptz(pan_deg=-10); go_home()"),
    ("pan left 20, at the same time tilt up 5, then pan right 40", "adjust_ptz(pan_deg=-20, tilt_deg=5); adjust_ptz(pan_deg=40)"),
    ("gate, no hang on, let's do the highway instead", "go_to_preset(name=highway)"),
    ("go to the highway instead of the gate", "go_to_preset(name=highway)"),
    ("gate. Disregard. Highway.", "go_to_preset(name=highway)"),
    ("go to the gate, fully zoomed out", "go_to_preset(name=gate); adjust_ptz(zoom_limit=out)"),
    ("the gate at full zoom", "go_to_preset(name=gate); adjust_ptz(zoom_limit=in)"),
    ("gate and highway, a photo in each place", AT_EACH.format(act="take_image()")),
    ("zoom to 2x, then 10x", "adjust_ptz(zoom_factor=2); adjust_ptz(zoom_factor=5)"),
    ("set the pan on -35 and the tilt on 4", "adjust_ptz(pan_deg=-35, tilt_deg=4)"),
    ("go home for lunch", "go_home()"),
    ("tilt up 10, then back down to where you started", "adjust_ptz(tilt_deg=10); adjust_ptz(tilt_deg=-10)"),
    (
        "at the gate, if there is a van, take a picture",
        "go_to_preset(name=gate); count_objects(description=van, view=current); take_image()",
    ),
    (
        "at the gate, take a picture if there is a van",
        "go_to_preset(name=gate); count_objects(description=van, view=current); take_image()",
    ),
    ("at the gate, pan right 10 until you see a van", "go_to_preset(name=gate); count_objects(description=van, view=current)"),
    ("at the gate, until you see a van, pan right 10", "go_to_preset(name=gate); count_objects(description=van, view=current)"),
    ("if the barrier's open take a picture", "query_answer(question=is the barrier open?, view=current); take_image()"),
    (
        "if two or more people are waiting, zoom in",
        "count_objects(description=people waiting, view=current); adjust_ptz(zoom_factor=2)",
    ),
    (
        "on seeing a fox, take a picture, otherwise do nothing",
        "count_objects(description=fox, view=current); take_image()",
    ),
    ("pan left 20, you know how it is", "adjust_ptz(pan_deg=-20)"),
    ("zoom out a bit, all I can see is rust", "adjust_ptz(zoom_factor=0.8)"),
    ("entire area: how many vans?", "count_objects(description=vans, view=full)"),
    (
        "which is it, more cats or more dogs?",
        "count_objects(description=cats, view=current); count_objects(description=dogs, view=current)",
    ),
    ("drop the view by 15 degrees", "adjust_ptz(tilt_deg=-15)"),
    ("lift it up 10", "adjust_ptz(tilt_deg=10)"),
    ("turn 3/4 of the way around", "adjust_ptz(pan_deg=270)"),
    ("tilt to 10 degrees below the horizon", "adjust_ptz(tilt_deg=-10)"),
    ("tilt up to 20 degrees", "adjust_ptz(tilt_deg=20)"),
    ("pan right 30 then another 15", "adjust_ptz(pan_deg=30); adjust_ptz(pan_deg=15)"),
    ("when there are no people left, take a picture", "count_objects(description=people, view=current); take_image()"),
    ("if it's raining, go home", "query_answer(question=is it raining?, view=current); go_home()"),
    (
        "read the sign on the left and then the one on the right",
        "query_answer(question=What does the sign on the left say?, view=current); "
        "query_answer(question=What does the sign on the right say?, view=current)",
    ),
    (
        "count cars at gate and trucks at highway",
        "go_to_preset(name=gate); count_objects(description=cars, view=current); "
        "go_to_preset(name=highway); count_objects(description=trucks, view=current)",
    ),
    (
        "is there a bus? if so, zoom in on it",
        "query_answer(question=is there a bus?, view=current); zoom_to_object(description=bus)",
    ),
    ("zoom in until the truck fills the frame", "zoom_to_object(description=truck)"),
    ("pan until you see a bridge", "count_objects(description=bridge, view=current)"),
    ("go to the hihgway preset", "go_to_preset(name=highway)"),
    ("preset 2", "go_to_preset(name=highway)"),
    ("how many of the cars are red?", "count_objects(description=red cars, view=current)"),
    ("count the red and white barriers", "count_objects(description=red and white barriers, view=current)"),
    ("PAN RIGHT 20!!", "adjust_ptz(pan_deg=20)"),
    ("look at each of gate, highway and count people there", AT_EACH.format(act=COUNT_PEOPLE)),
    ("visit the gate and the highway in turn and count the people", AT_EACH.format(act=COUNT_PEOPLE)),
    (
        "look at each of gate and highway, count the people and take a picture",
        AT_EACH.format(act=f"{COUNT_PEOPLE}; take_image()"),
    ),
    ("look at each of gate and highway, count the people and go home", AT_EACH.format(act=COUNT_PEOPLE) + "; go_home()"),
    (
        "visit gate and highway one by one: are there any cracks?",
        AT_EACH.format(act="query_answer(question=are there any cracks?, view=current)"),
    ),
    ("read the sign at gate and highway", AT_EACH.format(act="query_answer(question=What does the sign say?, view=current)")),
    ("read the sign at the gate", "query_answer(question=What does the sign at the gate say?, view=current)"),
    (
        "compare gate with highway by number of vans",
        AT_EACH.format(act="count_objects(description=vans, view=current)"),
    ),
    ("is the barrier open? (gate preset)", "go_to_preset(name=gate); query_answer(question=is the barrier open?, view=current)"),
    ("is the barrier open (gate preset)?", "go_to_preset(name=gate); query_answer(question=is the barrier open?, view=current)"),
    (
        "what colour is the door? look from highway",
        "go_to_preset(name=highway); query_answer(question=what colour is the door?, view=current)",
    ),
    ("is the door open? go to the gate", "query_answer(question=is the door open?, view=current); go_to_preset(name=gate)"),
    ("is this the gate?", "query_answer(question=is this the gate?, view=current)"),
    ("is it the gate", "query_answer(question=is it the gate?, view=current)"),
    ("what is being done here", "query_answer(question=what is being done here, view=current)"),
    ("is it back to normal?", "query_answer(question=is it back to normal?, view=current)"),
    ("is the home view on?", "query_answer(question=is the home view on?, view=current)"),
    (
        "at the highway and the gate: take a picture at each",
        "go_to_preset(name=highway); take_image(); go_to_preset(name=gate); take_image()",
    ),
    (
        "at each of highway and gate, take a picture",
        "go_to_preset(name=highway); take_image(); go_to_preset(name=gate); take_image()",
    ),
    (
        "for each of highway and gate, take a picture",
        "go_to_preset(name=highway); take_image(); go_to_preset(name=gate); take_image()",
    ),
    (
        "for the highway and the gate presets: go there and zoom out a bit",
        "go_to_preset(name=highway); adjust_ptz(zoom_factor=0.8); go_to_preset(name=gate); adjust_ptz(zoom_factor=0.8)",
    ),
    (
        "take a picture at each: highway, gate",
        "go_to_preset(name=highway); take_image(); go_to_preset(name=gate); take_image()",
    ),
    ("crank it left", "adjust_ptz(pan_deg=-10)"),
    ("all the way left", "adjust_ptz(pan_deg=-360)"),
    ("pan until the van is centred", "zoom_to_object(description=van)"),
    ("show me where the ladder is", "zoom_to_object(description=ladder)"),
    ("tell me where the ladder is", "query_answer(question=Where is the ladder?, view=current)"),
    ("someone's at the door - zoom in on them", "zoom_to_object(description=people at the door)"),
    (
        "how many planes are parked and how many are moving?",
        "count_objects(description=parked planes, view=current); count_objects(description=moving planes, view=current)",
    ),
    ("what's the queue like at the gate?", "go_to_preset(name=gate); query_answer(question=what's the queue like?, view=current)"),
    ("photograph each preset in turn", EVERY_PRESET.format(act="; take_image()")),
    ("check every preset for people", EVERY_PRESET.format(act=f"; {COUNT_PEOPLE}")),
    ("do a lap of the presets and come home", EVERY_PRESET.format(act="") + "; go_home()"),
    ("visit every preset, count the people and go home", EVERY_PRESET.format(act=f"; {COUNT_PEOPLE}") + "; go_home()"),
    ("go via the gate to the highway", "go_to_preset(name=gate); go_to_preset(name=highway)"),
    (
        "more people at the gate than on the highway?",
        AT_EACH.format(act=COUNT_PEOPLE),
    ),
    ("get the forklift centred", "zoom_to_object(description=forklift)"),
    ("find where the ladder is", "zoom_to_object(description=ladder)"),
    ("rotate 30 left, pause, rotate 30 right", "adjust_ptz(pan_deg=-30); adjust_ptz(pan_deg=30)"),
    ("I'd be grateful for a picture of the gate", "go_to_preset(name=gate); take_image()"),
    (
        "step through the presets, stopping at the first with a ladder",
        "go_to_preset(name=gate); count_objects(description=ladder, view=current)",
    ),
    ("how many vans, in total, can be seen?", "count_objects(description=vans, view=current)"),
]


def shown(calls: tuple[PlannedCall, ...]) -> str:
    return "; ".join(f"{c.name}({', '.join(f'{k}={v}' for k, v in c.arguments.items())})" for c in calls)


@pytest.mark.parametrize("text", NEVER_A_MOVE)
def test_never_a_wrong_move(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood, shown(made.calls)
    assert made.clarification


@pytest.mark.parametrize(("text", "calls"), PLANS)
def test_phrases(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls
