"""Wordings of everyday speech: what others want, statements that name a place, words called out, slips, and lists of presets."""

from __future__ import annotations

import pytest

from scope_ptz.planner.plan import PlannedCall, plan

PRESETS = ("gate", "crossing", "bus-bay", "main-lift")
RELAYED = [
    (
        "The manager wants to know how many cars there are at the crossing.",
        "go_to_preset(name=crossing); count_objects(description=cars, view=current)",
    ),
    (
        "Dispatch is asking how many trucks are at the gate.",
        "go_to_preset(name=gate); count_objects(description=trucks, view=current)",
    ),
    ("My colleague asks if the barrier is open.", "query_answer(question=Is the barrier open?, view=current)"),
    ("Jim asked me to check the crossing.", "go_to_preset(name=crossing)"),
    ("My supervisor told me to pan left 20.", "adjust_ptz(pan_deg=-20)"),
    ("Boss is asking for a snapshot.", "take_image()"),
    (
        "My deputy reckons there's a gap in the fence by the crossing, so go there and have a look at the fence.",
        "go_to_preset(name=crossing); zoom_to_object(description=fence)",
    ),
    (
        "They said the lights are out at the bus bay, can you check?",
        "go_to_preset(name=bus-bay); query_answer(question=are the lights out?, view=current)",
    ),
    (
        "There may be a van at the crossing. Go there and zoom in on it.",
        "go_to_preset(name=crossing); zoom_to_object(description=van)",
    ),
    (
        "I left my truck at the bus bay. Go there and see if it is locked.",
        "go_to_preset(name=bus-bay); query_answer(question=Is the truck locked?, view=current)",
    ),
    (
        "There's a delivery at the gate, can you have a look?",
        "go_to_preset(name=gate); query_answer(question=is there a delivery?, view=current)",
    ),
    (
        "Someone's been hanging round the bus bay. Go and have a look.",
        "go_to_preset(name=bus-bay); query_answer(question=is there anyone?, view=current)",
    ),
    (
        "Somebody's left a trolley in the bus bay, can you see it?",
        "go_to_preset(name=bus-bay); query_answer(question=is there a trolley?, view=current)",
    ),
    (
        "My mate parked his motorbike near the bus bay. Is it still there?",
        "go_to_preset(name=bus-bay); query_answer(question=Is the motorbike still there?, view=current)",
    ),
    ("The gate looks busy. How many people are there?", "go_to_preset(name=gate); count_objects(description=people, view=current)"),
    (
        "My manager swears there are only two guards at the crossing; how many do you see?",
        "go_to_preset(name=crossing); count_objects(description=guards, view=current)",
    ),
    (
        "I've had a call about the bus bay so go there, tilt up ten and get me a picture.",
        "go_to_preset(name=bus-bay); adjust_ptz(tilt_deg=10); take_image()",
    ),
    ("The lights are out. Can you check?", "query_answer(question=are the lights out?, view=current)"),
    ("The barrier should be closed by now. Is it?", "query_answer(question=is the barrier closed?, view=current)"),
    ("Somebody said they saw a fox. Have a look around.", "query_answer(question=is there a fox anywhere?, view=full)"),
    ("A kid just fell over, zoom in on him", "zoom_to_object(description=kid)"),
]
"""What someone else says or wants, and statements before a command."""
PLAIN = [
    ("Zoom in on whoever's at the microphone.", "zoom_to_object(description=person at the microphone)"),
    ("Nobody's on the platform, right?", "query_answer(question=is anyone on the platform?, view=current)"),
    (
        "There isn't anybody left on the platform, is there?",
        "query_answer(question=is there anybody left on the platform?, view=current)",
    ),
    ("You can see the lighthouse, can't you?", "query_answer(question=can you see the lighthouse?, view=current)"),
    ("Take us home, driver.", "go_home()"),
    ("hows the queue looking", "query_answer(question=how's the queue looking, view=current)"),
    ("pan right in tens until you see the cat", "count_objects(description=cat, view=current)"),
    (
        "Let's do the rounds: gate, then the crossing, and take a snap at each.",
        "go_to_preset(name=gate); take_image(); go_to_preset(name=crossing); take_image()",
    ),
    ("Do us a photo of that puddle", "zoom_to_object(description=puddle); take_image()"),
]
"""Words that are called out, and tag questions."""
PRESET_LISTS = [
    (
        "compare the number of trucks at the gate with the number of wagons at the crossing",
        "go_to_preset(name=gate); count_objects(description=trucks, view=current); "
        "go_to_preset(name=crossing); count_objects(description=wagons, view=current)",
    ),
    (
        "count the vans at the gate and afterwards the trucks at the crossing",
        "go_to_preset(name=gate); count_objects(description=vans, view=current); "
        "go_to_preset(name=crossing); count_objects(description=trucks, view=current)",
    ),
    ("Is the barrier at the crossing up?", "go_to_preset(name=crossing); query_answer(question=Is the barrier up?, view=current)"),
    (
        "If the barrier at the crossing is up, go home.",
        "go_to_preset(name=crossing); query_answer(question=is the barrier up?, view=current); go_home()",
    ),
    (
        "Verify the barrier at the crossing is down, then go home.",
        "go_to_preset(name=crossing); query_answer(question=Is the barrier down?, view=current); go_home()",
    ),
    (
        "Numbers of people please: main lift, crossing, bus bay.",
        "go_to_preset(name=main-lift); count_objects(description=people, view=current); "
        "go_to_preset(name=crossing); count_objects(description=people, view=current); "
        "go_to_preset(name=bus-bay); count_objects(description=people, view=current)",
    ),
    (
        "Check the gate and then the crossing for people.",
        "go_to_preset(name=gate); count_objects(description=people, view=current); "
        "go_to_preset(name=crossing); count_objects(description=people, view=current)",
    ),
    (
        "Try the gate, then the crossing; stop at the first that has a van.",
        "go_to_preset(name=gate); count_objects(description=van, view=current)",
    ),
    (
        "Check all the presets and tell me which ones have people",
        "go_to_preset(name=gate); count_objects(description=people, view=current); "
        "go_to_preset(name=crossing); count_objects(description=people, view=current); "
        "go_to_preset(name=bus-bay); count_objects(description=people, view=current); "
        "go_to_preset(name=main-lift); count_objects(description=people, view=current)",
    ),
    (
        "Take a photo at every preset where there is a van.",
        "go_to_preset(name=gate); count_objects(description=van, view=current); take_image(); "
        "go_to_preset(name=crossing); count_objects(description=van, view=current); take_image(); "
        "go_to_preset(name=bus-bay); count_objects(description=van, view=current); take_image(); "
        "go_to_preset(name=main-lift); count_objects(description=van, view=current); take_image()",
    ),
    ("who's at the lift?", "go_to_preset(name=main-lift); query_answer(question=who's there?, view=current)"),
    (
        "How's the crossing looking?",
        "go_to_preset(name=crossing); query_answer(question=How's the crossing looking?, view=current)",
    ),
    ("how busy is the crossing", "go_to_preset(name=crossing); query_answer(question=how busy is the crossing?, view=current)"),
    ("How many on the crossing right now?", "go_to_preset(name=crossing); count_objects(description=people, view=current)"),
    ("Not the bus bay this time, the crossing.", "go_to_preset(name=crossing)"),
    ("Don't bother with the crossing, just show me the gate.", "go_to_preset(name=gate)"),
    (
        "First the crossing, then the gate, last the bus bay.",
        "go_to_preset(name=crossing); go_to_preset(name=gate); go_to_preset(name=bus-bay)",
    ),
    (
        "Photograph the gate view first and the crossing view second.",
        "go_to_preset(name=gate); take_image(); go_to_preset(name=crossing); take_image()",
    ),
]
"""Presets inside a question, lists of presets, and every preset."""
SLIPS = [
    ("Tilt to the lower mechanical limit.", "adjust_ptz(tilt_deg=-90)"),
    ("how many cones are there in the entire surroundings?", "count_objects(description=cones, view=full)"),
    ("Hurry up and go to the gate.", "go_to_preset(name=gate)"),
    ("Listen up: pan left 20.", "adjust_ptz(pan_deg=-20)"),
    ("Go right out.", "adjust_ptz(zoom_limit=out)"),
    ("The camera shall be rotated 30 degrees to the right.", "adjust_ptz(pan_deg=30)"),
    ("take us to the gate an tilt down 6", "go_to_preset(name=gate); adjust_ptz(tilt_deg=-6)"),
    (
        "if you see neither people nor cars, go home",
        "count_objects(description=people, view=current); count_objects(description=cars, view=current); go_home()",
    ),
    ("how many emus all around, everywhere I mean", "count_objects(description=emus, view=full)"),
    ("mind turning 15 left?", "adjust_ptz(pan_deg=-15)"),
    ("down a lot its pointing at the sky", "adjust_ptz(tilt_deg=-20)"),
    ("it would help if you zoomed in 2x", "adjust_ptz(zoom_factor=2)"),
    ("over to the right with you, seventeen degrees", "adjust_ptz(pan_deg=17)"),
    ("after you've counted the cars, go home", "count_objects(description=cars, view=current); go_home()"),
    ("having taken a picture, go to the gate", "take_image(); go_to_preset(name=gate)"),
    ("on reaching the crossing, take a photo", "go_to_preset(name=crossing); take_image()"),
    ("zoom out in steps of 1.5x until you see a van", "count_objects(description=van, view=current)"),
    ("count the cars, no, the vans", "count_objects(description=vans, view=current)"),
    ("pan left 10, not 20", "adjust_ptz(pan_deg=-10)"),
    ("if there's a car or a van, take a picture", "count_objects(description=car, view=current); take_image()"),
    (
        "take a picture if there's a car and a van",
        "count_objects(description=car, view=current); count_objects(description=van, view=current); take_image()",
    ),
    ("Follow the red van while I ring the police.", "track_object(description=red van, duration_s=10)"),
    ("Left 10. Gah, right 10.", "adjust_ptz(pan_deg=10)"),
    (
        "how many people are there, and how many of them are wearing helmets?",
        "count_objects(description=people, view=current); count_objects(description=people wearing helmets, view=current)",
    ),
    (
        "If it's not too much bother could you nip over to the crossing and count the cars?",
        "go_to_preset(name=crossing); count_objects(description=cars, view=current)",
    ),
    (
        "if there is a dog off its lead, pan right 12",
        "count_objects(description=dog off its lead, view=current); adjust_ptz(pan_deg=12)",
    ),
    ("zoom in on the men up the ladder", "zoom_to_object(description=men up the ladder)"),
    ("Track the cyclist for 1 min 30", "track_object(description=cyclist, duration_s=90)"),
    ("Make sure nobody is on the track.", "query_answer(question=Is anyone on the track?, view=current)"),
    ("Pan as far right as possible and zoom in 2x.", "adjust_ptz(pan_deg=360, zoom_factor=2)"),
    ("Swing all the way round to the left stop", "adjust_ptz(pan_deg=-360)"),
    ("zoom in on the little girl", "zoom_to_object(description=little girl)"),
    ("pan left all the way, then come back right", "adjust_ptz(pan_deg=-360); adjust_ptz(pan_deg=10)"),
    ("pan left 20 and tilt up 5, then come back right", "adjust_ptz(pan_deg=-20, tilt_deg=5); adjust_ptz(pan_deg=20)"),
    (
        "tilt up 20, go to the crossing, then come back down",
        "adjust_ptz(tilt_deg=20); go_to_preset(name=crossing); adjust_ptz(tilt_deg=-10)",
    ),
    (
        "pan right 20, tell me if the gate is shut, then swing back left",
        "adjust_ptz(pan_deg=20); query_answer(question=Is the gate shut?, view=current); adjust_ptz(pan_deg=-20)",
    ),
    (
        "track the person at the crossing for 20 seconds",
        "go_to_preset(name=crossing); track_object(description=person, duration_s=20)",
    ),
    (
        "please follow the cyclist at the crossing for half a minute, then go home",
        "go_to_preset(name=crossing); track_object(description=cyclist, duration_s=30); go_home()",
    ),
    ("follow the man in the red coat for 20 seconds", "track_object(description=man in the red coat, duration_s=20)"),
    (
        "How many bikes are there at the crossing, and is anyone watching them?",
        "go_to_preset(name=crossing); count_objects(description=bikes, view=current); "
        "query_answer(question=is anyone watching the bikes?, view=current)",
    ),
    (
        "Is anyone feeding the ducks at the crossing? They know they mustn't.",
        "go_to_preset(name=crossing); query_answer(question=Is anyone feeding the ducks?, view=current)",
    ),
    ("how busy is it? pan left 20?", "query_answer(question=how busy is it?, view=current); adjust_ptz(pan_deg=-20)"),
    ("how many deer can you see all around the tower?", "count_objects(description=deer, view=full)"),
    ("Where's the caretaker's ladder? Show me.", "zoom_to_object(description=caretaker's ladder)"),
    ("as far left as you can go", "adjust_ptz(pan_deg=-360)"),
    ("tilt up 20, then come back down", "adjust_ptz(tilt_deg=20); adjust_ptz(tilt_deg=-20)"),
    (
        "if there is a van, zoom in on it. If not, don't bother.",
        "count_objects(description=van, view=current); zoom_to_object(description=van)",
    ),
    ("Queue at the gate?", "go_to_preset(name=gate); query_answer(question=Is there any queue?, view=current)"),
]
"""Slips, corrections, verbs in unusual forms, and descriptions."""


def shown(calls: tuple[PlannedCall, ...]) -> str:
    return "; ".join(f"{c.name}({', '.join(f'{k}={v}' for k, v in c.arguments.items())})" for c in calls)


@pytest.mark.parametrize(("text", "calls"), [*RELAYED, *PLAIN, *PRESET_LISTS, *SLIPS])
def test_instructions_as_people_say_them(text: str, calls: str) -> None:
    assert shown(plan(text, PRESETS).calls) == calls


@pytest.mark.parametrize(
    "text",
    [
        "Nobody asked you to pan left 20.",
        "I asked you to pan left 20.",
        "The crossing is forbidden. Check.",
        "The crossing is off limits. Check.",
        "The crossing is not to be filmed. Check.",
        "I told you not to go to the crossing, go there.",
        "He wants me to pan left but I don't want to.",
        "Jim told me to pan left 20, which is wrong.",
        "Can you pan left 20? They're not allowed there.",
        "tilt down 20, then back up",
        "My supervisor told me not to pan left 20.",
        "We had a report of smoke at the gate.",
        "There's a van at the gate and a lorry at the crossing. Zoom in on it.",
        "if you find a person or a dog, zoom in on them",
        "zoom in on the car down 10",
        "go to the busiest preset",
        "give me 3x",
        "go to bus stop",
        "go to bay 7",
        "Ask the driver whether he has had dinner.",
        "Hurry up.",
        "Slow down.",
        "Count the wagons, but not the engine.",
        "never mind",
    ],
)
def test_unclear_wordings_move_nothing(text: str) -> None:
    made = plan(text, PRESETS)
    assert not made.understood, shown(made.calls)
    assert made.clarification
