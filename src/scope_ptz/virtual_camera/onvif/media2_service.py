"""The ONVIF media2 service, which provides the same profiles as the media service but uses media2 types."""

from __future__ import annotations

from typing import Any

from scope_ptz.virtual_camera.device import VirtualDevice
from scope_ptz.virtual_camera.onvif import media_profiles as profiles
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.ptz_configuration import PtzConfiguration
from scope_ptz.virtual_camera.onvif.soap import invalid_argument

_PROTOCOLS = {"RtspUnicast", "RTSP", "RtspOverHttp"}  # "RTSP" means interleaved over TCP


class Media2Service:
    """The ONVIF media2 service.

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
        count = len(profiles.media_profiles(self._device))
        return {
            "Capabilities": {
                "SnapshotUri": True,
                "Rotation": False,
                "VideoSourceMode": False,
                "OSD": False,
                "Mask": False,
                "ProfileCapabilities": {
                    "MaximumNumberOfProfiles": count, "ConfigurationsSupported": "VideoSource VideoEncoder PTZ",
                },
                "StreamingCapabilities": {
                    "RTSPStreaming": True, "RTPMulticast": False, "RTP_RTSP_TCP": True, "NonAggregateControl": False,
                },
            }
        }  # fmt: skip

    def _profiles(self, request: Request) -> Reply:
        selected = profiles.media_profiles(self._device)
        if request.Token:
            selected = (profiles.find_profile(self._device, request.Token),)
        requested = set(request.Type or ())
        return {"Profiles": [self._profile(profile, requested) for profile in selected]}

    def _profile(self, profile: profiles.MediaProfile, requested: set[str]) -> dict[str, Any]:
        sources = {
            "VideoSource": lambda: profiles.source_configuration(self._device),
            "VideoEncoder": lambda: _encoder(profile),
            "PTZ": self._ptz.values,
        }
        configurations = {kind: values() for kind, values in sources.items() if requested & {"All", kind}}
        result: dict[str, Any] = {"token": profile.token, "fixed": True, "Name": profile.name}
        if configurations:
            result["Configurations"] = configurations
        return result

    def _source_configurations(self, request: Request) -> Reply:
        self._check_source(request)
        return {"Configurations": [profiles.source_configuration(self._device)]}

    def _source_options(self, request: Request) -> Reply:
        self._check_source(request)
        return {"Options": profiles.source_options(self._device)}

    def _encoder_configurations(self, request: Request) -> Reply:
        return {"Configurations": [_encoder(profile) for profile in profiles.selected_encoders(self._device, request)]}

    def _encoder_options(self, request: Request) -> Reply:
        sizes = [profile.resolution for profile in profiles.selected_encoders(self._device, request)]
        rates = [profile.bitrate_kbps for profile in profiles.selected_encoders(self._device, request)]
        return {
            "Options": [
                {
                    "GovLengthRange": f"{profiles.GOP_FRAMES} {profiles.GOP_FRAMES}",
                    "FrameRatesSupported": str(profiles.FRAME_RATE),
                    "ProfilesSupported": "Baseline",
                    "Encoding": "H264",
                    "QualityRange": {"Min": profiles.QUALITY, "Max": profiles.QUALITY},
                    "ResolutionsAvailable": sizes,
                    "BitrateRange": {"Min": min(rates), "Max": max(rates)},
                }
            ]
        }

    def _instances(self, request: Request) -> Reply:
        profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        count = len(profiles.media_profiles(self._device))
        return {"Info": {"Codec": [{"Encoding": "H264", "Number": count}], "Total": count}}

    def _stream_uri(self, request: Request) -> Reply:
        profile = profiles.find_profile(self._device, request.ProfileToken)
        if request.Protocol not in _PROTOCOLS:
            raise invalid_argument("The stream is available only over unicast RTSP.", "InvalidStreamSetup")
        over_http = request.Protocol == "RtspOverHttp"
        return {"Uri": profiles.stream_uri(request, profile, self._rtsp_port, over_http=over_http)}

    def _snapshot_uri(self, request: Request) -> Reply:
        profile = profiles.find_profile(self._device, request.ProfileToken)
        return {"Uri": profiles.snapshot_uri(request, profile)}

    def _synchronise(self, request: Request) -> Reply:
        profiles.find_profile(self._device, request.ProfileToken)
        return {}

    def _check_source(self, request: Request) -> None:
        """Check that the video source configuration and the profile that a request names exist."""
        if request.ConfigurationToken:
            profiles.require_configuration(request.ConfigurationToken, profiles.SOURCE_CONFIGURATION)
        if request.ProfileToken:
            profiles.find_profile(self._device, request.ProfileToken)


def _encoder(profile: profiles.MediaProfile) -> dict[str, Any]:
    return {
        "token": profile.encoder_token,
        "Name": f"H.264 {profile.name}",
        "UseCount": 1,
        "GovLength": profiles.GOP_FRAMES,
        "Profile": "Baseline",
        "Encoding": "H264",
        "Resolution": profile.resolution,
        "RateControl": {"FrameRateLimit": profiles.FRAME_RATE, "BitrateLimit": profile.bitrate_kbps},
        "Multicast": profiles.MULTICAST,
        "Quality": profiles.QUALITY,
    }
