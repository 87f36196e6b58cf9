"""The Media service (version 1): one profile with an H.264 stream."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif import media_profiles as profiles
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.soap import invalid_argument


class MediaService:
    """The Media service.

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
            "GetProfiles": Operation(lambda _: {"Profiles": [self._profile()]}),
            "GetProfile": Operation(self._get_profile),
            "GetVideoSources": Operation(self._sources),
            "GetVideoSourceConfigurations": Operation(lambda _: {"Configurations": [profiles.source_configuration(self._device)]}),
            "GetVideoSourceConfiguration": Operation(self._source_configuration),
            "GetVideoSourceConfigurationOptions": Operation(lambda _: {"Options": profiles.source_options(self._device)}),
            "GetCompatibleVideoSourceConfigurations": Operation(self._compatible_sources),
            "GetVideoEncoderConfigurations": Operation(lambda _: {"Configurations": [self._encoder()]}),
            "GetVideoEncoderConfiguration": Operation(self._encoder_configuration),
            "GetVideoEncoderConfigurationOptions": Operation(self._encoder_options),
            "GetCompatibleVideoEncoderConfigurations": Operation(self._compatible_encoders),
            "GetGuaranteedNumberOfVideoEncoderInstances": Operation(self._instances),
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
                "ProfileCapabilities": {"MaximumNumberOfProfiles": 1},
                "StreamingCapabilities": {
                    "RTPMulticast": False,
                    "RTP_TCP": True,
                    "RTP_RTSP_TCP": True,
                    "NonAggregateControl": False,
                },
            }
        }

    def _profile(self) -> dict[str, Any]:
        return {
            "token": profiles.PROFILE,
            "fixed": True,
            "Name": "H.264",
            "VideoSourceConfiguration": profiles.source_configuration(self._device),
            "VideoEncoderConfiguration": self._encoder(),
            "PTZConfiguration": self._ptz.values(),
        }

    def _get_profile(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {"Profile": self._profile()}

    def _sources(self, _: Request) -> Reply:
        size = {"Width": self._device.width, "Height": self._device.height}
        return {"VideoSources": [{"token": profiles.SOURCE, "Framerate": profiles.FRAME_RATE, "Resolution": size}]}

    def _source_configuration(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        return {"Configuration": profiles.source_configuration(self._device)}

    def _compatible_sources(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {"Configurations": [profiles.source_configuration(self._device)]}

    def _encoder(self) -> dict[str, Any]:
        return {
            "token": profiles.ENCODER_CONFIGURATION,
            "Name": "H.264",
            "UseCount": 1,
            "Encoding": "H264",
            "Resolution": {"Width": self._device.width, "Height": self._device.height},
            "Quality": 70.0,
            "RateControl": {"FrameRateLimit": profiles.FRAME_RATE, "EncodingInterval": 1, "BitrateLimit": profiles.BITRATE_KBPS},
            "H264": {"GovLength": profiles.GOP_FRAMES, "H264Profile": "Baseline"},
            "Multicast": profiles.MULTICAST,
            "SessionTimeout": timedelta(seconds=60),
        }

    def _encoder_configuration(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.ENCODER_CONFIGURATION)
        return {"Configuration": self._encoder()}

    def _encoder_options(self, request: Request) -> Reply:
        if request.ConfigurationToken:
            profiles.require_configuration(request.ConfigurationToken, profiles.ENCODER_CONFIGURATION)
        if request.ProfileToken:
            profiles.require_profile(request.ProfileToken)
        rate, gop = profiles.FRAME_RATE, profiles.GOP_FRAMES
        h264 = {
            "ResolutionsAvailable": [{"Width": self._device.width, "Height": self._device.height}],
            "GovLengthRange": {"Min": gop, "Max": gop},
            "FrameRateRange": {"Min": rate, "Max": rate},
            "EncodingIntervalRange": {"Min": 1, "Max": 1},
            "H264ProfilesSupported": ["Baseline"],
        }
        return {"Options": {"QualityRange": {"Min": 70, "Max": 70}, "H264": h264}}

    def _compatible_encoders(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {"Configurations": [self._encoder()]}

    def _instances(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        return {"TotalNumber": 1, "H264": 1}

    def _stream_uri(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        setup = request.StreamSetup
        if getattr(setup, "Stream", None) == "RTP-Multicast":
            raise invalid_argument("There is no multicast stream.", "InvalidStreamSetup")
        return {"MediaUri": _media_uri(profiles.stream_uri(request, self._rtsp_port))}

    def _snapshot_uri(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {"MediaUri": _media_uri(profiles.snapshot_uri(request, self._device))}

    def _synchronise(self, request: Request) -> Reply:
        profiles.require_profile(request.ProfileToken)
        return {}


def _media_uri(uri: str) -> dict[str, Any]:
    return {"Uri": uri, "InvalidAfterConnect": False, "InvalidAfterReboot": False, "Timeout": timedelta(0)}
