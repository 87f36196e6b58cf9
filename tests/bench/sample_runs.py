"""Sample tasks and runs that pass them, in a small world of three presets at two viewpoints without scene data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from scope_ptz.bench.scoring.episode import CameraPosition, Episode, EpisodeCall, FrameGeometry, SavedPicture, observations_of
from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Description,
    Fact,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)
from scope_ptz.bench.tasks.task import (
    Aim,
    Argument,
    Behaviour,
    Category,
    EvidenceView,
    FinalPose,
    Forbidden,
    Framing,
    Item,
    ProgramCall,
    RequiredCall,
    Scope,
    Task,
)
from scope_ptz.geometry import AXIS_M5075_G, Limits, Pose
from scope_ptz.tools.adjust_ptz import AdjustPtz, requested_pose

FRAME = FrameGeometry(1280, 720)
PRESETS = {
    "gate": CameraPosition("mast", Pose(10.0, -10.0, 1.0)),
    "highway": CameraPosition("mast", Pose(-40.0, -14.0, 1.2)),
    "bridge": CameraPosition("bridge", Pose(90.0, -8.0, 1.5)),
}
START = PRESETS["gate"]
SIGN_BOX = (20.0, -6.0, 24.0, -4.0)

Step = tuple[str, dict[str, Any]] | tuple[str, dict[str, Any], dict[str, Any]]


def play(steps: Sequence[Step], text: str, *, instruction: str = "do it", outcome: str | None = "answered") -> Episode:
    """Return a run of calls: ``(tool, arguments)`` for moves, ``(tool, arguments, result)`` for perception calls."""
    position, calls, pictures = START, list[EpisodeCall](), list[SavedPicture]()
    for step in steps:
        name, arguments, result = step[0], step[1], dict(step[2]) if len(step) > 2 else {}
        after = position_after(position, name, arguments, result)
        if name == "take_image":
            pictures.append(SavedPicture(f"pictures/{len(pictures) + 1:03d}.png", exists=True))
            result["file"] = pictures[-1].file
        result.setdefault("message", f"{name} done; {' '.join(str(v) for v in arguments.values() if name == 'go_to_preset')}")
        failed = "error" in result
        call = EpisodeCall(
            name=name,
            arguments=arguments,
            before=position,
            after=after,
            result=None if failed else result,
            error=result.get("error"),
            fault=result.get("fault", "bad_call") if failed else None,
            time_s=float(len(calls)),
        )
        observations = observations_of(call, FRAME) if call.succeeded else ()
        calls.append(
            EpisodeCall(**{n: getattr(call, n) for n in EpisodeCall.__slots__ if n != "observations"}, observations=observations)
        )
        position = after
    return Episode(instruction, START, tuple(calls), position, text, outcome, tuple(pictures))


def position_after(position: CameraPosition, name: str, arguments: Mapping[str, Any], result: Mapping[str, Any]) -> CameraPosition:
    if "error" in result:
        return position
    if "pose" in result:
        return CameraPosition(position.viewpoint, Pose(**result["pose"]))
    if name == "adjust_ptz":
        requested = requested_pose(position.pose, AdjustPtz.model_validate(arguments), Limits())
        return CameraPosition(position.viewpoint, Limits().clamp(requested)[0])
    if name == "go_to_preset":
        return PRESETS[arguments["name"]]
    return START if name == "go_home" else position


def aim(position: CameraPosition) -> Aim:
    return Aim(
        viewpoint=position.viewpoint or "", pan_deg=position.pose.pan_deg, tilt_deg=position.pose.tilt_deg, zoom=position.pose.zoom
    )


def final(position: CameraPosition) -> FinalPose:
    return FinalPose(**aim(position).model_dump())


def view(position: CameraPosition, **extra: Any) -> EvidenceView:
    """Return evidence at a camera position: the whole view, unless items are given."""
    whole = extra.pop("whole", "items" not in extra)
    return EvidenceView(aim=aim(position), hfov_deg=AXIS_M5075_G.hfov_deg(position.pose.zoom), whole=whole, **extra)


def task(
    number: int,
    category: Category,
    expected: AnyExpected,
    steps: Sequence[Step],
    *,
    scope: Scope = "current",
    evidence: Sequence[EvidenceView] = (),
    behaviour: Behaviour | None = None,
    **extra: Any,
) -> Task:
    return Task(
        id=f"scope1-test-{category.replace('_', '-')}-{number:03d}",
        dataset="scope1",
        scene="test",
        preset="gate",
        instruction=extra.pop("instruction", "do it"),
        category=category,
        scope=scope,
        difficulty="easy",
        expected=expected,
        evidence=tuple(evidence),
        behaviour=behaviour or Behaviour(),
        reference=tuple(ProgramCall(tool=s[0], arguments=s[1]) for s in steps),
        **extra,
    )


def count_step(number: int, description: str = "cones", view: str = "current") -> Step:
    return (
        "count_objects",
        {"description": description, "view": view},
        {"count": number, "view": view, "message": f"{number} of '{description}'"},
    )


def query_step(answer: str, question: str, view: str = "current") -> Step:
    return (
        "query_answer",
        {"question": question, "view": view},
        {"answer": answer, "known": True, "view": view, "message": answer},
    )


GO_HIGHWAY: Step = ("go_to_preset", {"name": "highway"})
GO_BRIDGE: Step = ("go_to_preset", {"name": "bridge"})
TO_HIGHWAY = RequiredCall(tool="go_to_preset", arguments={"name": Argument(equals="highway")})
STEP_RIGHT = RequiredCall(tool="adjust_ptz", arguments={"pan_deg": Argument(equals=15.0, within=0.01)})
VAN = Item(instance="van-01", value="red", box_deg=(85.0, -12.0, 95.0, -5.0), min_px=40)
SIGN = Item(instance="sign-02", value="ROAD CLOSED", box_deg=SIGN_BOX, cap_height_deg=0.3)
AT_HIGHWAY, AT_BRIDGE = PRESETS["highway"], PRESETS["bridge"]
BEYOND_HIGHWAY = CameraPosition("mast", Pose(-25.0, -14.0, 1.2))
SIGN_VIEW = CameraPosition("mast", Pose(22.0, -5.0, 4.0))


def samples() -> list[tuple[Task, Episode]]:
    """Return one task for each type of answer and behaviour, each with a run that passes."""
    cones = Number(value=5, unit=("cone", "traffic cone"))
    pairs = list[tuple[Task, Episode]]()

    def add(category: Category, expected: AnyExpected, steps: list[Step], text: str, **extra: Any) -> None:
        pairs.append((task(len(pairs) + 1, category, expected, steps, **extra), play(steps, text)))

    add(
        "counting", cones, [GO_HIGHWAY, count_step(5)], "There are 5 cones.",
        evidence=[view(AT_HIGHWAY, shows=cones, about=("cone",))],
        behaviour=Behaviour(final=final(AT_HIGHWAY), calls=(TO_HIGHWAY,)),
        needs=("preset",), instruction="Go to highway and count the cones.",
    )  # fmt: skip
    cars = Number(value=12, unit=("car",))
    add(
        "counting", cars, [count_step(12, "cars", "full")], "I count 12 cars.", scope="full",
        evidence=[view(START, scope="full", band_deg=(-55.0, 25.0), shows=cars, about=("car",))], needs=("sweep",),
        instruction="Sweep the scene and count all cars.",
    )  # fmt: skip
    red = Choice(value="red", options={"red": (), "blue": (), "white": (), "green": ()})
    add(
        "descriptor", red, [GO_BRIDGE, query_step("The van is red.", "What colour is the van?")], "The van is red.",
        evidence=[view(AT_BRIDGE, items=(VAN,), shows=red)],
        needs=("preset",), instruction="What colour is the van at the bridge?",
    )  # fmt: skip
    sign = Text(accepted=("ROAD CLOSED",), ocr=True)
    zoom: Step = (
        "zoom_to_object", {"description": "the sign"},
        {"found": True, "matches": 1, "chosen": "sign", "pose": {"pan_deg": 22.0, "tilt_deg": -5.0, "zoom": 4.0}},
    )  # fmt: skip
    add(
        "ocr", sign, [zoom, query_step("ROAD CLOSED", "What does the sign say?")], 'The sign reads "ROAD CLOSED".',
        evidence=[view(SIGN_VIEW, items=(SIGN,), shows=sign)],
        needs=("zoom",), instruction="Zoom in on the sign and read it.",
    )  # fmt: skip
    none = NoneThere(subject=("bicycle", "bike"))
    add(
        "location", none, [GO_HIGHWAY, count_step(0, "bicycles")], "There are no bicycles.",
        evidence=[view(AT_HIGHWAY, shows=none)], needs=("preset",), instruction="Is there a bicycle at the highway?",
    )  # fmt: skip
    presence = YesNo(value=True, affirms=("van",))
    add(
        "location", presence, [GO_HIGHWAY, count_step(1, "van")], "Yes, there is a van.",
        evidence=[view(AT_HIGHWAY, shows=presence)], needs=("preset",), instruction="Is there a van at the highway?",
    )  # fmt: skip
    more = Relation(value="forward", subject=("gate",), object=("highway",), forward=("more",), backward=("fewer",))
    add(
        "comparative", more, [count_step(5, "cars"), GO_HIGHWAY, count_step(3, "cars")], "The gate has more cars than the highway.",
        evidence=[view(position, shows=Number(value=n, unit=("car",))) for position, n in ((START, 5), (AT_HIGHWAY, 3))],
        needs=("preset",), instruction="Which shows more cars, gate or highway?",
    )  # fmt: skip
    order = Ordering(
        value=("highway", "gate", "bridge"), options={"highway": (), "gate": (), "bridge": ()}, first=("most",), last=("fewest",)
    )
    add(
        "comparative", order, [count_step(4), GO_HIGHWAY, count_step(9), GO_BRIDGE, count_step(1)], "highway, gate, bridge",
        evidence=[view(position, shows=Number(value=n, unit=("cone",))) for position, n in
                  ((START, 4), (AT_HIGHWAY, 9), (AT_BRIDGE, 1))],
        needs=("preset",), instruction="Rank the presets by cones.",
    )  # fmt: skip
    turned = CameraPosition("mast", Pose(30.0, -20.0, 1.0))
    add(
        "single_call", ActionOnly(), [("adjust_ptz", {"pan_deg": 20.0, "tilt_deg": -10.0})], "Done.",
        behaviour=Behaviour(final=final(turned), forbidden=Forbidden(changes=("zoom",))), needs=("move",),
        instruction="Pan right 20 degrees and tilt down ten.",
    )  # fmt: skip
    add(
        "multi_step_command", ActionOnly(), [GO_HIGHWAY, ("take_image", {}), ("go_home", {})], "Done.",
        behaviour=Behaviour(
            final=final(START), pictures=1,
            calls=(TO_HIGHWAY, RequiredCall(tool="take_image"), RequiredCall(tool="go_home")),
        ),
        needs=("preset",), instruction="Go to highway, take a picture, go home.",
    )  # fmt: skip
    corners = ((20.0, -6.0), (24.0, -6.0), (24.0, -4.0), (20.0, -4.0))
    framed_pose = {"pan_deg": 22.0, "tilt_deg": -5.0, "zoom": 5.0}
    near: Step = (
        "zoom_to_object",
        {"description": "the sign"},
        {"found": True, "matches": 1, "chosen": "sign", "pose": framed_pose},
    )
    add(
        "single_call", ActionOnly(), [near], "Zoomed in on the sign.",
        behaviour=Behaviour(framing=Framing(instance="sign-02", viewpoint="mast", outline_deg=corners, min_fill=0.2, max_fill=0.4)),
        evidence=[view(START, items=(Item(instance="sign-02", box_deg=SIGN_BOX),), must_look=False)], needs=("zoom",),
        instruction="Zoom in on the sign.",
    )  # fmt: skip
    seven = Number(value=7, unit=("cone",))
    add(
        "multi_step_reasoning", seven, [GO_HIGHWAY, count_step(4), ("adjust_ptz", {"pan_deg": 15.0}), count_step(7)],
        "I see seven cones now.",
        evidence=[view(AT_HIGHWAY, shows=Number(value=4, unit=("cone",))), view(BEYOND_HIGHWAY, shows=seven)],
        behaviour=Behaviour(
            final=final(BEYOND_HIGHWAY),
            calls=(TO_HIGHWAY, STEP_RIGHT),
        ),
        needs=("preset", "move"), instruction="Go to highway, then pan right in 15 degree steps until you see six cones.",
    )  # fmt: skip
    machines = NameSet(value=("excavator", "roller"), options={"excavator": ("digger",), "roller": (), "van": (), "generator": ()})
    add(
        "descriptor", machines, [GO_HIGHWAY, query_step("an excavator and a roller", "Which machines are there?")],
        "an excavator and a roller",
        evidence=[view(AT_HIGHWAY, shows=machines)], needs=("preset",), instruction="Which machines are at the highway?",
    )  # fmt: skip
    scene = Description(
        facts=(Fact(any_of=("excavator", "digger")), Fact(any_of=("cone",))),
        contradictions=(Fact(any_of=("snow",)), Fact(any_of=("night",))),
    )
    add(
        "descriptor", scene, [GO_HIGHWAY, query_step("An excavator behind a row of cones.", "Describe the view.")],
        "An excavator stands behind a row of cones.", evidence=[view(AT_HIGHWAY, shows=scene)], needs=("preset",),
        instruction="Describe the view at the highway.",
    )  # fmt: skip
    return pairs
