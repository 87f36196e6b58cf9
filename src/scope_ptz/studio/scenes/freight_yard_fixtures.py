"""Freight yard: the gate and its house, fences, shelters, charging points, and every notice."""

from __future__ import annotations

from scope_ptz.studio.kit import cycles, dusk, furniture, signs, warehouse, yard_safety, yard_shelters
from scope_ptz.studio.kit.stage import Built, Stage
from scope_ptz.studio.scenes import freight_yard_ground as ground
from scope_ptz.studio.scenes.freight_yard_buildings import DOCK_X, FRONT_Y, GOODS_IN_X, OFFICE_X, OFFICE_Y
from scope_ptz.studio.scenes.freight_yard_stock import Moulds

GATEHOUSE = (3.0, -39.0)


def build(stage: Stage) -> None:
    _gate(stage)
    _fences(stage)
    _shelters(stage)
    _bay_furniture(stage)
    _notices(stage)


def _gate(stage: Stage) -> None:
    x, y = GATEHOUSE
    house = stage.place(yard_shelters.gatehouse(), "gatehouse", "gatehouse", (x, y, 0), 0, colour="grey", state="lit", occupied="yes")
    dusk.pool((x, y, 2.72), 45, dusk.WARM, size_m=0.9)
    dusk.pool((x - 2.2, y, 2.75), 60, dusk.LED, size_m=0.4)
    dusk.pool((x + 2.2, y, 2.75), 60, dusk.LED, size_m=0.4)
    stage.place(yard_shelters.barrier_arm(raised=True), "barrier arm", "raised barrier arm", (1.0, -36.0, 0), 180, state="raised", colour="red and white", lane="in")
    stage.place(yard_shelters.barrier_arm(), "barrier arm", "lowered barrier arm", (5.0, -36.0, 0), 0, state="lowered", colour="red and white", lane="out")
    stage.place(yard_shelters.traffic_head("green"), "lane signal", "green lane signal", (0.8, -38.8, 0), 180, parent=house, state="lit", colour="green", lane="in")
    stage.place(yard_shelters.traffic_head("red"), "lane signal", "red lane signal", (5.2, -35.0, 0), 0, state="lit", colour="red", lane="out")
    stage.place(yard_safety.sliding_gate(), "gate", "open sliding gate", (-10.4, -45.4, 0), 0, state="open", colour="green", material="steel")
    stage.place(furniture.cctv_pole(6.4), "camera pole", "camera pole", (11.6, -42.6, 0), 320, colour="grey", height_m=6.4)


def _fences(stage: Stage) -> None:
    """One annotated run a side; the cut panel in the west is its own."""
    mould = yard_safety.chain_link()
    step = yard_safety.FENCE_M
    fresh = [True]

    def run(name: str, x0: float, y0: float, dx: float, dy: float, count: int, bearing: float, skip: tuple[int, ...] = ()) -> None:
        parts = []
        for k in range(count):
            if k in skip:
                continue
            panel = mould if fresh[0] else mould.copy()
            fresh[0] = False
            stage.put(panel, (x0 + dx * step * (k + 0.5), y0 + dy * step * (k + 0.5), 0), bearing)
            parts += panel.objects
        built = Built.of(name, [])
        built.objects.extend(parts)
        stage.place(built, "fence", name, (x0, y0, 0), 0, material="steel", kind="chain-link")

    run("southern chain-link fence", -58.0, -46.0, 1, 0, 17, 180)
    run("southern chain-link fence", 12.5, -46.0, 1, 0, 13, 180)
    run("western chain-link fence", -58.0, -46.0, 0, 1, 32, 270, skip=(5,))
    run("eastern chain-link fence", 50.5, -46.0, 0, 1, 32, 90)
    stage.place(yard_safety.chain_link(hole=True), "fence panel", "fence panel with a hole", (-58.0, -29.5, 0), 270, material="steel", kind="chain-link", state="damaged")


def _shelters(stage: Stage) -> None:
    shelter = stage.place(yard_shelters.cycle_shelter(), "cycle shelter", "green cycle shelter", (-52.0, -34.0, 0), 90, colour="green", state="lit")
    dusk.pool((-51.9, -34.0, 2.25), 40, dusk.LED, size_m=1.0)
    rows = [("red", "town", 1.9), ("blue", "town", 1.2), ("black", "town", -0.4), ("green", "town", -1.2), ("orange", "town", -1.9)]
    moulds = Moulds()
    for colour, kind, along in rows:
        built = cycles.bicycle(colour, kind=kind)
        stage.place(built, "bicycle", f"{colour} bicycle", (-52.15, -34.0 - along, 0), 270, colour=colour, state="parked", parent=shelter)
        stage.place(moulds.get("hoop", cycles.bike_stand), "bike stand", "bike stand", (-52.1, -34.0 - along - 0.22, 0), 270, material="steel", parent=shelter)
    smoking = (-30.0, -7.2)
    stage.place(yard_shelters.smoking_shelter(), "smoking shelter", "smoking shelter", (*smoking, 0), 180, colour="grey", state="lit")
    dusk.pool((smoking[0], smoking[1] - 0.1, 2.12), 40, dusk.WARM, size_m=0.9)
    for name, colour, x in (("FIZZ", "red", -26.6), ("SNAX", "blue", -25.4)):
        stage.place(yard_shelters.vending_machine(name, colour), "vending machine", f"lit {colour} vending machine", (x, -7.0, 0), 180, colour=colour, state="lit", reads=name.lower())
    dusk.pool((-26.0, -7.9, 1.5), 25, dusk.LED, size_m=1.2, aim=(0, -1, -0.4))
    cabinet = stage.place(furniture.cabinet(colour="green"), "cabinet", "green electrical cabinet", (-22.4, -7.4, 0), 180, colour="green", state="closed")
    plate = yard_safety.notice(["DANGER", "415 VOLTS"], background="yellow", cap=0.075)
    stage.place(plate, "sign", "high voltage sign", (-22.4, -7.63, 1.02), 180, parent=cabinet, colour="yellow", kind="warning", reads="danger 415 volts")


def _bay_furniture(stage: Stage) -> None:
    moulds = Moulds()
    for row, y, bearing in ((ground.ROW_A, -11.75, 180.0), (ground.ROW_B, -29.25, 0.0), (ground.VISITORS, -44.3, 0.0)):
        for x, number in row:
            background = "green" if number in ground.CHARGING else "yellow" if row is ground.VISITORS else "blue"
            stage.place(yard_safety.bay_plate(number, background=background), "bay number", f"bay number {number}", (x, y, 0), bearing, number=number, colour=background)
            side = -1 if bearing == 0.0 else 1
            stage.place(moulds.get("stop", yard_safety.wheel_stop), "wheel stop", "wheel stop", (x, y - 0.55 * side, 0), bearing, colour="yellow and black")
    for y, number in ground.TRAILER_BAYS:
        stage.place(yard_safety.bay_plate(number, background="yellow"), "bay number", f"bay number {number}", (-40.6, y - 1.75, 0), 90, number=number, colour="yellow")
    for number, state in (("21", "green"), ("22", "red"), ("23", "unlit")):
        x = dict((n, x) for x, n in ground.ROW_A)[number]
        facts = {"state": "unlit"} if state == "unlit" else {"state": "lit", "colour": state}
        stage.place(yard_shelters.charge_point(state, number=number), "charging point", f"{state} charging point" if state != "unlit" else "unlit charging point", (x + 0.75, -11.55, 0), 180, bay=number, light=state, **facts)


def _notices(stage: Stage) -> None:
    n = yard_safety.notice
    standing: list[tuple[Built, str, float, float, float, dict[str, str]]] = [
        (n(["FORK LIFT", "TRUCKS"], header="yellow", background="yellow", cap=0.13, symbol="flt", post_height=1.5), "fork lift warning sign", 13.4, -14.0, 215, {"kind": "warning", "colour": "yellow"}),
        (n(["FORK LIFT", "TRUCKS", "OPERATING"], header="yellow", background="yellow", cap=0.12, symbol="flt", post_height=1.5), "fork lift warning sign", 14.8, 6.2, 215, {"kind": "warning", "colour": "yellow"}),
        (n(["NO", "PEDESTRIANS"], header="white", cap=0.13, symbol="people", post_height=1.5), "no pedestrians sign", -8.4, 3.6, 180, {"kind": "prohibition", "colour": "white"}),
        (n(["CCTV IN", "OPERATION"], header="yellow", cap=0.12, symbol="camera", post_height=1.4), "CCTV sign", -5.4, -26.6, 196, {"kind": "information", "colour": "yellow and white"}),
        (n(["ALL VISITORS", "REPORT TO", "GATEHOUSE"], background="blue", cap=0.16, post_height=1.2), "visitors sign", -27.6, -43.0, 62, {"kind": "information", "colour": "blue"}),
        (n(["ALL DRIVERS", "SIGN OUT", "AT GATEHOUSE"], background="blue", cap=0.15, post_height=1.2), "drivers sign", 10.9, -32.4, 290, {"kind": "information", "colour": "blue"}),
        (n(["VISITOR", "PARKING"], background="green", cap=0.16, post_height=1.5), "visitor parking sign", -46.6, -43.6, 60, {"kind": "information", "colour": "green"}),
        (n(["STAFF", "PARKING"], background="blue", cap=0.16, post_height=1.5), "staff parking sign", -13.4, -24.6, 205, {"kind": "information", "colour": "blue"}),
        (n(["ELECTRIC VEHICLES", "ONLY"], background="green", cap=0.10, post_height=1.4), "charging sign", -17.2, -9.9, 180, {"kind": "information", "colour": "green"}),
        (n(["SPEED RAMP", "AHEAD"], header="yellow", background="yellow", cap=0.11, symbol="warning", post_height=1.4), "speed ramp sign", -4.4, -19.6, 184, {"kind": "warning", "colour": "yellow"}),
        (n(["STACK", "AREA C"], background="yellow", cap=0.20, post_height=1.6), "stack area sign", 16.4, -10.0, 225, {"kind": "area", "colour": "yellow"}),
        (n(["STACK", "AREA D"], background="yellow", cap=0.20, post_height=1.6), "stack area sign", 17.0, -21.6, 245, {"kind": "area", "colour": "yellow"}),
        (n(["DOCK 6", "OUT OF USE"], background="red", cap=0.14, post_height=1.0), "out of use sign", 3.0, 24.6, 180, {"kind": "prohibition", "colour": "red"}),
        (n(["GOODS IN", "WAIT HERE"], background="blue", cap=0.16, post_height=1.4), "waiting sign", 17.6, 13.0, 200, {"kind": "information", "colour": "blue"}),
        (n(["EMPTY", "CONTAINERS"], background="white", cap=0.16, post_height=1.4), "empty containers sign", 17.2, -30.8, 262, {"kind": "area", "colour": "white"}),
        (n(["DRIVERS MUST", "WEAR HI-VIS"], background="blue", cap=0.14, post_height=1.5), "hi-vis sign", -18.4, 3.2, 186, {"kind": "mandatory", "colour": "blue"}),
        (n(["LOADING CREW", "LOOK UP"], background="yellow", cap=0.13, post_height=1.4), "look up sign", 15.0, 2.6, 350, {"kind": "warning", "colour": "yellow"}),
        (n(["NO ENTRY", "EXCEPT CRANE"], background="red", cap=0.15, post_height=1.4), "no entry sign", 31.6, -5.6, 345, {"kind": "prohibition", "colour": "red"}),
        (n(["TRAILERS ONLY", "BAYS 61 TO 65"], background="blue", cap=0.17, post_height=1.6), "trailer bays sign", -39.8, 23.0, 110, {"kind": "information", "colour": "blue"}),
        (n(["NORTHGATE", "FREIGHT", "DISTRIBUTION CENTRE"], background="blue", cap=0.30, post_height=1.2), "company board", 15.6, -44.6, 180, {"kind": "company name", "colour": "blue"}),
        (n(["THANK YOU", "DRIVE SAFELY"], background="green", cap=0.18, post_height=1.3), "thank you sign", 12.6, -40.2, 300, {"kind": "information", "colour": "green"}),
    ]  # fmt: skip
    for built, name, x, y, bearing, facts in standing:
        words = " ".join(t.text for t in built.texts).lower()
        stage.place(built, "sign", name, (x, y, 0), bearing, reads=words, **facts)
    for limit, x, y, bearing in (("10", -4.2, -30.4, 180), ("5", -3.6, 5.2, 180), ("5", 9.8, 9.4, 0)):
        stage.place(signs.round_limit(limit, diameter=0.60, post_height=1.7), "speed sign", f"{limit} mph speed limit sign", (x, y, 0), bearing, reads=limit, limit=limit)
    for letter, x, y, bearing in (("A", -13.2, -11.6, 178), ("B", 15.0, 0.6, 250)):
        stage.place(yard_safety.assembly_point(letter), "sign", "fire assembly point sign", (x, y, 0), bearing, kind="safety", colour="green", reads=f"assembly point {letter.lower()}", letter=letter.lower())
    _on_walls(stage)


def _on_walls(stage: Stage) -> None:
    n = yard_safety.notice
    glowing = warehouse.letters
    rows: list[tuple[Built, str, float, float, float, dict[str, str]]] = [
        (glowing("GOODS IN", 0.42), "lit goods in sign", GOODS_IN_X, FRONT_Y, 5.30, {"state": "lit", "kind": "name", "colour": "white"}),
        (glowing("RECEPTION", 0.26), "lit reception sign", OFFICE_X - 1.3, OFFICE_Y, 3.38, {"state": "lit", "kind": "name", "colour": "white"}),
        (n(["STAFF ONLY"], background="white", cap=0.10), "staff only sign", 16.6, FRONT_Y - 0.02, 2.62, {"kind": "prohibition", "colour": "white"}),
        (n(["SOUND HORN"], background="yellow", cap=0.18), "sound horn sign", 26.3, FRONT_Y, 3.6, {"kind": "warning", "colour": "yellow"}),
        (n(["MAX HEIGHT", "4.5 m"], background="yellow", cap=0.17), "height sign", -11.0, FRONT_Y - 3.24, 4.93, {"kind": "limit", "colour": "yellow"}),
        (n(["ENGINES OFF", "WHILE LOADING"], background="red", cap=0.15), "engines off sign", 0.4, FRONT_Y - 3.24, 4.93, {"kind": "prohibition", "colour": "red"}),
        (n(["CHOCK WHEELS"], background="blue", cap=0.17), "chock wheels sign", -21.4, FRONT_Y - 3.24, 4.96, {"kind": "mandatory", "colour": "blue"}),
        (n(["HOSE REEL"], background="red", cap=0.08), "hose reel sign", 27.3, FRONT_Y, 2.1, {"kind": "safety", "colour": "red"}),
    ]  # fmt: skip
    for built, name, x, y, z, facts in rows:
        words = " ".join(t.text for t in built.texts).lower()
        stage.place(built, "sign", name, (x, y, z), 180, reads=words, **facts)
    for x in (DOCK_X[1] + 2.42, DOCK_X[3] + 2.42):
        stage.place(yard_safety.alarm_beacon(), "beacon", "lit amber beacon", (x, FRONT_Y - 0.02, 3.0), 180, state="lit", colour="amber")
