"""A program for an environment of its own with onvif-python: it asks a camera by Media2 and PTZ, and prints what it heard as JSON.

Both onvif-python and onvif-zeep-async are imported as ``onvif``, so one environment cannot hold both.
"""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any


def main(port: int) -> dict[str, Any]:
    """Ask the camera at a port of this machine. The password is in the environment variable CAMERA_PASSWORD."""
    from onvif import ONVIFClient, ONVIFDiscovery, ONVIFOperationException  # type: ignore[attr-defined, unused-ignore]

    password = os.environ["CAMERA_PASSWORD"]
    client = ONVIFClient("127.0.0.1", port, "admin", password)
    media, ptz = client.media2(), client.ptz()
    profile, small = media.GetProfiles(Type=["All"])
    encoder, source, configuration = (getattr(profile.Configurations, kind) for kind in ("VideoEncoder", "VideoSource", "PTZ"))
    (options,) = media.GetVideoEncoderConfigurationOptions(ConfigurationToken=encoder.token)
    found = {
        "services": sorted(service.Namespace for service in client.services),
        "capabilities": media.GetServiceCapabilities().ProfileCapabilities.ConfigurationsSupported,
        "encoding": encoder.Encoding,
        "size": [encoder.Resolution.Width, encoder.Resolution.Height],
        "rates": [float(rate) for rate in options.FrameRatesSupported],
        "bounds": [source.Bounds.width, source.Bounds.height],
        "small_stream": media.GetStreamUri(Protocol="RtspUnicast", ProfileToken=small.token),
        "stream": media.GetStreamUri(Protocol="RTSP", ProfileToken=profile.token),
        "snapshot": media.GetSnapshotUri(ProfileToken=profile.token),
        "instances": media.GetVideoEncoderInstances(ConfigurationToken=source.token).Total,
        "listed": [each.token for each in ptz.GetConfigurations()] == [configuration.token],
        "move_status": ptz.GetServiceCapabilities().MoveStatus,
        "presets": [preset.Name for preset in ptz.GetPresets(ProfileToken=profile.token)],
    }
    ptz.AbsoluteMove(ProfileToken=profile.token, Position={"PanTilt": {"x": 0.5, "y": 0.0}, "Zoom": {"x": 0.5}})
    while ptz.GetStatus(ProfileToken=profile.token).MoveStatus.PanTilt != "IDLE":
        time.sleep(0.01)
    ptz.RelativeMove(ProfileToken=profile.token, Translation={"PanTilt": {"x": -0.1, "y": 0.1}})
    ptz.ContinuousMove(ProfileToken=profile.token, Velocity={"PanTilt": {"x": 0.1, "y": 0.0}}, Timeout="PT1S")
    ptz.Stop(ProfileToken=profile.token, PanTilt=True, Zoom=True)
    position = ptz.GetStatus(ProfileToken=profile.token).Position
    found["zoom"] = position.Zoom.x
    try:
        ONVIFClient("127.0.0.1", port, "admin", "wrong").media2().GetProfiles()
    except ONVIFOperationException as error:
        found["refused"] = str(error)
    digest = ONVIFClient("127.0.0.1", port, "admin", password, http_digest=True)
    found["by_http_digest"] = len(digest.media2().GetProfiles())
    devices = ONVIFDiscovery(timeout=2, interface="127.0.0.1").discover()
    found["discovered"] = {device["port"]: device["epr"] for device in devices}
    return found


if __name__ == "__main__":
    print(json.dumps(main(int(sys.argv[1]))))  # noqa: T201
