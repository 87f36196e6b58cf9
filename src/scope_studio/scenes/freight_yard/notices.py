"""Freight yard: notices on posts and walls, clocks and beacons."""

from __future__ import annotations

from scope_studio.kit.buildings import warehouse
from scope_studio.kit.core.stage import Built, Stage
from scope_studio.kit.furniture import clocks
from scope_studio.kit.signs import road_signs
from scope_studio.kit.yard import safety as yard_safety
from scope_studio.scenes.freight_yard.premises import DOCK_X, FRONT_Y, OFFICE_X, OFFICE_Y, RECEIVING_X

NoticeSpec = tuple[Built, str, float, float, float, dict[str, str]]
"""A notice: built object, name, x, y, a number, and attributes. The number is the bearing, or z for a notice on a wall."""


def build(stage: Stage) -> None:
    """Place the notices, clocks and beacons."""
    _on_posts(stage)
    _on_walls(stage)


def _on_posts(stage: Stage) -> None:
    notice = yard_safety.notice
    rows: list[NoticeSpec] = [
        (
            notice(["FORK LIFT", "TRUCKS"], header="yellow", background="yellow", cap=0.13, symbol="flt", post_height=1.5),
            "fork lift warning sign",
            13.4,
            -14.0,
            215,
            {"kind": "warning", "colour": "yellow"},
        ),
        (
            notice(
                ["FORK LIFT", "TRUCKS", "OPERATING"], header="yellow", background="yellow", cap=0.12, symbol="flt", post_height=1.5
            ),
            "fork lift warning sign",
            14.8,
            6.2,
            215,
            {"kind": "warning", "colour": "yellow"},
        ),
        (
            notice(["NO", "PEDESTRIANS"], header="white", cap=0.13, symbol="people", post_height=1.5),
            "no pedestrians sign",
            -8.4,
            3.6,
            180,
            {"kind": "prohibition", "colour": "white"},
        ),
        (
            notice(["CCTV IN", "OPERATION"], header="yellow", cap=0.12, symbol="camera", post_height=1.4),
            "CCTV sign",
            -5.4,
            -26.6,
            196,
            {"kind": "information", "colour": "yellow and white"},
        ),
        (
            notice(["ALL VISITORS", "REPORT TO", "GATEHOUSE"], background="blue", cap=0.16, post_height=1.2),
            "visitors sign",
            -27.6,
            -43.0,
            62,
            {"kind": "information", "colour": "blue"},
        ),
        (
            notice(["ALL DRIVERS", "SIGN OUT", "AT GATEHOUSE"], background="blue", cap=0.15, post_height=1.2),
            "drivers sign",
            10.9,
            -32.4,
            290,
            {"kind": "information", "colour": "blue"},
        ),
        (
            notice(["VISITOR", "PARKING"], background="green", cap=0.16, post_height=1.5),
            "visitor parking sign",
            -46.6,
            -43.6,
            60,
            {"kind": "information", "colour": "green"},
        ),
        (
            notice(["STAFF", "PARKING"], background="blue", cap=0.16, post_height=1.5),
            "staff parking sign",
            -13.4,
            -24.6,
            205,
            {"kind": "information", "colour": "blue"},
        ),
        (
            notice(["ELECTRIC VEHICLES", "ONLY"], background="green", cap=0.10, post_height=1.4),
            "charging sign",
            -17.2,
            -9.9,
            180,
            {"kind": "information", "colour": "green"},
        ),
        (
            notice(["SPEED RAMP", "AHEAD"], header="yellow", background="yellow", cap=0.11, symbol="warning", post_height=1.4),
            "speed ramp sign",
            -4.4,
            -19.6,
            184,
            {"kind": "warning", "colour": "yellow"},
        ),
        (
            notice(["STACK", "AREA C"], background="yellow", cap=0.20, post_height=1.6),
            "stack area sign",
            16.4,
            -10.0,
            225,
            {"kind": "area", "colour": "yellow"},
        ),
        (
            notice(["STACK", "AREA D"], background="yellow", cap=0.20, post_height=1.6),
            "stack area sign",
            17.0,
            -21.6,
            245,
            {"kind": "area", "colour": "yellow"},
        ),
        (
            notice(["DOCK 6", "OUT OF USE"], background="red", cap=0.14, post_height=1.0),
            "out of use sign",
            3.0,
            24.6,
            180,
            {"kind": "prohibition", "colour": "red"},
        ),
        (
            notice(["GOODS IN", "WAIT HERE"], background="blue", cap=0.16, post_height=1.4),
            "waiting sign",
            17.6,
            13.0,
            200,
            {"kind": "information", "colour": "blue"},
        ),
        (
            notice(["EMPTY", "CONTAINERS"], background="white", cap=0.16, post_height=1.4),
            "empty containers sign",
            17.2,
            -30.8,
            262,
            {"kind": "area", "colour": "white"},
        ),
        (
            notice(["DRIVERS MUST", "WEAR HI-VIS"], background="blue", cap=0.14, post_height=1.5),
            "hi-vis sign",
            -18.4,
            3.2,
            186,
            {"kind": "mandatory", "colour": "blue"},
        ),
        (
            notice(["LOADING CREW", "LOOK UP"], background="yellow", cap=0.20, post_height=1.4),
            "look up sign",
            15.0,
            2.6,
            350,
            {"kind": "warning", "colour": "yellow"},
        ),
        (
            notice(["NO ENTRY", "TO STACKS"], background="red", cap=0.24, post_height=1.4),
            "no entry sign",
            31.6,
            -5.6,
            345,
            {"kind": "prohibition", "colour": "red"},
        ),
        (
            notice(["TRAILERS ONLY", "BAYS 61 TO 65"], background="blue", cap=0.24, post_height=1.6),
            "trailer bays sign",
            -39.8,
            23.0,
            110,
            {"kind": "information", "colour": "blue"},
        ),
        (
            notice(["PEDESTRIANS", "USE WALKWAY"], background="green", cap=0.20, post_height=1.4),
            "walkway sign",
            -12.6,
            4.4,
            42,
            {"kind": "mandatory", "colour": "green"},
        ),
        (
            notice(["DOCKS 1 TO 4"], background="white", cap=0.24, post_height=1.5),
            "docks sign",
            -7.0,
            8.2,
            30,
            {"kind": "direction", "colour": "white"},
        ),
        (
            notice(["DOCKS 5 TO 8"], background="white", cap=0.24, post_height=1.5),
            "docks sign",
            12.6,
            17.2,
            338,
            {"kind": "direction", "colour": "white"},
        ),
        (
            notice(["NORTHGATE", "FREIGHT", "DISTRIBUTION CENTRE"], background="blue", cap=0.30, post_height=1.2),
            "company board",
            15.6,
            -44.6,
            180,
            {"kind": "company name", "colour": "blue"},
        ),
        (
            notice(["THANK YOU", "DRIVE SAFELY"], background="green", cap=0.18, post_height=1.3),
            "thank you sign",
            12.6,
            -40.2,
            300,
            {"kind": "information", "colour": "green"},
        ),
    ]
    for built, name, x, y, bearing, attributes in rows:
        words = " ".join(t.text for t in built.texts).lower()
        stage.place(built, "sign", name, (x, y, 0), bearing, reads=words, **attributes)
    for limit, x, y, bearing in (("10", -4.2, -30.4, 180), ("5", -3.6, 5.2, 180), ("5", 8.2, 12.8, 0)):
        stage.place(
            road_signs.speed_limit_sign(limit, diameter=0.60, post_height=1.7),
            "speed sign",
            f"{limit} mph speed limit sign",
            (x, y, 0),
            bearing,
            reads=limit,
            limit=limit,
        )
    for letter, x, y, bearing in (("A", -13.2, -11.6, 178), ("B", 15.0, 0.6, 250)):
        stage.place(
            yard_safety.assembly_point(letter),
            "sign",
            "fire assembly point sign",
            (x, y, 0),
            bearing,
            kind="safety",
            colour="green",
            reads=f"assembly point {letter.lower()}",
            letter=letter.lower(),
        )


def _on_walls(stage: Stage) -> None:
    notice = yard_safety.notice
    letters = warehouse.letters
    rows: list[NoticeSpec] = [
        (
            letters("GOODS IN", 0.42),
            "lit goods in sign",
            RECEIVING_X,
            FRONT_Y,
            5.30,
            {"state": "lit", "kind": "name", "colour": "white"},
        ),
        (
            letters("RECEPTION", 0.26),
            "lit reception sign",
            OFFICE_X - 1.3,
            OFFICE_Y,
            3.38,
            {"state": "lit", "kind": "name", "colour": "white"},
        ),
        (
            notice(["STAFF ONLY"], background="white", cap=0.10),
            "staff only sign",
            16.6,
            FRONT_Y - 0.02,
            2.62,
            {"kind": "prohibition", "colour": "white"},
        ),
        (
            notice(["SOUND HORN"], background="yellow", cap=0.18),
            "sound horn sign",
            26.3,
            FRONT_Y,
            3.6,
            {"kind": "warning", "colour": "yellow"},
        ),
        (
            notice(["MAX HEIGHT", "4.5 m"], background="yellow", cap=0.17),
            "height sign",
            -11.0,
            FRONT_Y - 3.24,
            4.93,
            {"kind": "limit", "colour": "yellow"},
        ),
        (
            notice(["ENGINES OFF", "WHILE LOADING"], background="red", cap=0.15),
            "engines off sign",
            0.4,
            FRONT_Y - 3.24,
            4.93,
            {"kind": "prohibition", "colour": "red"},
        ),
        (
            notice(["CHOCK WHEELS"], background="blue", cap=0.17),
            "chock wheels sign",
            -21.4,
            FRONT_Y - 3.24,
            4.96,
            {"kind": "mandatory", "colour": "blue"},
        ),
        (
            notice(["HOSE REEL"], background="red", cap=0.08),
            "hose reel sign",
            27.3,
            FRONT_Y,
            2.1,
            {"kind": "safety", "colour": "red"},
        ),
    ]
    for built, name, x, y, z, attributes in rows:
        words = " ".join(t.text for t in built.texts).lower()
        stage.place(built, "sign", name, (x, y, z), 180, reads=words, **attributes)
    for x, y, z, hour, minute, place in (
        (19.0, FRONT_Y, 6.35, 6, 50, "goods in"),
        (OFFICE_X + 5.1, OFFICE_Y, 3.40, 7, 10, "office"),
    ):
        stage.place(
            clocks.wall_clock(0.55, hour, minute), "clock", "wall clock", (x, y, z), 180, time=f"{hour}:{minute:02d}", area=place
        )
    for x in (DOCK_X[1] + 2.42, DOCK_X[3] + 2.42):
        stage.place(
            yard_safety.alarm_beacon(), "beacon", "lit amber beacon", (x, FRONT_Y - 0.02, 3.0), 180, state="lit", colour="amber"
        )
