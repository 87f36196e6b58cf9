"""Routes for manual moves, presets and camera control."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Response

from scope_ptz.errors import InputError
from scope_ptz.geometry import Pose
from scope_ptz.perception.base import Box
from scope_ptz.serve.http.camera_routes import control_model
from scope_ptz.serve.http.dependencies import Operator, SiteDep, StationDep, StoppingOperator, Viewer, presets_of
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import (
    ArrivalModel,
    Centre,
    ControlAnswer,
    ControlModel,
    Drive,
    Move,
    PoseModel,
    PresetModel,
    PresetName,
    PresetText,
    ZoomToBox,
)
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.station import Station
from scope_ptz.tools.aiming import aim, aim_at_zoom, projection_outline, view

MIN_BOX = 0.005
"""Minimum side of the box in a ``frame-box`` request, as a fraction of the frame's width or height."""

router = APIRouter(prefix="/cameras/{camera}", tags=["manual control"])
Name = Annotated[str, Path(min_length=1, max_length=31)]
_ERRORS = responses(404, 409, 503)


@router.post("/move", responses=_ERRORS)
async def move(station: StationDep, client: Operator, body: Move) -> ArrivalModel:
    """Go to an absolute pose. The server replies when the camera has arrived."""
    async with station.command(client) as camera:
        current = await camera.pose()
        target = Pose(
            current.pan_deg if body.pan_deg is None else body.pan_deg,
            current.tilt_deg if body.tilt_deg is None else body.tilt_deg,
            current.zoom if body.zoom is None else body.zoom,
        )
        return ArrivalModel.of(await camera.move(target))


@router.post("/centre", responses=_ERRORS)
async def centre(station: StationDep, client: Operator, body: Centre) -> ArrivalModel:
    """Turn the camera so that a point in a picture is in the centre, at the same magnification."""
    async with station.command(client) as camera:
        if body.pose is None:
            return ArrivalModel.of(await camera.centre_on(body.x, body.y))
        pose = body.pose.pose()
        point = Box(x_min=body.x, y_min=body.y, x_max=body.x, y_max=body.y)
        target = projection_outline(view(camera.info, pose), point, 1)
        return ArrivalModel.of(await camera.move(aim_at_zoom(camera.info, target, (await camera.pose()).zoom).pose))


@router.post("/frame-box", responses=_ERRORS)
async def frame_box(station: StationDep, client: Operator, body: ZoomToBox) -> ArrivalModel:
    """Turn and zoom the camera so that a box in a picture fills the view."""
    if body.x_max - body.x_min < MIN_BOX or body.y_max - body.y_min < MIN_BOX:
        raise InputError(f"Each side of the box must be at least {MIN_BOX} of the frame, and its minima must be below its maxima.")
    async with station.command(client) as camera:
        pose = body.pose.pose() if body.pose is not None else await camera.pose()
        box = Box(x_min=body.x_min, y_min=body.y_min, x_max=body.x_max, y_max=body.y_max)
        target = projection_outline(view(camera.info, pose), box)
        return ArrivalModel.of(await camera.move(aim(camera.info, pose, target, fill=1.0).pose))


@router.post("/drive", status_code=204, responses=_ERRORS)
async def drive(station: StationDep, client: Operator, body: Drive) -> Response:
    """Move at constant velocities until the timeout or the next command. Repeat the request to keep moving."""
    await station.drive(client, body.pan_dps, body.tilt_dps, body.zoom_rate, body.timeout_s)
    return Response(status_code=204)


@router.post("/stop", status_code=204, responses=responses(404, 503))
async def stop(station: StationDep, client: StoppingOperator) -> Response:  # noqa: ARG001 - checks the token
    """Stop the camera and cancel the run in progress. Any operator may do so, even without control."""
    await station.stop()
    return Response(status_code=204)


@router.post("/home", responses=_ERRORS)
async def home(station: StationDep, client: Operator) -> ArrivalModel:
    """Go to the home view."""
    async with station.command(client) as camera:
        return ArrivalModel.of(await camera.go_home())


@router.post("/undo", responses=_ERRORS)
async def undo(station: StationDep, client: Operator) -> ArrivalModel:
    """Return to the view before the last command (a run, a tool call, a move or a drive)."""
    return ArrivalModel.of(await station.undo(client))


@router.get("/presets", responses=_ERRORS)
async def list_presets(site: SiteDep, station: StationDep, client: Viewer) -> list[PresetModel]:  # noqa: ARG001 - checks the token
    """List the presets, with their poses where known."""
    return [PresetModel.of(preset) for preset in await presets_of(site, station).all()]


@router.put("/presets/{name}", responses=_ERRORS)
async def save_preset(site: SiteDep, station: StationDep, client: Operator, name: Name, body: PresetText) -> PresetModel:
    """Save the current view as a preset. An existing preset with the same name is replaced."""
    saved = await presets_of(site, station).save(client, name, body.description)
    return await _preset_model(site, station, saved.name)


@router.patch("/presets/{name}", responses=_ERRORS)
async def rename_preset(site: SiteDep, station: StationDep, client: Operator, name: Name, body: PresetName) -> PresetModel:
    """Rename a preset. The camera goes to the preset and back."""
    saved = await presets_of(site, station).rename(client, name, body.name)
    return await _preset_model(site, station, saved.name)


@router.delete("/presets/{name}", status_code=204, responses=_ERRORS)
async def remove_preset(site: SiteDep, station: StationDep, client: Operator, name: Name) -> Response:
    """Remove a preset."""
    await presets_of(site, station).remove(client, name)
    return Response(status_code=204)


@router.post("/presets/{name}/go", responses=_ERRORS)
async def go_to_preset(site: SiteDep, station: StationDep, client: Operator, name: Name) -> ArrivalModel:
    """Go to a preset."""
    return ArrivalModel.of(await presets_of(site, station).go_to(client, name))


@router.get(
    "/presets/{name}/thumbnail",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "A small picture of the preset's view"}, **_ERRORS},
)
async def preset_thumbnail(site: SiteDep, station: StationDep, client: Viewer, name: Name) -> Response:  # noqa: ARG001
    """Return a small picture of a preset's view. A preset of a real camera has one only after it was saved or visited here."""
    return Response(
        await presets_of(site, station).thumbnail(name), media_type="image/jpeg", headers={"Cache-Control": "private, max-age=5"}
    )


async def _preset_model(site: Site, station: Station, name: str) -> PresetModel:
    return PresetModel.of(next(known for known in await presets_of(site, station).all() if known.preset.name == name))


@router.get("/control", responses=_ERRORS)
async def control(station: StationDep, client: Viewer) -> ControlModel:
    """Return which client controls the camera, and which clients are asking for control."""
    return control_model(station, client)


@router.post("/control", responses=_ERRORS)
async def ask_for_control(station: StationDep, client: Operator) -> ControlModel:
    """Take control if nobody has it; otherwise, ask the controlling client for it.

    In the reply, `mine` is true if the client that sent this request has control.
    """
    await station.control.ask(client, await station.camera())
    return control_model(station, client)


@router.post("/control/answer", responses=_ERRORS)
async def answer_request(station: StationDep, client: Operator, body: ControlAnswer) -> ControlModel:
    """Hand control over to a client that is asking for it, or refuse. Only the controlling client can answer."""
    await station.control.answer(client, body.client, await station.camera(), grant=body.grant)
    return control_model(station, client)


@router.delete("/control", responses=_ERRORS)
async def release_control(station: StationDep, client: Operator) -> ControlModel:
    """Give up control, or withdraw a request for it."""
    await station.control.release(client)
    return control_model(station, client)


@router.get("/pose", responses=_ERRORS)
async def pose(station: StationDep, client: Viewer) -> PoseModel:  # noqa: ARG001 - checks the token
    """Return the camera's current pose."""
    return PoseModel.of(await (await station.camera()).pose())
