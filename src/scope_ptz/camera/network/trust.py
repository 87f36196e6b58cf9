"""Trust a device's self-signed certificate by its fingerprint."""

from __future__ import annotations

import hashlib
import hmac
import ssl

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.errors import CameraUnreachableError
from scope_ptz.errors import CameraError


class CertificateError(CameraError):
    """The device's certificate is not the one that the site trusts."""


class PinnedContext(ssl.SSLContext):
    """A TLS context that trusts one certificate.

    Attributes:
        certificate: The certificate, as PEM.
    """

    certificate: str

    @classmethod
    def of(cls, certificate: str) -> PinnedContext:
        """Return a context that trusts a certificate (PEM) and no other."""
        context = cls(ssl.PROTOCOL_TLS_CLIENT)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        context.check_hostname = False
        context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
        context.load_verify_locations(cadata=certificate)
        context.certificate = certificate
        return context


def trust_fingerprint(address: DeviceAddress, fingerprint: str, *, timeout_s: float = 5.0) -> PinnedContext:
    """Return a TLS context that accepts only the certificate with a given fingerprint. The call blocks while it connects.

    The certificate is fetched, compared, and then becomes the only one that the context trusts. If a later
    connection presents another certificate, the TLS handshake therefore fails before any credentials are sent.

    Args:
        address: The address of the device.
        fingerprint: SHA-256 of the certificate in hexadecimal, with or without colons.
        timeout_s: Time limit for the connection in seconds.

    Raises:
        CertificateError: The device presents another certificate.
        CameraUnreachableError: The device does not answer, or does not use TLS.
    """
    try:
        shown = ssl.get_server_certificate((address.host.strip("[]"), address.port), timeout=timeout_s)
    except (OSError, ValueError) as error:
        raise CameraUnreachableError(
            f"The camera at {address} presents no certificate: {error}. Check the address and port."
        ) from None
    found = hashlib.sha256(ssl.PEM_cert_to_DER_cert(shown)).hexdigest()
    if not hmac.compare_digest(found, fingerprint.replace(":", "").lower()):
        spaced = ":".join(found[k : k + 2] for k in range(0, 64, 2)).upper()
        raise CertificateError(
            f"The certificate of the camera at {address} is not the configured one. Nothing was sent to it. If the certificate was "
            f"renewed, compare its fingerprint with the one that the camera's web page shows, and configure it: {spaced}"
        )
    return PinnedContext.of(shown)
