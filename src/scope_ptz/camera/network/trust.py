"""Trust in one certificate that a device signed itself, by its fingerprint."""

from __future__ import annotations

import hashlib
import hmac
import ssl

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.errors import CameraUnreachableError
from scope_ptz.errors import CameraError


class CertificateError(CameraError):
    """The device's certificate is not the one that the site trusts."""


def trust_fingerprint(address: DeviceAddress, fingerprint: str, *, timeout_s: float = 5.0) -> ssl.SSLContext:
    """Return a TLS context that accepts only the certificate with a fingerprint. It blocks for one connection.

    The certificate is fetched, compared, and then becomes the only one that the context trusts. Another certificate in a later
    connection is therefore refused by the TLS handshake, before any credentials are sent.

    Args:
        address: The device.
        fingerprint: SHA-256 of the certificate in hexadecimal, with or without colons.
        timeout_s: Time limit of the connection.

    Raises:
        CertificateError: The device shows another certificate.
        CameraUnreachableError: The device does not answer, or speaks no TLS.
    """
    try:
        shown = ssl.get_server_certificate((address.host.strip("[]"), address.port), timeout=timeout_s)
    except (OSError, ValueError) as error:
        raise CameraUnreachableError(
            f"The camera at {address} shows no certificate: {error}. Check the address and port."
        ) from None
    found = hashlib.sha256(ssl.PEM_cert_to_DER_cert(shown)).hexdigest()
    if not hmac.compare_digest(found, fingerprint.replace(":", "").lower()):
        spaced = ":".join(found[k : k + 2] for k in range(0, 64, 2)).upper()
        raise CertificateError(
            f"The certificate of the camera at {address} is not the configured one. Nothing was sent to it. If the certificate was "
            f"renewed, compare its fingerprint at the camera and configure it: {spaced}"
        )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.check_hostname = False
    context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
    context.load_verify_locations(cadata=shown)
    return context
