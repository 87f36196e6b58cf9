"""Detached signatures: ``FILE.sig`` next to a file contains an Ed25519 signature of the file's exact bytes."""

from __future__ import annotations

import base64
import binascii
import hashlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from scope_ptz.bench.signatures.keys import RAW_KEY_BYTES, fingerprint, raw_bytes
from scope_ptz.errors import InputError, OutputError

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

SIGNATURE_SUFFIX = ".sig"
MAX_SIGNATURE_FILE_BYTES = 10_000  # a larger file is not a signature


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class SignedFile(_Part):
    """The name, size in bytes and SHA-256 digest of a signed file. The signature covers the file's bytes, not this record."""

    file: Annotated[str, Field(max_length=300)]
    bytes: Annotated[int, Field(ge=0)]
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Signature(_Part):
    """The content of a signature file.

    Attributes:
        format: Version of this format.
        algorithm: The signature algorithm.
        public_key: The 32 bytes of the signer's public key, in base64.
        fingerprint: The fingerprint of the public key.
        signature: The signature of the file's bytes, in base64.
        signed: The signed file.
    """

    format: Literal[1] = 1
    algorithm: Literal["Ed25519"] = "Ed25519"
    public_key: Annotated[str, Field(max_length=100)]
    fingerprint: Annotated[str, Field(max_length=100)]
    signature: Annotated[str, Field(max_length=200)]
    signed: SignedFile

    def raw_key(self) -> bytes:
        """Return the 32 bytes of the public key. Raises ``InputError``."""
        raw = _decode_base64(self.public_key)
        if len(raw) != RAW_KEY_BYTES:
            raise InputError("its public key is not an Ed25519 key")
        return raw


def signature_path(path: Path) -> Path:
    """Return the path of a file's signature."""
    return path.with_name(path.name + SIGNATURE_SUFFIX)


def sign(path: Path, key: Ed25519PrivateKey) -> Path:
    """Sign a file, and write the signature next to it. An earlier signature is replaced.

    Returns:
        The path of the signature.

    Raises:
        InputError: The file cannot be read.
        OutputError: The signature file cannot be written.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from error
    raw = raw_bytes(key.public_key())
    signature = Signature(
        public_key=base64.b64encode(raw).decode(),
        fingerprint=fingerprint(raw),
        signature=base64.b64encode(key.sign(content)).decode(),
        signed=SignedFile(file=path.name, bytes=len(content), sha256=hashlib.sha256(content).hexdigest()),
    )
    out = signature_path(path)
    try:
        out.write_text(signature.model_dump_json(indent=1) + "\n", "utf-8")
    except OSError as error:
        raise OutputError(f"The signature {out} cannot be written: {error.strerror}.") from error
    return out


def read_signature(path: Path) -> Signature | None:
    """Read the signature of a file; return None if there is no signature.

    Raises:
        InputError: The signature file cannot be read, or its format is invalid.
    """
    file = signature_path(path)
    try:
        with file.open("rb") as stream:
            content = stream.read(MAX_SIGNATURE_FILE_BYTES + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"the signature {file.name} cannot be read: {error.strerror}") from error
    if len(content) > MAX_SIGNATURE_FILE_BYTES:
        raise InputError(f"the signature {file.name} is too large to be one")
    try:
        return Signature.model_validate_json(content)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise InputError(f"the signature {file.name} is damaged: {f'{where}: ' if where else ''}{first['msg']}") from None


def check_signature(signature: Signature, content: bytes) -> None:
    """Check that a signature matches its public key and exactly these bytes.

    Raises:
        InputError: The signature is not valid. The message states the reason.
    """
    from cryptography.exceptions import InvalidSignature
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

    raw = signature.raw_key()
    if signature.fingerprint != fingerprint(raw):
        raise InputError("its fingerprint is not that of its public key")
    try:
        Ed25519PublicKey.from_public_bytes(raw).verify(_decode_base64(signature.signature), content)
    except InvalidSignature:
        changed = hashlib.sha256(content).hexdigest() != signature.signed.sha256
        raise InputError("the file was edited after it was signed" if changed else "it was not made with its public key") from None


def _decode_base64(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        raise InputError("it contains invalid base64") from None
