"""The Media2 service: the same profile in the types of Media2."""

from __future__ import annotations

from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif import media_profiles as profiles
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.soap import invalid_argument

_PROTOCOLS = {"RtspUnicast", "RTSP"}  # RTSP: interleaved over TCP


class Media2Service:
    """The Media2 service.

    Args:
        device: The camera.
        ptz: Its PTZ configuration.
        rtsp_port: Where its streams are.
    """

    def __init__(self, device: VirtualDevice, ptz: PtzConfiguration, rtsp_port: int) -> None:
        self._device, self._ptz, self._rtsp_port = device, ptz, rtsp_port

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetServiceCapabilities": Operation(self._capabilities, None),
            "GetProfiles": Operation(self._profiles),
            "GetVideoSourceConfigurations": Operation(self._source_configurations),
            "GetVideoSourceConfigurationOptions": Operation(self._source_options),
            "GetVideoEncoderConfigurations": Operation(self._encoder_configurations),
            "GetVideoEncoderConfigurationOptions": Operation(self._encoder_options),
            "GetVideoEncoderInstances": Operation(self._instances),
            "GetStreamUri": Operation(self._stream_uri),
            "GetSnapshotUri": Operation(self._snapshot_uri),
            "SetSynchronizationPoint": Operation(self._synchronise),
        }

    def _capabilities(self, _: Request) -> Reply:
        return {
            "Capabilities": {
                "SnapshotUri": True,
                "Rotation": False,
                "VideoSourceMode": False,
                "OSD": False,
                "Mask": False,
                "ProfileCapabilities": {"MaximumNumberOfProfiles": 1, "ConfigurationsSupported": "VideoSource VideoEncoder PTZ"},
                "StreamingCapabilities": {
                    "RTSPStreaming": True, "RTPMulticast": False, "RTP_RTSP_TCP": True, "NonAggregateControl": False,
                },
            }
        }  # fmt: skip

    def _profiles(self, request: Request) -> Reply:
        if request.Token:
            profiles.require_profile(request.Token)
        kinds = {
            "VideoSource": lambda: profiles.source_configuration(self._device),
            "VideoEncoder": self._encoder,
            "PTZ": self._ptz.values,
        }
        wanted = set(request.Type or ())
        configurations = {kind: values() for kind, values in kinds.items() if wanted & {"All", kind}}
        profile: dict[str, Any] = {"token": profiles.PROFILE, "fixed": True, "Name": "H.264"}
        if configurations:
            profile["Configurations"] = configurations
        return {"Profiles": [profile]}

    def _source_configurations(self, request: Request) -> Reply:
        _check(request, profiles.SOURCE_CONFIGURATION)
        return {"Configurations": [profiles.source_configuration(self._device)]}

    def _source_options(self, request: Request) -> Reply:
        _check(request, profiles.SOURCE_CONFIGURATION)
        return {"Options": profiles.source_options(self._device)}

    def _encoder(self) -> dict[str, Any]:
        return {
            "token": profiles.ENCODER_CONFIGURATION,
            "Name": "H.264",
            "UseCount": 1,
            "GovLength": profiles.GOP_FRAMES,
            "Profile": "Baseline",
            "Encoding": "H264",
            "Resolution": {"Width": self._device.width, "Height": self._device.height},
            "RateControl": {"FrameRateLimit": profiles.FRAME_RATE, "BitrateLimit": profiles.BITRATE_KBPS},
            "Multicast": profiles.MULTICAST,
            "Quality": 70.0,
        }

    def _encoder_configurations(self, request: Request) -> Reply:
        _check(request, profiles.ENCODER_CONFIGURATION)
        return {"Configurations": [self._encoder()]}

    def _encoder_options(self, request: Request) -> Reply:
        _check(request, profiles.ENCODER_CONFIGURATION)
        return {
            "Options": [
                {
                    "GovLengthRange": f"{profiles.GOP_FRAMES} {profiles.GOP_FRAMES}",
                    "FrameRatesSupported": str(profiles.FRAME_RATE),
                    "ProfilesSupported": "Baseline",
                    "Encoding": "H264",
                    "QualityRange": {"Min": 70.0, "Max": 70.0},
                    "ResolutionsAvailable": [{"Width": self._device.width, "Height": self._device.height}],
                    "BitrateRange": {"Min": profiles.BITRATE_KBPS, "Max": profiles.BITRATE_KBPS},
                }
            ]
        }

    def _instances(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        return {"Info": {"Codec": [{"Encoding": "H264", "Number": 1}], "Total": 1}}

    def _stream_uri(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        if request.Protocol not in _PROTOCOLS:
            raise invalid_argument("The stream is offered over RTSP, by unicast.", "InvalidStreamSetup")
        return {"Uri": profiles.stream_uri(request, self._rtsp_port)}

    def _snapshot_uri(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {"Uri": profiles.snapshot_uri(request, self._device)}

    def _synchronise(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {}


def _check(request: Request, configuration: str) -> None:
    """Raise a fault if a request names another configuration or profile."""
    if request.ConfigurationToken:
        profiles.require_configuration(request.ConfigurationToken, configuration)
    if request.ProfileToken:
        profiles.require_profile(request.ProfileToken)
