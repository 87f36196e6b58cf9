"""Routes that list the cameras and return a camera's state."""

from __future__ import annotations

from dataclasses import asdict

from fastapi import APIRouter

from scope_ptz.camera.base import Camera
from scope_ptz.camera.guard.guarded_camera import GuardedCamera
from scope_ptz.camera.guard.wrapper import layers
from scope_ptz.serve.http.dependencies import SiteDep, StationDep, Viewer, presets_of
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import (
    CameraState,
    CameraSummary,
    ControlModel,
    ControlRequestModel,
    LimitsModel,
    PoseModel,
    PresetModel,
    RegionModel,
    SpeedModel,
)
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.station import Station

router = APIRouter(prefix="/cameras", tags=["cameras"])


@router.get("", responses=responses())
async def list_cameras(site: SiteDep, client: Viewer) -> list[CameraSummary]:  # noqa: ARG001 - checks the token
    """List the cameras."""
    return [
        CameraSummary(
            name=station.name,
            open=station.is_open,
            run=station.current_run.id if station.current_run else None,
            holder=station.control.holder.name if station.control.holder else None,
        )
        for station in site.stations.values()
    ]


@router.get("/{camera}", responses=responses(404, 409, 503))
async def camera_state(site: SiteDep, station: StationDep, client: Viewer) -> CameraState:
    """Return a camera's state. The first request opens the camera."""
    opened = await station.get_open_camera()
    camera = opened.camera
    info, pose = camera.info, await camera.pose()
    return CameraState(
        name=station.name,
        title=info.name,
        simulated=info.simulated,
        scene=opened.scene.name if opened.scene is not None else None,
        viewpoint=await station.viewpoint(),
        frame_width=info.frame_width,
        frame_height=info.frame_height,
        pose=PoseModel.of(pose),
        hfov_deg=info.optics.hfov_deg(pose.zoom),
        time_s=camera.clock.now_s(),
        limits=LimitsModel(**asdict(info.limits)),
        top_speed=SpeedModel(**asdict(info.capabilities.top_speed)),
        edits_presets=info.capabilities.edits_presets,
        fields_of_view=list(info.optics.table),
        presets=[PresetModel.of(preset) for preset in await presets_of(site, station).all()],
        keep_out=_keep_out_regions(camera),
        run=station.current_run.id if station.current_run else None,
        can_undo=station.can_undo,
        control=control_model(station, client),
        assumed=list(info.assumed),
    )


def control_model(station: Station, client: Client) -> ControlModel:
    """Return a reply to ``client`` that states which client controls a camera, and which clients are asking for control."""
    control, holder = station.control, station.control.holder
    return ControlModel(
        holder=holder.name if holder else None,
        since=control.since if holder else None,
        mine=holder is not None and holder.key == client.key,
        requests=[ControlRequestModel(client=request.key, name=request.name, since=request.since) for request in control.requests],
    )


def _keep_out_regions(camera: Camera) -> list[RegionModel]:
    for layer in layers(camera):
        if isinstance(layer, GuardedCamera):
            regions = layer.rules.keep_out
            return [RegionModel(name=region.name, pan_deg=region.pan_deg, tilt_deg=region.tilt_deg) for region in regions]
    return []
