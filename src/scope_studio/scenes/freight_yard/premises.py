"""Freight yard: the warehouse with its docks and office, and the fixtures on its walls."""

from __future__ import annotations

from scope_studio.kit.buildings import docks, offices, warehouse
from scope_studio.kit.core.stage import Stage
from scope_studio.kit.light import dusk
from scope_studio.kit.yard import lamps as yard_lamps

FRONT_Y = 30.0
"""y coordinate of the front of the warehouse."""
FRONT_CENTRE_X = -1.0
"""x coordinate of the centre of the front."""
WIDTH_M, HEIGHT_M = 58.0, 7.4
"""Width and height of the warehouse in metres."""
DOCK_X = [-24.0 + 5.4 * k for k in range(8)]
"""x coordinates of the docks."""
DOCK_STATES = ("closed", "open", "open", "open", "half open", "closed", "open", "closed")
"""State of the roller door at each dock."""
DOCK_LIGHTS = ("green", "red", "green", "red", "green", "unlit", "red", "green")
"""Colour of the traffic light at each dock."""
RECEIVING_X = 22.0
"""x coordinate of the large roller door at yard level."""
OFFICE_X, OFFICE_Y, OFFICE_M = -38.0, 27.0, (16.0, 24.0, 7.2)
"""Position (x, y) and size (width, depth, height) of the office in metres."""


def build(stage: Stage) -> None:
    """Place the warehouse, its docks and its office."""
    _warehouse(stage)
    _docks(stage)
    _office(stage)


def _local_x(x: float) -> float:
    """Convert a world x coordinate to the warehouse's local x coordinate."""
    return FRONT_CENTRE_X - x


def _warehouse(stage: Stage) -> None:
    half = docks.DOCK_WIDTH_M / 2
    openings = [
        (_local_x(x) - half, _local_x(x) + half, docks.DOCK_SILL_M, docks.DOCK_SILL_M + docks.DOCK_HEIGHT_M) for x in DOCK_X
    ]
    openings.append((_local_x(RECEIVING_X) - 2.3, _local_x(RECEIVING_X) + 2.3, 0.0, 4.6))
    shell = warehouse.shell(
        width=WIDTH_M,
        depth=34.0,
        height=HEIGHT_M,
        openings=openings,
        colour=(0.36, 0.38, 0.40),
        band=(0.02, 0.09, 0.28),
        ramp_to=_local_x(17.6),
    )
    main = stage.place(
        shell,
        "warehouse",
        "grey warehouse",
        (FRONT_CENTRE_X, FRONT_Y, 0),
        180,
        colour="grey",
        material="metal cladding",
        name_on_it="northgate freight",
    )
    stage.place(warehouse.canopy(44.0), "canopy", "blue dock canopy", (-5.1, FRONT_Y, 0), 180, parent=main, colour="blue")
    stage.place(
        warehouse.letters("NORTHGATE FREIGHT", 1.15),
        "sign",
        "lit company name",
        (-6.0, FRONT_Y, 6.45),
        180,
        parent=main,
        state="lit",
        colour="white",
        kind="company name",
    )
    stage.place(
        docks.roller_door("open", width=4.6, height=4.6, sill=0.0, colour="blue"),
        "roller door",
        "wide blue roller door",
        (RECEIVING_X, FRONT_Y, 0),
        180,
        parent=main,
        state="open",
        colour="blue",
        lit="inside",
        kind="level door",
    )
    for x in (-21.0, -9.0, 12.0, 25.0):
        flood = yard_lamps.floodlight()
        stage.place(flood, "floodlight", "lit floodlight", (x, FRONT_Y, 7.25), 180, parent=main, state="lit", light="white")
        dusk.lamplight((x, FRONT_Y - 0.75, 7.15), 480, dusk.LED, size_m=0.45, aim=(0, -1.0, -0.62), spread_deg=95)
    for x, z, kind, lit in ((18.2, 4.9, "sodium", True), (26.4, 4.9, "sodium", True), (-27.6, 5.6, "sodium", False)):
        stage.place(
            yard_lamps.wall_pack(kind=kind, lit=lit),
            "wall lamp",
            "wall lamp",
            (x, FRONT_Y, z),
            180,
            parent=main,
            state="lit" if lit else "unlit",
        )
        if lit:
            dusk.lamplight((x, FRONT_Y - 0.45, z - 0.15), 130, dusk.SODIUM, size_m=0.35, aim=(0, -0.35, -1))


def _docks(stage: Stage) -> None:
    prototypes: dict[str, docks.Built] = {}

    def get(key: str, make) -> docks.Built:
        if key in prototypes:
            return prototypes[key].copy()
        return prototypes.setdefault(key, make())

    for k, (x, state, light) in enumerate(zip(DOCK_X, DOCK_STATES, DOCK_LIGHTS, strict=True), start=1):
        position = (x, FRONT_Y, 0.0)
        inside = {"inside": "lit"} if state != "closed" else {}
        door = stage.place(
            get(f"door {state}", lambda state=state: docks.roller_door(state)),
            "roller door",
            f"dock door {k}",
            position,
            180,
            state=state,
            number=str(k),
            colour="grey",
            kind="dock door",
            **inside,
        )
        stage.place(get("shelter", docks.shelter), "dock shelter", "black dock shelter", position, 180, parent=door, colour="black")
        stage.place(
            get("leveller", docks.leveller), "dock leveller", "steel dock leveller", position, 180, parent=door, material="steel"
        )
        stage.place(
            docks.number(str(k)),
            "dock number",
            f"dock number {k}",
            (x, FRONT_Y - 3.24, 5.45),
            180,
            parent=door,
            colour="blue",
            number=str(k),
        )
        name = {"red": "red dock light", "green": "green dock light", "unlit": "unlit dock light"}[light]
        attributes = {"state": "unlit"} if light == "unlit" else {"state": "lit", "colour": light}
        stage.place(
            get(f"light {light}", lambda light=light: docks.signal(light)),
            "dock light",
            name,
            (x + 2.42, FRONT_Y - 0.03, 2.3),
            180,
            parent=door,
            dock=str(k),
            **attributes,
        )
        if k in (1, 3, 8):
            stage.place(
                get("guides", docks.wheel_guides), "wheel guide", "yellow wheel guides", position, 180, colour="yellow", dock=str(k)
            )


def _office(stage: Stage) -> None:
    width, depth, height = OFFICE_M
    columns = [-6.2, -3.7, -1.2, 1.3, 3.8, 6.3]
    openings = [(x - 0.8, x + 0.8, z - 0.7, z + 0.7) for x in columns for z in (1.8, 5.0) if not (x == 1.3 and z < 2)]
    shell = offices.wing(width=width, depth=depth, height=height, openings=openings, colour=(0.46, 0.47, 0.48))
    office = stage.place(
        shell, "building", "two-storey office", (OFFICE_X, OFFICE_Y, 0), 180, colour="grey", kind="office", floors=2
    )
    lit = {(-6.2, 5.0), (-3.7, 1.8), (-1.2, 5.0), (3.8, 1.8), (3.8, 5.0), (6.3, 1.8), (-6.2, 1.8)}
    for n, (x, z) in enumerate((x, z) for x in columns for z in (1.8, 5.0) if not (x == 1.3 and z < 2)):
        is_lit = (x, z) in lit
        pane = offices.window(width=1.6, height=1.4, lit=is_lit, blind=0.45 if n in (2, 7) else 0.0, seed=n)
        stage.place(
            pane,
            "window",
            "lit office window" if is_lit else "dark office window",
            (OFFICE_X - x, OFFICE_Y, z),
            180,
            parent=office,
            state="lit" if is_lit else "unlit",
            floor="upper" if z > 3 else "ground",
        )
    stage.place(
        offices.door(),
        "door",
        "glazed office door",
        (OFFICE_X - 1.3, OFFICE_Y, 0),
        180,
        parent=office,
        state="closed",
        material="glass",
        lit="inside",
    )
    stage.place(
        offices.door(glazed=False),
        "door",
        "blue staff door",
        (16.6, FRONT_Y, 0),
        180,
        state="closed",
        colour="blue",
        material="steel",
    )
    stage.place(
        yard_lamps.wall_pack(kind="warm"),
        "wall lamp",
        "wall lamp",
        (OFFICE_X - 1.3, OFFICE_Y, 2.9),
        180,
        parent=office,
        state="lit",
    )
    dusk.lamplight((OFFICE_X - 1.3, OFFICE_Y - 0.5, 2.75), 60, dusk.WARM, size_m=0.35, aim=(0, -0.4, -1))
