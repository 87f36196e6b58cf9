"""Resources: cameras, presets, scenes, runs, and pictures and panoramas from runs."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from functools import partial
from typing import Any
from urllib.parse import unquote

from anyio import to_thread
from mcp_types import BlobResourceContents, ReadResourceResult, Resource, ResourceTemplate, TextResourceContents
from pydantic import BaseModel

from scope_ptz.errors import InputError, ScopeError, UnknownNameError
from scope_ptz.factory.scenes import open_scene
from scope_ptz.serve.http.camera_routes import camera_state, list_cameras
from scope_ptz.serve.http.dependencies import presets_of
from scope_ptz.serve.http.library_routes import filmstrip
from scope_ptz.serve.http.models import PresetModel
from scope_ptz.serve.mcp.addresses import SCHEME, camera_uri, run_uri, scene_uri
from scope_ptz.serve.mcp.pictures import MAX_RESOURCE_BYTES, UNTRUSTED_META, convert_to_limited_jpeg, encode_limited_jpeg
from scope_ptz.serve.mcp.reports import run_report
from scope_ptz.serve.mcp.untrusted import PictureText
from scope_ptz.serve.site.camera_kinds import scene_of
from scope_ptz.serve.site.clients import Client
from scope_ptz.serve.site.site import Site
from scope_ptz.serve.site.stored_runs import stored_picture
from scope_ptz.store.rows import RunFilter

MAX_LISTED_RUNS = 20
"""Maximum number of runs in the resource list. The newest ones are listed."""

MAX_PICTURE_WIDTH = 8192  # in pixels, for panoramas

_JSON, _JPEG = "application/json", "image/jpeg"


class ScenePresetModel(BaseModel):
    """A preset of a scene. Going to it may change the viewpoint."""

    name: str
    description: str
    viewpoint: str


class SceneModel(BaseModel):
    """A scene that a simulated camera shows.

    It does not list the objects in the scene, because the agent must find them with the camera.
    """

    name: str
    title: str
    viewpoints: list[str]
    home_preset: str
    presets: list[ScenePresetModel]
    cameras: list[str]


def templates() -> list[ResourceTemplate]:
    """Return the templates of all resources whose URIs contain a name."""
    rows = (
        ("scope://cameras/{camera}", "camera", "State of a camera: pose, limits, presets, control", _JSON),
        ("scope://cameras/{camera}/presets", "presets", "Presets of a camera, with their poses if these are known", _JSON),
        ("scope://cameras/{camera}/picture", "live-picture", "What a camera shows now", _JPEG),
        ("scope://scenes/{scene}", "scene", "A scene: its viewpoints and presets", _JSON),
        ("scope://runs/{run}", "run", "A run: its steps, outcome, answer and pictures", _JSON),
        ("scope://runs/{run}/frames/{name}", "frame", "A frame or panorama of a run", _JPEG),
        ("scope://runs/{run}/pictures/{name}", "picture", "A picture that take_image saved", _JPEG),
        ("scope://runs/{run}/filmstrip", "filmstrip", "All steps of a run as one image", _JPEG),
    )
    return [ResourceTemplate(uri_template=uri, name=name, description=text, mime_type=kind) for uri, name, text, kind in rows]


async def resources(site: Site) -> list[Resource]:
    """Return the cameras, their presets, the scenes, and the newest runs."""
    listed = [Resource(uri=f"{SCHEME}://cameras", name="cameras", description="The cameras of this server", mime_type=_JSON)]
    for name in site.stations:
        listed.append(Resource(uri=camera_uri(name), name=name, description=f"State of the camera {name}", mime_type=_JSON))
        description = f"Presets of the camera {name}"
        listed.append(Resource(uri=camera_uri(name, "presets"), name=f"{name}/presets", description=description, mime_type=_JSON))
        description = f"What the camera {name} shows now"
        listed.append(Resource(uri=camera_uri(name, "picture"), name=f"{name}/picture", description=description, mime_type=_JPEG))
    for scene in scenes_of(site):
        listed.append(Resource(uri=scene_uri(scene), name=scene, description=f"The scene {scene}", mime_type=_JSON))
    listed.append(Resource(uri=f"{SCHEME}://runs", name="runs", description="The newest runs", mime_type=_JSON))
    for run in await _newest_runs(site):
        description = f"{run['instruction'][:80]} ({run['outcome']})"
        listed.append(Resource(uri=run_uri(run["run"]), name=run["run"], description=description, mime_type=_JSON))
    return listed


def scenes_of(site: Site) -> dict[str, list[str]]:
    """Return the stored scenes that the site's cameras show, each with the names of those cameras."""
    found: dict[str, list[str]] = {}
    for station in site.stations.values():
        try:
            scene = scene_of(station.spec)
        except ScopeError:  # the camera is no longer in scope.yaml
            continue
        if scene is not None:
            found.setdefault(scene, []).append(station.name)
    return found


async def read_resource(site: Site, client: Client, uri: str) -> ReadResourceResult:
    """Read a resource.

    Args:
        site: The site.
        client: The client that sent the request.
        uri: The URI, which is untrusted. Its parts are looked up as names and never become parts of a path.

    Raises:
        UnknownNameError: There is no such resource.
        ScopeError: The camera, the store or a picture fails.
    """
    scheme, _, rest = uri.partition("://")
    parts = [unquote(part) for part in rest.split("/")]
    if scheme != SCHEME or len(uri) > 1_000:
        raise _unknown(uri)
    match parts:
        case ["cameras"]:
            return _text(uri, [camera.model_dump(mode="json") for camera in await list_cameras(site, client)])
        case ["cameras", name]:
            return _text(uri, await camera_state(site, site.station(name), client))
        case ["cameras", name, "presets"]:
            known = await presets_of(site, site.station(name)).all()
            return _text(uri, [PresetModel.of(preset).model_dump(mode="json") for preset in known])
        case ["cameras", name, "picture"]:
            frame = await (await site.station(name).camera()).frame()
            image = frame.image
            return _blob(uri, await to_thread.run_sync(lambda: encode_limited_jpeg(image, MAX_RESOURCE_BYTES, frame.width)))
        case ["scenes", name]:
            return _text(uri, await _scene(site, name))
        case ["runs"]:
            return _text(uri, await _newest_runs(site), untrusted=True)
        case ["runs", run]:
            return _text(uri, await run_report(site, run), untrusted=True)
        case ["runs", run, "filmstrip"]:
            drawn = bytes((await filmstrip(site, client, run)).body)
            return _blob(uri, await convert_to_limited_jpeg(drawn, MAX_RESOURCE_BYTES, MAX_PICTURE_WIDTH))
        case ["runs", run, ("frames" | "pictures") as folder, name]:
            stored = await stored_picture(site, run, f"{folder}/{name}")
            return _blob(uri, await convert_to_limited_jpeg(stored, MAX_RESOURCE_BYTES, MAX_PICTURE_WIDTH))
        case _:
            raise _unknown(uri)


def completions(site: Site, argument: str, value: str) -> list[str]:
    """Return the names that complete an argument in a prompt or a URI template."""
    names: Sequence[str] = {"camera": list(site.stations), "scene": list(scenes_of(site))}.get(argument, [])
    return [name for name in names if name.startswith(value)][:100]


async def _scene(site: Site, name: str) -> SceneModel:
    scenes = scenes_of(site)
    if name not in scenes:
        raise UnknownNameError("scene", name[:120], scenes)
    file = (await to_thread.run_sync(partial(open_scene, name))).file
    return SceneModel(
        name=file.name,
        title=file.title,
        viewpoints=[viewpoint.name for viewpoint in file.viewpoints],
        home_preset=file.home_preset,
        presets=[
            ScenePresetModel(name=preset.name, description=preset.description, viewpoint=preset.viewpoint)
            for preset in file.presets
        ],
        cameras=scenes[name],
    )


async def _newest_runs(site: Site) -> list[dict[str, Any]]:
    await site.library.wait_for_indexing()
    page = await site.library.in_thread(partial(site.library.store.runs, RunFilter(), limit=MAX_LISTED_RUNS))
    return [
        {
            "run": row.id,
            "camera": row.camera,
            "kind": row.kind,
            "started": row.started.isoformat(),
            "instruction": row.instruction,
            "outcome": row.outcome,
            "answer": PictureText.of(row.answer).model_dump(),
        }
        for row in page.runs
    ]


def _unknown(uri: str) -> InputError:
    listing = ", ".join(template.uri_template for template in templates())
    return InputError(f"There is no resource '{uri[:120]}'. The resources are scope://cameras, scope://runs, {listing}.")


def _text(uri: str, data: BaseModel | list[Any], *, untrusted: bool = False) -> ReadResourceResult:
    text = data.model_dump_json() if isinstance(data, BaseModel) else json.dumps(data, ensure_ascii=False)
    meta = UNTRUSTED_META if untrusted else None
    return ReadResourceResult(contents=[TextResourceContents(uri=uri, text=text, mime_type=_JSON, _meta=meta)])


def _blob(uri: str, jpeg: bytes) -> ReadResourceResult:
    blob = b64encode(jpeg).decode()
    return ReadResourceResult(contents=[BlobResourceContents(uri=uri, blob=blob, mime_type=_JPEG, _meta=UNTRUSTED_META)])
