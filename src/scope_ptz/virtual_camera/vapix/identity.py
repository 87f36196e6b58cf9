"""The camera's identity in VAPIX."""

from __future__ import annotations

from scope_ptz.virtual_camera.identity import BRAND, FIRMWARE, PRODUCT
from scope_ptz.virtual_camera.vapix.vapix_camera import VapixCamera


def identity(camera: VapixCamera) -> dict[str, str]:
    """Return the brand, product, versions and serial number by VAPIX name."""
    return {
        "Architecture": "aarch64",
        "Brand": BRAND,
        "BuildDate": "Jan 01 2026 00:00",
        "HardwareID": "virtual",
        "ProdFullName": f"{BRAND} {PRODUCT} PTZ Camera",
        "ProdNbr": PRODUCT,
        "ProdShortName": f"{BRAND} {PRODUCT}",
        "ProdType": "PTZ Camera",
        "ProdVariant": "SCOPE virtual camera",
        "SerialNumber": camera.serial,
        "Soc": "virtual",
        "SocSerialNumber": "",
        "Version": FIRMWARE,
        "WebURL": "http://www.axis.com",
    }
