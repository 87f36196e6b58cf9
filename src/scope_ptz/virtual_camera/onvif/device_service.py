"""The ONVIF device service: the list of services, the time, and information about the device."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any
from urllib.parse import quote, urlsplit

from scope_ptz.virtual_camera.accounts import Role
from scope_ptz.virtual_camera.device import REBOOT_DELAY_S, REBOOT_S, VirtualDevice
from scope_ptz.virtual_camera.identity import BRAND, FIRMWARE, PRODUCT, device_uuid, hostname, mac_address, serial_number
from scope_ptz.virtual_camera.onvif.clock import device_datetime
from scope_ptz.virtual_camera.onvif.operations import Operation, Operations, Reply, Request
from scope_ptz.virtual_camera.onvif.soap import SoapFault, invalid_argument
from scope_ptz.virtual_camera.onvif.wsdl import DEVICE, IMAGING, MEDIA, MEDIA2, PTZ

PATHS = {
    DEVICE: "/onvif/device_service",
    MEDIA: "/onvif/media_service",
    MEDIA2: "/onvif/media2_service",
    PTZ: "/onvif/ptz_service",
    IMAGING: "/onvif/imaging_service",
}
"""The path of each service, by namespace."""

VERSION = {"Major": 19, "Minor": 12}
"""The version of the ONVIF specifications that the services implement."""

# Categories in ``GetCapabilities``: those that this device implements, with their namespaces, and those that it does not.
_CATEGORIES = {"Device": DEVICE, "Media": MEDIA, "PTZ": PTZ, "Imaging": IMAGING}
_MISSING_SERVICES = {"Analytics", "Events"}


def scopes(device: VirtualDevice) -> list[str]:
    """Return the WS-Discovery scopes, by which clients select devices."""
    items = ("type/ptz", "type/video_encoder", "type/Network_Video_Transmitter", "Profile/Streaming")
    named = (f"hardware/{quote(PRODUCT)}", f"name/{quote(device.name)}", f"location/{quote(device.scene.name)}")
    return [f"onvif://www.onvif.org/{item}" for item in (*items, *named)]


class DeviceService:
    """The ONVIF device service.

    Args:
        device: The camera.
        capabilities: A function that returns the capabilities of the service with a namespace, as an XML element.
        rtsp_port: Port of its RTSP server.
    """

    def __init__(self, device: VirtualDevice, capabilities: Callable[[str], Any], rtsp_port: int) -> None:
        self._device, self._capabilities_of, self._rtsp_port = device, capabilities, rtsp_port

    def operations(self) -> Operations:
        """Return the operations by name. Those that a client needs before it can authenticate require no authentication."""
        return {
            "GetServices": Operation(self._services, None),
            "GetServiceCapabilities": Operation(self._service_capabilities, None),
            "GetCapabilities": Operation(self._capabilities, None),
            "GetSystemDateAndTime": Operation(self._time, None),
            "GetHostname": Operation(self._hostname, None),
            "GetWsdlUrl": Operation(lambda _: {"WsdlUrl": "https://www.onvif.org/profiles/specifications/"}, None),
            "GetEndpointReference": Operation(self._endpoint, None),
            "GetDeviceInformation": Operation(self._information),
            "GetScopes": Operation(self._scopes),
            "GetDiscoveryMode": Operation(lambda _: {"DiscoveryMode": "Discoverable"}),
            "GetNetworkInterfaces": Operation(self._network_interfaces),
            "GetNetworkProtocols": Operation(self._network_protocols),
            "GetNetworkDefaultGateway": Operation(lambda _: {"NetworkGateway": {}}),
            "GetDNS": Operation(lambda _: {"DNSInformation": {"FromDHCP": False}}),
            "GetNTP": Operation(lambda _: {"NTPInformation": {"FromDHCP": False}}),
            "GetUsers": Operation(self._users, Role.ADMINISTRATOR),
            "SystemReboot": Operation(self._reboot, Role.ADMINISTRATOR),
        }

    def _services(self, request: Request) -> Reply:
        services = []
        for namespace, path in PATHS.items():
            service = {"Namespace": namespace, "XAddr": request.origin + path, "Version": VERSION}
            if request.IncludeCapability:
                service["Capabilities"] = {"_value_1": self._capabilities_of(namespace)}
            services.append(service)
        return {"Service": services}

    def _service_capabilities(self, _: Request) -> Reply:
        security = {"UsernameToken": True, "HttpDigest": True, "TLS1.2": False, "RELToken": False, "MaxUsers": 0}
        system = {"DiscoveryResolve": True, "DiscoveryBye": True, "RemoteDiscovery": False, "SystemLogging": False}
        network = {"IPFilter": False, "ZeroConfiguration": False, "IPVersion6": False, "DynDNS": False, "NTP": 0}
        return {"Capabilities": {"Network": network, "Security": security, "System": system}}

    def _capabilities(self, request: Request) -> Reply:
        requested = set(request.Category or ()) or {"All"}
        if missing := requested & _MISSING_SERVICES:
            raise SoapFault(f"The device has no {min(missing)} service.", "ActionNotSupported", "NoSuchService", receiver=True)
        capabilities: dict[str, Any] = {}
        for category, namespace in _CATEGORIES.items():
            if requested & {"All", category}:
                capabilities[category] = {"XAddr": request.origin + PATHS[namespace]}
        if "Media" in capabilities:
            capabilities["Media"]["StreamingCapabilities"] = {"RTPMulticast": False, "RTP_TCP": True, "RTP_RTSP_TCP": True}
        if "Device" in capabilities:
            capabilities["Device"] |= _DEVICE_DETAILS
        return {"Capabilities": capabilities}

    def _time(self, _: Request) -> Reply:
        now = device_datetime(self._device)
        parts = {
            "Time": {"Hour": now.hour, "Minute": now.minute, "Second": now.second},
            "Date": {"Year": now.year, "Month": now.month, "Day": now.day},
        }
        zone = {"TZ": "UTC0"}
        return {
            "SystemDateAndTime": {
                "DateTimeType": "Manual", "DaylightSavings": False, "TimeZone": zone, "UTCDateTime": parts, "LocalDateTime": parts,
            }
        }  # fmt: skip

    def _hostname(self, _: Request) -> Reply:
        return {"HostnameInformation": {"FromDHCP": False, "Name": hostname(self._device)}}

    def _endpoint(self, _: Request) -> Reply:
        return {"GUID": str(device_uuid(self._device))}

    def _information(self, _: Request) -> Reply:
        return {
            "Manufacturer": BRAND,
            "Model": PRODUCT,
            "FirmwareVersion": FIRMWARE,
            "SerialNumber": serial_number(self._device),
            "HardwareId": "virtual",
        }

    def _scopes(self, _: Request) -> Reply:
        return {"Scopes": [{"ScopeDef": "Fixed", "ScopeItem": item} for item in scopes(self._device)]}

    def _network_interfaces(self, request: Request) -> Reply:
        interface: dict[str, Any] = {
            "token": "eth0",
            "Enabled": True,
            "Info": {"Name": "eth0", "HwAddress": mac_address(self._device), "MTU": 1500},
        }
        if request.host.replace(".", "").isdigit():
            address = {"Address": request.host, "PrefixLength": 8 if request.host.startswith("127.") else 24}
            interface["IPv4"] = {"Enabled": True, "Config": {"Manual": [address], "DHCP": False}}
        return {"NetworkInterfaces": [interface]}

    def _network_protocols(self, request: Request) -> Reply:
        address = urlsplit(request.origin)
        ports = {address.scheme.upper(): address.port or 80, "RTSP": self._rtsp_port}
        return {"NetworkProtocols": [{"Name": name, "Enabled": True, "Port": [port]} for name, port in ports.items()]}

    def _reboot(self, _: Request) -> Reply:
        self._device.reboot(REBOOT_S, after_s=REBOOT_DELAY_S)
        return {"Message": f"The device will be back in about {REBOOT_S:g} seconds."}

    def _users(self, _: Request) -> Reply:
        levels = {Role.VIEWER: "User", Role.OPERATOR: "Operator", Role.ADMINISTRATOR: "Administrator"}
        return {"User": [{"Username": account.name, "UserLevel": levels[account.role]} for account in self._device.accounts]}


_DEVICE_DETAILS: Mapping[str, Any] = {
    "Network": {"IPFilter": False, "ZeroConfiguration": False, "IPVersion6": False, "DynDNS": False},
    "System": {
        "DiscoveryResolve": True, "DiscoveryBye": True, "RemoteDiscovery": False, "SystemBackup": False, "SystemLogging": False,
        "FirmwareUpgrade": False, "SupportedVersions": [VERSION],
    },
    "Security": {
        "TLS1.1": False, "TLS1.2": False, "OnboardKeyGeneration": False, "AccessPolicyConfig": False, "X.509Token": False,
        "SAMLToken": False, "KerberosToken": False, "RELToken": False,
    },
}  # fmt: skip


def require_token(name: str, token: str | None, known: str, subcode: str) -> None:
    """Check that a token equals the only valid one.

    Args:
        name: The type of object that the token identifies, used in the message.
        token: The token in the request.
        known: The valid token.
        subcode: The ONVIF subcode of the fault.

    Raises:
        SoapFault: The tokens differ.
    """
    if token != known:
        raise invalid_argument(f"There is no {name} '{str(token)[:64]}'.", subcode)
