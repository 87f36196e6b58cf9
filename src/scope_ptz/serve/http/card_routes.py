"""Routes for camera cards and thumbnails, for pages that list cameras."""

from __future__ import annotations

from typing import Annotated

from anyio import to_thread
from fastapi import APIRouter, Query, Response

from scope_ptz.serve.http.camera_models import CameraCardModel, HealthModel, SceneModel, SceneTimeModel, VirtualCameraModel
from scope_ptz.serve.http.camera_routes import control_model
from scope_ptz.serve.http.dependencies import SiteDep, StationDep, Viewer, presets_of
from scope_ptz.serve.http.errors import responses
from scope_ptz.serve.http.models import Problem
from scope_ptz.serve.site.error_codes import status_of
from scope_ptz.serve.site.live_picture import encode_jpeg
from scope_ptz.serve.site.scene_time import scene_time

router = APIRouter(prefix="/cameras/{camera}", tags=["cameras"])


@router.get("/card", responses=responses(404))
async def camera_card(site: SiteDep, station: StationDep, client: Viewer) -> CameraCardModel:
    """Return a camera's kind and abilities, and check whether it works. A failure is part of the reply.

    The check connects to a device, but does not open a simulated camera.
    """
    card = await site.cards.card(station)
    opened, scene, problem = station.open_camera, card.scene, card.problem
    return CameraCardModel(
        name=station.name,
        title=card.title,
        kind=card.kind,
        scene=None if scene is None else SceneModel(
            name=scene.name, title=scene.title, viewpoints=list(scene.viewpoints), presets=scene.presets, moving=scene.moving
        ),
        abilities=list(card.abilities),
        health=HealthModel(
            state=card.health, problem=None if problem is None else Problem(code=status_of(problem)[1], message=str(problem))
        ),
        configured=card.configured,
        has_picture=card.has_picture,
        open=station.is_open,
        run=station.current_run.id if station.current_run else None,
        control=control_model(station, client),
        scene_time=None if opened is None else SceneTimeModel.of(scene_time(opened.camera)),
        virtual_camera=VirtualCameraModel.of(site.virtual_cameras.find(station.name)),
    )  # fmt: skip


@router.get(
    "/thumbnail",
    response_class=Response,
    responses={200: {"content": {"image/jpeg": {}}, "description": "A small picture"}, **responses(404, 409, 503)},
)
async def camera_thumbnail(
    site: SiteDep,
    station: StationDep,
    client: Viewer,  # noqa: ARG001 - checks the token
    width: Annotated[int, Query(ge=160, le=640, description="Maximum width in pixels")] = 480,
) -> Response:
    """Return a small picture of a camera's current view. For a scene that has not been used yet, return the home view."""
    if station.is_open:
        newest = station.live.newest
        frame = newest.frame if newest is not None else await (await station.camera()).frame()
        jpeg = await to_thread.run_sync(encode_jpeg, frame.image, min(width, frame.width))
    else:
        jpeg = await presets_of(site, station).home_picture()
    return Response(jpeg, media_type="image/jpeg", headers={"Cache-Control": "no-store"})
