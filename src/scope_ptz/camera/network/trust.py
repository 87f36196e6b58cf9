"""Trust a device's self-signed certificate by its fingerprint."""

from __future__ import annotations

import hashlib
import hmac
import ssl

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.errors import CameraUnreachableError
from scope_ptz.errors import CameraError


class CertificateError(CameraError):
    """The device's certificate does not match the configured fingerprint."""


class PinnedContext(ssl.SSLContext):
    """A TLS context that trusts a single certificate.

    Attributes:
        certificate: The certificate in PEM format.
    """

    certificate: str

    @classmethod
    def of(cls, certificate: str) -> PinnedContext:
        """Return a context that trusts only the given certificate, in PEM format."""
        context = cls(ssl.PROTOCOL_TLS_CLIENT)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        context.check_hostname = False
        context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
        context.load_verify_locations(cadata=certificate)
        context.certificate = certificate
        return context


def trust_fingerprint(address: DeviceAddress, fingerprint: str, *, timeout_s: float = 5.0) -> PinnedContext:
    """Return a TLS context that accepts only the certificate with the given fingerprint. This call blocks while it connects.

    The certificate is fetched and compared with the fingerprint. If the device later presents another certificate, the TLS
    handshake fails before any credentials are sent.

    Args:
        address: The address of the device.
        fingerprint: SHA-256 fingerprint of the certificate in hexadecimal, with or without colons.
        timeout_s: Connection timeout in seconds.

    Raises:
        CertificateError: The device presents another certificate.
        CameraUnreachableError: The device does not respond, or does not use TLS.
    """
    try:
        certificate = ssl.get_server_certificate((address.host.strip("[]"), address.port), timeout=timeout_s)
    except (OSError, ValueError) as error:
        raise CameraUnreachableError(
            f"The camera at {address} did not present a certificate: {error}. Check the address and the port."
        ) from None
    digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(certificate)).hexdigest()
    if not hmac.compare_digest(digest, fingerprint.replace(":", "").lower()):
        fingerprint_text = ":".join(digest[k : k + 2] for k in range(0, 64, 2)).upper()
        raise CertificateError(
            f"The camera at {address} presented a certificate that does not match the configured fingerprint. No credentials were "
            "sent. If the certificate was renewed, check that the camera's web page shows this fingerprint, and set it in "
            f"scope.yaml: {fingerprint_text}"
        )
    return PinnedContext.of(certificate)
