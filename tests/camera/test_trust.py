"""A certificate that a device signed itself is trusted by its fingerprint, and no other is."""

from __future__ import annotations

import hashlib
import socket
import ssl
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from scope_ptz.camera.network.address import DeviceAddress
from scope_ptz.camera.network.trust import CertificateError, trust_fingerprint
from scope_ptz.errors import CameraError


def _certificate(folder: Path, name: str) -> tuple[Path, str]:
    """Write a self-signed certificate with its key, and return the file and the fingerprint."""
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    now = datetime.now(UTC)
    made = (
        x509.CertificateBuilder().subject_name(subject).issuer_name(subject).public_key(key.public_key())
        .serial_number(x509.random_serial_number()).not_valid_before(now - timedelta(days=1))
        .not_valid_after(now + timedelta(days=1)).sign(key, hashes.SHA256())
    )  # fmt: skip
    pem = made.public_bytes(serialization.Encoding.PEM)
    private = key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption())
    path = folder / f"{name}.pem"
    path.write_bytes(pem + private)
    return path, hashlib.sha256(made.public_bytes(serialization.Encoding.DER)).hexdigest()


@contextmanager
def _device(certificate: Path) -> Iterator[DeviceAddress]:
    """A TLS server that says hello and closes."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate)
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def serve() -> None:
            while True:
                try:
                    raw, _ = listening.accept()
                except OSError:
                    return
                try:
                    with context.wrap_socket(raw, server_side=True) as connection:
                        connection.sendall(b"hello")
                except OSError:
                    raw.close()

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield DeviceAddress("127.0.0.1", listening.getsockname()[1], tls=True)
        listening.shutdown(socket.SHUT_RDWR)
    thread.join(5)


def _talk(address: DeviceAddress, context: ssl.SSLContext) -> bytes:
    with (
        socket.create_connection((address.host, address.port), timeout=5) as raw,
        context.wrap_socket(raw, server_hostname=address.host) as connection,
    ):
        return connection.recv(10)


def test_the_configured_certificate_is_trusted(tmp_path: Path) -> None:
    certificate, fingerprint = _certificate(tmp_path, "camera")
    colons = ":".join(fingerprint[k : k + 2] for k in range(0, 64, 2)).upper()
    with _device(certificate) as address:
        assert _talk(address, trust_fingerprint(address, colons)) == b"hello"


def test_another_certificate_is_refused_and_its_fingerprint_shown(tmp_path: Path) -> None:
    certificate, fingerprint = _certificate(tmp_path, "camera")
    with (
        _device(certificate) as address,
        pytest.raises(CertificateError, match="does not match the configured fingerprint") as caught,
    ):
        trust_fingerprint(address, "0" * 64)
    assert fingerprint[:2].upper() in str(caught.value)


def test_a_device_that_changes_later_fails_the_handshake(tmp_path: Path) -> None:
    first, fingerprint = _certificate(tmp_path, "camera")
    other, _ = _certificate(tmp_path, "intruder")
    with _device(first) as address:
        context = trust_fingerprint(address, fingerprint)
    with _device(other) as elsewhere, pytest.raises(ssl.SSLCertVerificationError):
        _talk(elsewhere, context)


def test_no_device_is_a_typed_error() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
    with pytest.raises(CameraError, match="did not present a certificate"):
        trust_fingerprint(DeviceAddress("127.0.0.1", port, tls=True), "0" * 64, timeout_s=1.0)
