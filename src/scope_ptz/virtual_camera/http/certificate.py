"""Self-signed certificates for virtual cameras, like those that real cameras create when they are first started."""

from __future__ import annotations

import hashlib
import ssl
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from ipaddress import ip_address
from pathlib import Path
from tempfile import TemporaryDirectory

from scope_ptz.errors import ConfigError

VALID_DAYS = 365


@dataclass(frozen=True, slots=True)
class Certificate:
    """A certificate with its private key, which is hidden from ``repr``.

    Attributes:
        pem: The certificate in PEM format.
        key_pem: The private key in PEM format.
    """

    pem: str
    key_pem: str = field(repr=False)

    @property
    def fingerprint(self) -> str:
        """SHA-256 fingerprint of the certificate in hexadecimal, with colons."""
        digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(self.pem)).hexdigest().upper()
        return ":".join(digest[k : k + 2] for k in range(0, len(digest), 2))

    def server_context(self) -> ssl.SSLContext:
        """Return a server-side TLS context that presents this certificate."""
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        # Python can load certificates only from files. Only the current user can read the folder, which is deleted afterwards.
        with TemporaryDirectory(prefix="scope-certificate-") as folder:
            path = Path(folder) / "certificate.pem"
            path.write_text(self.pem + self.key_pem, encoding="ascii")
            context.load_cert_chain(path)
        return context


def create_certificate(name: str, hosts: tuple[str, ...]) -> Certificate:
    """Create a new key and a self-signed certificate.

    Args:
        name: Device name; only its first 64 characters are used.
        hosts: Host names and addresses for which the certificate is valid.

    Raises:
        ConfigError: The package ``cryptography`` is not installed.
    """
    try:
        from cryptography import x509
        from cryptography.hazmat.primitives import hashes, serialization
        from cryptography.hazmat.primitives.asymmetric import ec
        from cryptography.x509.oid import NameOID
    except ModuleNotFoundError as error:
        raise ConfigError("HTTPS requires the package cryptography. Install it with: pip install 'scope-ptz[serve]'") from error
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name[:64] or "camera")])
    alternatives: list[x509.GeneralName] = []
    for host in hosts:
        try:
            alternatives.append(x509.IPAddress(ip_address(host)))
        except ValueError:
            alternatives.append(x509.DNSName(host))
    now = datetime.now(UTC)
    certificate = (
        x509.CertificateBuilder().subject_name(subject).issuer_name(subject).public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1)).not_valid_after(now + timedelta(days=VALID_DAYS))
        .add_extension(x509.SubjectAlternativeName(alternatives), critical=False)
        .sign(key, hashes.SHA256())
    )  # fmt: skip
    private = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )  # fmt: skip
    return Certificate(certificate.public_bytes(serialization.Encoding.PEM).decode(), private.decode())
