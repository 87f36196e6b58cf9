"""Routes that work only for simulated cameras: scene time and virtual cameras."""

from __future__ import annotations

from fastapi import APIRouter, Response

from scope_ptz.serve.http.camera_models import SceneTimeBody, SceneTimeModel, VirtualCameraBody, VirtualCameraModel
from scope_ptz.serve.http.dependencies import Operator, SiteDep, StationDep, Viewer
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.site.scene_time import SceneTimeChange, change_scene_time, read_scene_time

router = APIRouter(prefix="/cameras/{camera}", tags=["simulation"])
_ERRORS = responses(404, 409, 503)


@router.get("/time", responses=_ERRORS)
async def camera_time(station: StationDep, client: Viewer) -> SceneTimeModel:  # noqa: ARG001 - checks the token
    """Return a simulated camera's scene time. For other cameras, the request fails with the code `not_simulated`."""
    scene_time = await read_scene_time(station)
    return SceneTimeModel(time_s=scene_time.time_s, playing=scene_time.playing, speed=scene_time.speed)


@router.patch("/time", responses=_ERRORS)
async def change_camera_time(station: StationDep, client: Operator, body: SceneTimeBody) -> SceneTimeModel:
    """Play or pause scene time, seek, or change the speed. The change applies to all of the camera's clients.

    Like other commands, the request needs control and is refused during a run. If the camera is not simulated, the request fails
    with the code `not_simulated`.
    """
    scene_time = await change_scene_time(station, client, SceneTimeChange(body.time_s, body.playing, body.speed))
    return SceneTimeModel(time_s=scene_time.time_s, playing=scene_time.playing, speed=scene_time.speed)


@router.get("/virtual", responses=_ERRORS)
async def virtual_camera(site: SiteDep, station: StationDep, client: Viewer) -> VirtualCameraModel:  # noqa: ARG001 - checks the token
    """Return whether a scene's virtual camera is on, and its addresses on the server's machine."""
    return VirtualCameraModel.of(site.virtual_cameras.find(station.name))


@router.post("/virtual", status_code=201, responses=_ERRORS)
async def turn_virtual_camera_on(
    site: SiteDep,
    station: StationDep,
    client: Operator,  # noqa: ARG001 - checks the token
    body: VirtualCameraBody,
) -> VirtualCameraModel:
    """Serve a camera's scene as a network camera with VAPIX, ONVIF and RTSP, for programs on the server's machine.

    The operating system chooses the ports. The reply contains the account name and the password, which cannot be retrieved again.
    """
    camera, password = await site.virtual_cameras.turn_on(station, body.viewpoint)
    return VirtualCameraModel.of(camera, password)


@router.delete("/virtual", status_code=204, responses=_ERRORS)
async def turn_virtual_camera_off(site: SiteDep, station: StationDep, client: Operator) -> Response:  # noqa: ARG001 - checks the token
    """Turn a scene's virtual camera off and disconnect its clients. If it is already off, the request has no effect."""
    await site.virtual_cameras.turn_off(station.name)
    return Response(status_code=204)
