"""Ed25519 keys of hosts, stored as PEM files that OpenSSL can also read."""

from __future__ import annotations

import base64
import hashlib
import os
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from scope_ptz.errors import ConfigError, InputError, OutputError

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey, Ed25519PublicKey

PUBLIC_SUFFIX = ".pub"
"""Suffix of public key files. It is appended to the file name of the private key."""
RAW_KEY_BYTES = 32  # size of a raw public key
MAX_KEY_FILE_BYTES = 10_000  # a larger file is not a key
_OTHER_USERS_BITS = 0o077  # permission bits of other users


def generate_key(path: Path) -> Ed25519PublicKey:
    """Create a key pair. Only the owner can read the private key; the public key is stored next to it.

    Args:
        path: The file for the private key. The public key is written to the same path with the suffix ``.pub``.

    Returns:
        The public key.

    Raises:
        OutputError: One of the files exists or cannot be written.
    """
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat, PublicFormat

    private = Ed25519PrivateKey.generate()
    public = private.public_key()
    secret = private.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())
    _write_new(path, secret, 0o600)
    _write_new(public_path(path), public.public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo), 0o644)
    return public


def public_path(path: Path) -> Path:
    """Return the path of the public key that belongs to a private key."""
    return path.with_name(path.name + PUBLIC_SUFFIX)


def load_private_key(path: Path) -> Ed25519PrivateKey:
    """Read a private key. Error messages never contain the key.

    Raises:
        ConfigError: The file cannot be read, other users can read it, or it contains no Ed25519 key.
    """
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
    from cryptography.hazmat.primitives.serialization import load_pem_private_key

    content = _read(path)
    if os.name == "posix" and path.stat().st_mode & _OTHER_USERS_BITS:
        raise ConfigError(f"Other users can read the key {path}. Run `chmod 600 {path}`, or create a new key.")
    try:
        key = load_pem_private_key(content, password=None)
    except (ValueError, TypeError):  # the library's message may quote the content
        key = None
    if not isinstance(key, Ed25519PrivateKey):
        raise ConfigError(f"{path} contains no Ed25519 private key. Create one with `scope bench keygen`.")
    return key


def load_public_key(path: Path) -> Ed25519PublicKey:
    """Read a public key in PEM format.

    Raises:
        ConfigError: The file cannot be read or contains no Ed25519 public key.
    """
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey
    from cryptography.hazmat.primitives.serialization import load_pem_public_key

    try:
        key = load_pem_public_key(_read(path))
    except ValueError:
        key = None
    if not isinstance(key, Ed25519PublicKey):
        raise ConfigError(f"{path} contains no Ed25519 public key. Use the file that ends in {PUBLIC_SUFFIX}.")
    return key


def read_trusted_keys(paths: Iterable[Path]) -> dict[bytes, str]:
    """Read the public keys that an operator trusts, and return their file names by raw key.

    Args:
        paths: Public key files, and folders in which all files ending in ``.pub`` are read.

    Raises:
        ConfigError: A file is not a public key.
        InputError: A path does not exist, or a folder contains no key.
    """
    trusted: dict[bytes, str] = {}
    for path in paths:
        files = sorted(path.glob(f"*{PUBLIC_SUFFIX}")) if path.is_dir() else [path]
        if not files:
            raise InputError(f"The folder {path} contains no public key (*{PUBLIC_SUFFIX}).")
        trusted |= {raw_bytes(load_public_key(file)): file.name for file in files}
    return trusted


def raw_bytes(key: Ed25519PublicKey) -> bytes:
    """Return the 32 bytes of a public key."""
    from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat

    return key.public_bytes(Encoding.Raw, PublicFormat.Raw)


def fingerprint(raw: bytes) -> str:
    """Return the fingerprint of a public key: ``SHA256:`` and the hash of its 32 bytes in base64 without padding."""
    return "SHA256:" + base64.b64encode(hashlib.sha256(raw).digest()).decode().rstrip("=")


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(MAX_KEY_FILE_BYTES)
    except OSError as error:
        raise ConfigError(f"The key {path} cannot be read: {error.strerror}.") from error


def _write_new(path: Path, content: bytes, mode: int) -> None:
    """Create a file with the given permissions. The file must not exist yet."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            file.write(content)
    except FileExistsError as error:
        raise OutputError(f"{path} already exists. Keys are never overwritten, so choose another file.") from error
    except OSError as error:
        raise OutputError(f"The key {path} cannot be written: {error.strerror}.") from error
