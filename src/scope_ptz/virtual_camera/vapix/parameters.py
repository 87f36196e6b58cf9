"""Handle ``/axis-cgi/param.cgi``, which lists the camera's parameters and changes the few that are not read-only."""

from __future__ import annotations

from fnmatch import fnmatchcase

from scope_ptz.errors import InputError
from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.vapix import replies
from scope_ptz.virtual_camera.vapix.arguments import MAX_SHOWN_CHARS, Arguments
from scope_ptz.virtual_camera.vapix.control_queue import CONTROL_TIMEOUT_S, PRIORITIES
from scope_ptz.virtual_camera.vapix.identity import identity
from scope_ptz.virtual_camera.vapix.queries import limit_values, preset_data
from scope_ptz.virtual_camera.vapix.replies import Client, Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

ABILITIES = (
    "AbsoluteFocus", "AbsoluteIris", "AbsolutePan", "AbsoluteTilt", "AbsoluteZoom", "AreaZoom", "AutoFocus", "AutoIris",
    "ContinuousFocus", "ContinuousPan", "ContinuousTilt", "ContinuousZoom", "RelativeFocus", "RelativeIris", "RelativePan",
    "RelativeTilt", "RelativeZoom", "ServerPreset", "SpeedCtl",
)  # fmt: skip
UNSUPPORTED_ABILITIES = (
    "AbsoluteBrightness", "ActionNotification", "AutoIrCutFilter", "Auxiliary", "BackLight", "ContinuousBrightness",
    "ContinuousIris", "DevicePreset", "DigitalZoom", "GenericHTTP", "IrCutFilter", "JoyStickEmulation", "LensOffset", "OSDMenu",
    "ProportionalSpeed", "RelativeBrightness",
)  # fmt: skip

QUEUE_GROUP = "PTZ.Various.V1"  # the group of parameters that configure the control queue


def param(camera: VapixCamera, arguments: Arguments, client: Client) -> Reply:
    """Handle a request to ``param.cgi`` with ``action=list`` or ``action=update``."""
    action = arguments.text("action")
    if action == "list":
        return _list(camera, arguments.text("group"))
    if action == "update":
        if client.role < Role.ADMINISTRATOR:
            return Reply(403, "Forbidden\n")
        return _update(camera, arguments)
    return replies.parameter_error(f"action: expected list or update, got {action[:MAX_SHOWN_CHARS]!r}")


def parameters(camera: VapixCamera) -> dict[str, str]:
    """Return all parameters by name, without the prefix ``root.``."""
    return {**_properties(camera), **_media(camera), **_ptz(camera), **_presets(camera)}


def _list(camera: VapixCamera, groups: str) -> Reply:
    known = parameters(camera)
    rows: dict[str, str] = {}
    for group in groups.split(",") if groups else ["*"]:
        name = group.strip().removeprefix("root.").strip(".")
        pattern = "*" if name in ("", "root") else name
        matches = {key: value for key, value in known.items() if _matches(key, pattern)}
        if not matches:
            return replies.parameter_error(f"Error -1 getting param in group '{group.strip()[:MAX_SHOWN_CHARS]}'")
        rows.update(matches)
    return replies.values({f"root.{key}": value for key, value in rows.items()})


def _matches(key: str, pattern: str) -> bool:
    return key == pattern or key.startswith(f"{pattern}.") or ("*" in pattern and fnmatchcase(key, pattern))


def _update(camera: VapixCamera, arguments: Arguments) -> Reply:
    changes = {name.removeprefix("root."): name for name in arguments if name not in ("action", "usergroup", "camera")}
    if not changes:
        return replies.parameter_error("Error -1, nothing to update")
    try:
        for name, argument in changes.items():
            _set(camera, name, arguments, argument)
    except InputError as problem:
        return replies.parameter_error(f"Error -1 setting param, {problem}")
    return Reply(200, "OK\n")


def _set(camera: VapixCamera, name: str, arguments: Arguments, argument: str) -> None:
    if name == f"{QUEUE_GROUP}.CtlQueueing":
        camera.queue.enabled = arguments.choice(argument, ("true", "false")) == "true"
    elif name == f"{QUEUE_GROUP}.CtlQueueLimit":
        camera.queue.limit = arguments.integer(argument, 1, 100)
    elif name == f"{QUEUE_GROUP}.CtlQueuePollTime":
        camera.queue.poll_s = arguments.integer(argument, 5, 3600)
    elif name == "PTZ.UserAdv.U1.MoveSpeed":
        camera.speed = arguments.integer(argument, 1, 100)
    else:
        raise InputError(f"'{name[:MAX_SHOWN_CHARS]}' is unknown or read-only")


def _properties(camera: VapixCamera) -> dict[str, str]:
    properties = identity(camera)
    brand = {
        f"Brand.{key}": properties[key] for key in ("Brand", "ProdFullName", "ProdNbr", "ProdShortName", "ProdType", "ProdVariant")
    }
    return {
        **brand,
        "Brand.WebURL": properties["WebURL"],
        "Properties.API.HTTP.AdminPath": "/",
        "Properties.API.HTTP.Version": "3",
        "Properties.API.Metadata.Metadata": "no",
        "Properties.API.Metadata.Version": "1.0",
        "Properties.API.PTZ.Presets.Version": "2.00",
        "Properties.API.RTSP.Version": "2.01",
        "Properties.Firmware.BuildDate": properties["BuildDate"],
        "Properties.Firmware.BuildNumber": "1",
        "Properties.Firmware.Version": properties["Version"],
        "Properties.Image.Format": "jpeg,mjpeg,h264",
        "Properties.Image.NbrOfViews": "1",
        "Properties.Image.Resolution": ",".join(camera.resolutions()),
        "Properties.Image.Rotation": "0",
        "Properties.Image.ShowSuboptimalResolutions": "false",
        "Properties.PTZ.DigitalPTZ": "no",
        "Properties.PTZ.DriverManagement": "no",
        "Properties.PTZ.DriverModeList": "none",
        "Properties.PTZ.PTZ": "yes",
        "Properties.PTZ.PTZOnQuadView": "no",
        "Properties.PTZ.SelectableDriverMode": "no",
        "Properties.System.Architecture": properties["Architecture"],
        "Properties.System.HardwareID": properties["HardwareID"],
        "Properties.System.Language": "English",
        "Properties.System.LanguageType": "default",
        "Properties.System.SerialNumber": properties["SerialNumber"],
        "Properties.System.Soc": properties["Soc"],
    }


def _media(camera: VapixCamera) -> dict[str, str]:
    resolution = camera.resolutions()[0]
    rtsp = {"Network.RTSP.Enabled": "no"}
    if camera.rtsp_port is not None:
        rtsp = {"Network.RTSP.Enabled": "yes", "Network.RTSP.Port": str(camera.rtsp_port)}
    return {
        **rtsp,
        "Image.I0.Appearance.ColorEnabled": "yes",
        "Image.I0.Appearance.Compression": "30",
        "Image.I0.Appearance.MirrorEnabled": "no",
        "Image.I0.Appearance.Resolution": resolution,
        "Image.I0.Appearance.Rotation": "0",
        "Image.I0.Enabled": "yes",
        "Image.I0.Name": camera.device.name.replace("\n", " "),
        "Image.I0.Source": "0",
        "Image.I0.Stream.Duration": "0",
        "Image.I0.Stream.FPS": "0",
        "Image.I0.Stream.NbrOfFrames": "0",
        "Image.NbrOfConfigs": "1",
        "IOPort.I0.Configurable": "no",
        "IOPort.I0.Direction": "input",
        "IOPort.I0.Input.Name": "Input 1",
        "IOPort.I0.Input.Trig": "closed",
        "StreamProfile.MaxGroups": "26",
        "StreamProfile.S0.Description": "Full size",
        "StreamProfile.S0.Name": "Quality",
        "StreamProfile.S0.Parameters": f"videocodec=h264&resolution={resolution}",
    }


def _ptz(camera: VapixCamera) -> dict[str, str]:
    queue = camera.queue
    support = {**dict.fromkeys(ABILITIES, "true"), **dict.fromkeys(UNSUPPORTED_ABILITIES, "false")}
    content: dict[str, object] = {
        "BoaProtPTZOperator": "password",
        "CameraDefault": 1,
        "NbrOfCameras": 1,
        "NbrOfSerPorts": 0,
        "CamPorts.Cam1Port": -1,
        "ImageSource.I0.PTZEnabled": "true",
        **{f"Limit.L1.{name}": value for name, value in limit_values(camera.device).items()},
        "PTZDriverStatuses.Driver1Status": 3,
        **{f"Support.S1.{name}": support[name] for name in sorted(support)},
        "UserAdv.U1.MoveSpeed": camera.speed,
        "Various.V1.CtlQueueing": str(queue.enabled).lower(),
        "Various.V1.CtlQueueLimit": queue.limit,
        "Various.V1.CtlQueuePollTime": queue.poll_s,
        "Various.V1.HomePresetSet": "true",
        "Various.V1.Locked": "false",
        "Various.V1.PanEnabled": "true",
        "Various.V1.ReturnToOverview": 0,
        "Various.V1.SpeedCtlEnabled": "true",
        "Various.V1.TiltEnabled": "true",
        "Various.V1.ZoomEnabled": "true",
    }
    for number, (role, priority) in enumerate(PRIORITIES.items()):
        group = {"Priority": priority, "TimeoutTime": round(CONTROL_TIMEOUT_S), "TimeoutType": "activity", "UseCookie": "no"}
        content |= {f"UserCtlQueue.U{number}.{name}": value for name, value in group.items()}
        content[f"UserCtlQueue.U{number}.UserGroup"] = role.name.capitalize()
    return {f"PTZ.{name}": str(value) for name, value in content.items()}


def _presets(camera: VapixCamera) -> dict[str, str]:
    device = camera.device
    home = next((preset.number for preset in device.presets() if preset.pose == device.home), -1)
    content = {"HomePosition": str(home), "ImageSource": "0", "Name": ""}
    for preset in device.presets():
        content[f"Position.P{preset.number}.Data"] = preset_data(preset, device.limits)
        content[f"Position.P{preset.number}.Name"] = preset.name
    return {f"PTZ.Preset.P0.{name}": value for name, value in content.items()}
