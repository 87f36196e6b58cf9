"""The ONVIF media service (version 1): profiles, each with an H.264 stream."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif import media_profiles as profiles
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.soap import invalid_argument


class MediaService:
    """The ONVIF media service.

    Args:
        device: The camera.
        ptz: Its PTZ configuration.
        rtsp_port: Port of its RTSP server.
    """

    def __init__(self, device: VirtualDevice, ptz: PtzConfiguration, rtsp_port: int) -> None:
        self._device, self._ptz, self._rtsp_port = device, ptz, rtsp_port

    def operations(self) -> Operations:
        """Return the operations by name."""
        return {
            "GetServiceCapabilities": Operation(self._capabilities, None),
            "GetProfiles": Operation(
                lambda _: {"Profiles": [self._profile(profile) for profile in profiles.media_profiles(self._device)]}
            ),
            "GetProfile": Operation(self._get_profile),
            "GetVideoSources": Operation(self._sources),
            "GetVideoSourceConfigurations": Operation(lambda _: {"Configurations": [profiles.source_configuration(self._device)]}),
            "GetVideoSourceConfiguration": Operation(self._source_configuration),
            "GetVideoSourceConfigurationOptions": Operation(lambda _: {"Options": profiles.source_options(self._device)}),
            "GetCompatibleVideoSourceConfigurations": Operation(self._compatible_sources),
            "GetVideoEncoderConfigurations": Operation(lambda _: {"Configurations": self._encoders()}),
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
                "ProfileCapabilities": {"MaximumNumberOfProfiles": len(profiles.media_profiles(self._device))},
                "StreamingCapabilities": {
                    "RTPMulticast": False,
                    "RTP_TCP": True,
                    "RTP_RTSP_TCP": True,
                    "NonAggregateControl": False,
                },
            }
        }

    def _profile(self, profile: profiles.MediaProfile) -> dict[str, Any]:
        return {
            "token": profile.token,
            "fixed": True,
            "Name": profile.name,
            "VideoSourceConfiguration": profiles.source_configuration(self._device),
            "VideoEncoderConfiguration": _encoder(profile),
            "PTZConfiguration": self._ptz.values(),
        }

    def _get_profile(self, request: Request) -> Reply:
        return {"Profile": self._profile(profiles.find_profile(self._device, request.ProfileToken))}

    def _sources(self, _: Request) -> Reply:
        size = {"Width": self._device.width, "Height": self._device.height}
        return {"VideoSources": [{"token": profiles.SOURCE, "Framerate": profiles.FRAME_RATE, "Resolution": size}]}

    def _source_configuration(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        return {"Configuration": profiles.source_configuration(self._device)}

    def _compatible_sources(self, request: Request) -> Reply:
        profiles.find_profile(self._device, request.ProfileToken)
        return {"Configurations": [profiles.source_configuration(self._device)]}

    def _encoders(self) -> list[dict[str, Any]]:
        return [_encoder(profile) for profile in profiles.media_profiles(self._device)]

    def _encoder_configuration(self, request: Request) -> Reply:
        return {"Configuration": _encoder(profiles.find_encoder(self._device, request.ConfigurationToken))}

    def _encoder_options(self, request: Request) -> Reply:
        rate, gop = profiles.FRAME_RATE, profiles.GOP_FRAMES
        h264 = {
            "ResolutionsAvailable": [profile.resolution for profile in profiles.selected_encoders(self._device, request)],
            "GovLengthRange": {"Min": gop, "Max": gop},
            "FrameRateRange": {"Min": rate, "Max": rate},
            "EncodingIntervalRange": {"Min": 1, "Max": 1},
            "H264ProfilesSupported": ["Baseline"],
        }
        quality = round(profiles.QUALITY)
        return {"Options": {"QualityRange": {"Min": quality, "Max": quality}, "H264": h264}}

    def _compatible_encoders(self, request: Request) -> Reply:
        profiles.find_profile(self._device, request.ProfileToken)
        return {"Configurations": self._encoders()}

    def _instances(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        count = len(profiles.media_profiles(self._device))
        return {"TotalNumber": count, "H264": count}

    def _stream_uri(self, request: Request) -> Reply:
        profile = profiles.find_profile(self._device, request.ProfileToken)
        setup = request.StreamSetup
        if getattr(setup, "Stream", None) == "RTP-Multicast":
            raise invalid_argument("There is no multicast stream.", "InvalidStreamSetup")
        over_http = getattr(getattr(setup, "Transport", None), "Protocol", None) == "HTTP"
        return {"MediaUri": _media_uri(profiles.stream_uri(request, profile, self._rtsp_port, over_http=over_http))}

    def _snapshot_uri(self, request: Request) -> Reply:
        profile = profiles.find_profile(self._device, request.ProfileToken)
        return {"MediaUri": _media_uri(profiles.snapshot_uri(request, profile))}

    def _synchronise(self, request: Request) -> Reply:
        profiles.find_profile(self._device, request.ProfileToken)
        return {}


def _encoder(profile: profiles.MediaProfile) -> dict[str, Any]:
    return {
        "token": profile.encoder_token,
        "Name": f"H.264 {profile.name}",
        "UseCount": 1,
        "Encoding": "H264",
        "Resolution": profile.resolution,
        "Quality": profiles.QUALITY,
        "RateControl": {"FrameRateLimit": profiles.FRAME_RATE, "EncodingInterval": 1, "BitrateLimit": profile.bitrate_kbps},
        "H264": {"GovLength": profiles.GOP_FRAMES, "H264Profile": "Baseline"},
        "Multicast": profiles.MULTICAST,
        "SessionTimeout": timedelta(seconds=60),
    }


def _media_uri(uri: str) -> dict[str, Any]:
    return {"Uri": uri, "InvalidAfterConnect": False, "InvalidAfterReboot": False, "Timeout": timedelta(0)}
