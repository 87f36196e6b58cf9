"""The JSON interfaces in VAPIX: ``apidiscovery.cgi`` and ``basicdeviceinfo.cgi``."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from scope_ptz.virtual_camera.vapix import replies
from scope_ptz.virtual_camera.vapix.identity import identity
from scope_ptz.virtual_camera.vapix.replies import Reply
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera

DISCOVERY_VERSION, DEVICE_INFO_VERSION = "1.0", "1.3"

APIS = (
    ("api-discovery", "API Discovery Service", DISCOVERY_VERSION),
    ("basic-device-info", "Basic Device Information", DEVICE_INFO_VERSION),
    ("param-cgi", "Legacy Parameter Handling", "1.0"),
    ("ptz-control", "PTZ Control", "1.0"),
)

# Error codes in replies.
INVALID_VALUE, ONLY_POST, WRONG_VERSION, UNKNOWN_METHOD, INVALID_JSON, MISSING = 1000, 2002, 2003, 2004, 4000, 4002


def api_discovery(camera: VapixCamera, method: str, body: bytes) -> Reply:  # noqa: ARG001 - the signature of all JSON interfaces
    """Handle a request to ``apidiscovery.cgi``."""
    apis = [{"id": key, "version": version, "name": name, "docLink": "", "status": "official"} for key, name, version in APIS]

    def api_list(_: dict[str, Any]) -> dict[str, Any]:
        return {"apiList": apis}

    return _answer(method, body, DISCOVERY_VERSION, {"getApiList": api_list})


def basic_device_info(camera: VapixCamera, method: str, body: bytes) -> Reply:
    """Handle a request to ``basicdeviceinfo.cgi``."""
    properties = identity(camera)

    def selected_properties(request: dict[str, Any]) -> dict[str, Any]:
        names = request.get("params", {}).get("propertyList") if isinstance(request.get("params"), dict) else None
        if not isinstance(names, list):
            raise _RequestError(MISSING, "Required parameter missing or invalid")
        if not all(isinstance(name, str) and name in properties for name in names):
            raise _RequestError(INVALID_VALUE, "Invalid parameter value specified")
        return {"propertyList": {name: properties[name] for name in names}}

    def all_properties(_: dict[str, Any]) -> dict[str, Any]:
        return {"propertyList": properties}

    methods = {
        "getAllProperties": all_properties,
        "getAllUnrestrictedProperties": all_properties,
        "getProperties": selected_properties,
    }
    return _answer(method, body, DEVICE_INFO_VERSION, methods)


class _RequestError(Exception):
    """Raised to reject a request with an error code and a message."""


def _answer(http_method: str, body: bytes, version: str, methods: dict[str, Callable[[dict[str, Any]], dict[str, Any]]]) -> Reply:
    if http_method != "POST":
        return _refusal({}, ONLY_POST, "HTTP request type not supported. Only POST is supported", version)
    try:
        request = json.loads(body)
    except (ValueError, RecursionError):
        request = None
    if not isinstance(request, dict):
        return _refusal({}, INVALID_JSON, "Invalid JSON", version)
    name, requested_version = request.get("method"), request.get("apiVersion", version)
    head = {key: request[key] for key in ("context",) if isinstance(request.get(key), str)}
    if not isinstance(name, str):
        return _refusal(head, MISSING, "Required parameter missing or invalid", version)
    head["method"] = name[:100]
    if name == "getSupportedVersions":
        return replies.document({"apiVersion": version, **head, "data": {"apiVersions": [version]}})
    if not isinstance(requested_version, str) or requested_version.split(".")[0] != version.split(".")[0]:
        return _refusal(head, WRONG_VERSION, "Requested API version is not supported", version)
    if name not in methods:
        return _refusal(head, UNKNOWN_METHOD, "Method not supported", version)
    try:
        return replies.document({"apiVersion": version, **head, "data": methods[name](request)})
    except _RequestError as problem:
        code, message = problem.args
        return _refusal(head, code, message, version)


def _refusal(head: dict[str, Any], code: int, message: str, version: str) -> Reply:
    return replies.document({"apiVersion": version, **head, "error": {"code": code, "message": message}})
