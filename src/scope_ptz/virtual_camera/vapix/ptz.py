"""Handle ``/axis-cgi/com/ptz.cgi``, ``ptzconfig.cgi`` and ``ptzqueue.cgi``: moves, presets and the control queue."""

from __future__ import annotations

from scope_ptz.errors import CameraError, InputError
from scope_ptz.virtual_camera.identity import PRODUCT
from scope_ptz.virtual_camera.vapix import lens, moves, replies
from scope_ptz.virtual_camera.vapix.arguments import MAX_SHOWN_CHARS, Arguments, check_camera
from scope_ptz.virtual_camera.vapix.control_queue import QueueStatus
from scope_ptz.virtual_camera.vapix.queries import QUERIES, query
from scope_ptz.virtual_camera.vapix.replies import DONE, Client, Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

UNSUPPORTED = (
    "continuousirismove", "brightness", "rbrightness", "continuousbrightnessmove", "ircutfilter", "backlight", "auxiliary",
)  # fmt: skip
"""Commands that other AXIS cameras support but this one rejects."""

FORBIDDEN_IN_NAMES = '"<>~:'
"""Characters that AXIS cameras do not allow in preset names."""

# The reply to ``info=1``.
COMMANDS = f"""Available commands:
{{camera=[n]}}
whoami=yes
center=[x],[y]
  imagewidth=[n]
  imageheight=[n]
areazoom=[x],[y],[z]
  imagewidth=[n]
  imageheight=[n]
move={{ {" | ".join(moves.WORDS)} }}
pan=[abspos]
tilt=[abspos]
zoom=[n]
rpan=[offset]
rtilt=[offset]
rzoom=[offset]
focus=[n]
rfocus=[offset]
autofocus={{ on | off }}
continuousfocusmove=[speed]
iris=[n]
riris=[offset]
autoiris={{ on | off }}
continuouspantiltmove=[x-speed],[y-speed]
continuouszoommove=[speed]
setserverpresetname=[name]
setserverpresetno=[n]
removeserverpresetname=[name]
removeserverpresetno=[n]
gotoserverpresetname=[name]
gotoserverpresetno=[n]
gotodevicepreset=[n]
speed=[n]
query={{ {" | ".join(QUERIES)} }}
  format={{ json }}
"""


def ptz(camera: VapixCamera, arguments: Arguments, client: Client) -> Reply:
    """Handle a request to ``ptz.cgi``, which contains either a query or commands."""
    try:
        check_camera(arguments)
        if "query" in arguments:
            return query(camera, arguments)
        if "info" in arguments:
            return Reply(200, COMMANDS)
        if "whoami" in arguments:
            return replies.lines([f"AXIS {PRODUCT}"])
        return _command(camera, arguments, client)
    except (InputError, CameraError) as problem:
        return replies.error(str(problem))


def _command(camera: VapixCamera, arguments: Arguments, client: Client) -> Reply:
    for name in arguments:
        if name in UNSUPPORTED:
            raise InputError(f"{name}: not supported by this camera")
    moving = any(name in arguments for name in moves.COMMANDS)
    known = moving or any(name in arguments for name in ("speed", *lens.COMMANDS))
    if not known:
        raise InputError("no command; info=1 lists the commands")
    camera.queue.check(client)
    if "speed" in arguments:
        camera.speed = arguments.integer("speed", 1, 100)
    lens.adjust(camera.device.lens, arguments)
    if moving:
        moves.move(camera, arguments)
    return DONE


def ptz_config(camera: VapixCamera, arguments: Arguments) -> Reply:
    """Handle a request to ``ptzconfig.cgi``, which saves, renames and removes presets, and sets the home position."""
    try:
        check_camera(arguments)
        _configure(camera, arguments)
    except (InputError, CameraError) as problem:
        return replies.error(str(problem))
    return DONE


def _configure(camera: VapixCamera, arguments: Arguments) -> None:
    device = camera.device
    home = "home" in arguments and arguments.choice("home", ("yes", "no")) == "yes"
    if "setserverpresetname" in arguments:
        device.save_preset(_preset_name(arguments, "setserverpresetname"))
    elif "setserverpresetno" in arguments:
        number = arguments.integer("setserverpresetno", 0, 10_000)
        known = {preset.number: preset.name for preset in device.presets()}
        device.save_preset(known.get(number, f"p{number}"), number=number)
    elif "renameserverpresetno" in arguments:
        device.rename_preset(arguments.integer("renameserverpresetno", 0, 10_000), _preset_name(arguments, "newname"))
    elif "removeserverpresetname" in arguments:
        device.remove_preset(device.find_preset(arguments.text("removeserverpresetname")[:MAX_SHOWN_CHARS]).number)
    elif "removeserverpresetno" in arguments:
        device.remove_preset(arguments.integer("removeserverpresetno", 0, 10_000))
    elif "removeallserverpresets" in arguments and arguments.choice("removeallserverpresets", ("yes",)):
        for preset in device.presets():
            device.remove_preset(preset.number)
    elif not home:
        raise InputError("no command; use setserverpresetname, removeserverpresetname, home or another preset command")
    if home:
        device.set_home()


def ptz_queue(camera: VapixCamera, arguments: Arguments, client: Client) -> Reply:
    """Handle a request to ``ptzqueue.cgi``. The reply contains the three values of ``QueueStatus``."""
    try:
        status = _queue_status(camera, arguments, client)
    except (InputError, CameraError) as problem:
        return replies.error(str(problem))
    fields = (status.position, status.seconds, status.poll_s)
    return Reply(200, "".join(f'<a name="{value}"></a>' for value in fields) + "\n", "text/html; charset=utf-8")


def _queue_status(camera: VapixCamera, arguments: Arguments, client: Client) -> QueueStatus:
    check_camera(arguments)
    if "control" not in arguments:
        raise InputError("control: expected request, drop or query")
    if not camera.queue.enabled:
        raise CameraError("control queueing is off (PTZ.Various.V1.CtlQueueing)")
    actions = {"request": camera.queue.request, "drop": camera.queue.drop, "query": camera.queue.status}
    return actions[arguments.choice("control", tuple(actions))](client)


def _preset_name(arguments: Arguments, argument: str) -> str:
    name = arguments.text(argument)
    if any(character in FORBIDDEN_IN_NAMES for character in name):
        raise InputError(f"{argument}: a preset name cannot contain any of {' '.join(FORBIDDEN_IN_NAMES)}")
    return name
