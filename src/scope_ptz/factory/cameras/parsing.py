"""Parse camera specs, and list the cameras that can be opened."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from urllib.parse import parse_qsl

from scope_ptz.builtin_names import BLENDER_WINDOW
from scope_ptz.camera.spec import CameraSpec
from scope_ptz.entry_points import CAMERAS, find, installed
from scope_ptz.errors import InputError, UnknownNameError
from scope_ptz.factory.cameras.network import NETWORK_SCHEMES, check_network_spec
from scope_ptz.factory.scenes import scene_search
from scope_ptz.settings import find_camera_file, load_settings

BUILT_IN_SCHEMES = ("sim", "blender", BLENDER_WINDOW, *NETWORK_SCHEMES)

_FRAME_OPTIONS = ("width", "height")
_OPTIONS = {"sim": _FRAME_OPTIONS, "blender": (*_FRAME_OPTIONS, "samples")}
_BLENDER_FILES = (".blend", ".py")


def parse_camera(text: str) -> CameraSpec:
    """Parse a camera spec.

    Args:
        text: A scene (``highway-works`` or ``sim:highway-works``), a scene or file rendered by Blender
            (``blender:highway-works``, ``blender:yard.blend``), a network camera (``axis://operator@10.0.0.7``), or
            ``SCHEME:ADDRESS`` for a plug-in's camera. Options follow a question mark:
            ``blender:yard.blend?samples=4&width=640&height=360``. A name without a colon may also be a camera in ``scope.yaml``.

    Raises:
        InputError: The spec is empty or contains a password, its scheme or an option is unknown, or a file does not exist.
    """
    text = text.strip()
    scheme, colon, rest = text.partition(":")
    if text == BLENDER_WINDOW:
        colon = ":"
    if not colon:
        if (named := _named_spec(text)) is not None:
            return named
        scheme, rest = "sim", text
    scheme = scheme.lower()
    address, _, query = rest.partition("?")
    if _has_credentials(scheme, address):
        raise InputError(
            f"Remove user:password@ from the camera spec `{scheme}:...`. Otherwise, traces and the shell history would contain the "
            "password."
        )
    if scheme not in BUILT_IN_SCHEMES and find(CAMERAS, scheme) is None:
        raise InputError(unknown_scheme(scheme, text))
    spec = CameraSpec(scheme, address.removeprefix("//"), dict(parse_qsl(query, keep_blank_values=True)))
    if scheme in BUILT_IN_SCHEMES:
        _check_built_in(spec)
    return spec


def _named_spec(text: str) -> CameraSpec | None:
    """Return the spec of a camera in ``scope.yaml``; None if the file has no camera with this name."""
    if find_camera_file(load_settings()) is None:
        return None
    from scope_ptz.factory.cameras.named_cameras import named_cameras

    named = named_cameras().get(text)
    if named is None:
        return None
    if ":" not in named.camera:
        raise InputError(f"The camera '{text}' in scope.yaml must have a spec with a scheme, such as sim:{named.camera[:60]}.")
    return replace(parse_camera(named.camera), name=text)


def camera_names() -> tuple[str, ...]:
    """Return the available camera specs, with placeholders such as ``axis://USER@HOST`` where an address is required.

    These are the cameras in ``scope.yaml``, scenes, scenes that Blender can render live, network cameras and plug-in cameras.
    """
    from scope_ptz.blender.sources import scene_names
    from scope_ptz.simulator.pack import list_scenes

    scenes = list_scenes(scene_search(load_settings()))
    live = [f"blender:{name}" for name in scene_names()]
    plugins = [f"{entry.name}:ADDRESS" for entry in installed(CAMERAS) if entry.name not in BUILT_IN_SCHEMES]
    network = [f"{scheme}://USER@HOST" for scheme in NETWORK_SCHEMES]
    named: tuple[str, ...] = ()
    if find_camera_file(load_settings()) is not None:
        from scope_ptz.factory.cameras.named_cameras import named_cameras

        named = tuple(named_cameras())
    return (*named, *scenes, *live, "blender:FILE.blend", *network, *plugins)


def frame_size(spec: CameraSpec) -> tuple[int, int]:
    """Return the frame width and height from a spec's options. The default is 1280 x 720 pixels."""
    return int(spec.options.get("width", 1280)), int(spec.options.get("height", 720))


def _has_credentials(scheme: str, address: str) -> bool:
    """Return whether an address looks like ``user:password@host``. Scene and Blender file names may look similar and are exempt."""
    if scheme in BUILT_IN_SCHEMES and scheme not in NETWORK_SCHEMES and not address.startswith("//"):
        return False
    before, at, _ = address.rpartition("@")
    return bool(at) and ":" in before


def unknown_scheme(scheme: str, text: str) -> str:
    """Return the error message for an unknown scheme.

    Args:
        scheme: The scheme in lower case.
        text: The whole spec.
    """
    if text.lower().endswith(_BLENDER_FILES) and len(scheme) == 1:  # a Windows drive letter
        return f"'{text}' is a file. Use blender:{text} to open it with Blender."
    # The message omits the address, which may contain a password if the scheme was mistyped.
    return str(UnknownNameError("camera scheme", scheme, [*BUILT_IN_SCHEMES, *(entry.name for entry in installed(CAMERAS))]))


def _check_built_in(spec: CameraSpec) -> None:
    if spec.scheme in NETWORK_SCHEMES:
        check_network_spec(spec)
        return
    if spec.scheme == BLENDER_WINDOW:
        if spec.address or spec.options:
            raise InputError(
                f"The camera spec {BLENDER_WINDOW} does not accept an address or options. Set the picture size in Blender."
            )
        return
    if not spec.address:
        raise InputError(
            "The camera spec does not name a scene. Add one, for example sim:highway-works. `scope scene list` lists the scenes."
        )
    known = _OPTIONS[spec.scheme]
    for name, value in spec.options.items():
        if name not in known:
            raise UnknownNameError("camera option", name, known)
        if not value.isdecimal() or not 0 < int(value) <= 10_000:
            raise InputError(f"The camera option {name} must be a whole number from 1 to 10000; got '{value[:40]}'.")
    is_file = spec.address.lower().endswith(_BLENDER_FILES)
    if spec.scheme == "sim" and is_file:
        raise InputError(f"'{spec.address}' is a file. Use blender:{spec.address} to open it with Blender.")
    if spec.scheme == "blender":
        if is_file and not Path(spec.address).is_file():
            raise InputError(f"The file {spec.address} does not exist.")
        if not is_file:
            from scope_ptz.blender.sources import scene_names

            if spec.address not in (names := scene_names()):
                raise UnknownNameError("scene that Blender can build", spec.address, [*names, "FILE.blend"])
