"""Keys, detached signatures, and the provenance of submissions."""

from __future__ import annotations

import base64
import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from scope_ptz.bench.signatures.detached import sign, signature_path
from scope_ptz.bench.signatures.keys import (
    fingerprint,
    generate_key,
    load_private_key,
    load_public_key,
    public_path,
    raw_bytes,
    read_trusted_keys,
)
from scope_ptz.bench.signatures.provenance import provenance_of
from scope_ptz.errors import ConfigError, InputError, OutputError

HOSTED = b'{"kind":"header","evaluated":"hosted"}\n{"kind":"trial"}\n'


@pytest.fixture
def key(tmp_path: Path) -> Path:
    path = tmp_path / "host.key"
    generate_key(path)
    return path


@pytest.fixture
def signed_file(key: Path, tmp_path: Path) -> Path:
    file = tmp_path / "team.jsonl"
    file.write_bytes(HOSTED)
    sign(file, load_private_key(key))
    return file


def edit_signature(file: Path, change: Callable[[dict[str, Any]], object]) -> None:
    path = signature_path(file)
    content = json.loads(path.read_text("utf-8"))
    change(content)
    path.write_text(json.dumps(content), "utf-8")


def test_a_signed_file_is_hosted_under_a_trusted_key(signed_file: Path, key: Path) -> None:
    for trusted in ([public_path(key)], [key.parent]):
        provenance = provenance_of(signed_file, read_trusted_keys(trusted))
        assert (provenance.evaluated, provenance.faults) == ("hosted", ())
        assert provenance.signer == fingerprint(raw_bytes(load_public_key(public_path(key))))


def test_openssl_verifies_a_signature(signed_file: Path, key: Path, tmp_path: Path) -> None:
    raw = tmp_path / "raw.sig"
    raw.write_bytes(base64.b64decode(json.loads(signature_path(signed_file).read_text("utf-8"))["signature"]))
    command: list[str | Path] = [
        "openssl",
        "pkeyutl",
        "-verify",
        "-pubin",
        "-inkey",
        public_path(key),
        "-rawin",
        "-in",
        signed_file,
        "-sigfile",
        raw,
    ]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("index", [0, 10, len(HOSTED) - 1])
def test_an_edited_file_is_reported(signed_file: Path, key: Path, index: int) -> None:
    content = bytearray(HOSTED)
    content[index] ^= 1
    signed_file.write_bytes(content)
    provenance = provenance_of(signed_file, read_trusted_keys([public_path(key)]))
    assert provenance.evaluated == "self-reported"
    assert "edited after it was signed" in provenance.faults[0]


@pytest.mark.parametrize("extra", [b"\n", b"{}", b" "])
def test_appended_bytes_are_reported(signed_file: Path, key: Path, extra: bytes) -> None:
    signed_file.write_bytes(HOSTED + extra)
    assert provenance_of(signed_file, read_trusted_keys([public_path(key)])).faults


def test_an_unknown_key_is_reported(signed_file: Path, tmp_path: Path) -> None:
    generate_key(tmp_path / "other" / "other.key")
    for trusted in ({}, read_trusted_keys([tmp_path / "other"])):
        provenance = provenance_of(signed_file, trusted)
        assert provenance.evaluated == "self-reported"
        assert "unknown key SHA256:" in provenance.faults[0]


def test_a_claim_without_a_signature_is_reported(signed_file: Path, key: Path) -> None:
    signature_path(signed_file).unlink()
    provenance = provenance_of(signed_file, read_trusted_keys([public_path(key)]))
    assert "there is no signature team.jsonl.sig" in provenance.faults[0]


@pytest.mark.parametrize("header", [b'{"kind":"header"}\n', b'{"evaluated":"self-reported"}\n', b"[]\n", b"not JSON", b"", b"\xff"])
def test_files_without_a_claim_are_self_reported(tmp_path: Path, header: bytes) -> None:
    file = tmp_path / "team.jsonl"
    file.write_bytes(header)
    assert provenance_of(file, {}) == provenance_of(file, {})
    assert (provenance_of(file, {}).evaluated, provenance_of(file, {}).faults) == ("self-reported", ())


def test_a_signature_of_a_self_reported_file_does_not_make_it_hosted(signed_file: Path, key: Path) -> None:
    signed_file.write_bytes(HOSTED.replace(b"hosted", b"self-reported"))
    sign(signed_file, load_private_key(key))
    provenance = provenance_of(signed_file, read_trusted_keys([public_path(key)]))
    assert (provenance.evaluated, provenance.faults) == ("self-reported", ())
    assert "the header states that it is self-reported" in provenance.notes[0]


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c.update(signature=base64.b64encode(bytes(64)).decode()),
        lambda c: c.update(signature="not base64!"),
        lambda c: c.update(signature=""),
        lambda c: c.update(public_key=base64.b64encode(bytes(31)).decode()),
        lambda c: c.update(public_key="é"),
        lambda c: c.update(fingerprint="SHA256:trusted"),
        lambda c: c.update(algorithm="none"),
        lambda c: c.update(format=2),
        lambda c: c.update(trusted=True),
        lambda c: c.pop("signed"),
    ],
)
def test_a_broken_signature_is_reported(signed_file: Path, key: Path, change: Callable[[dict[str, Any]], object]) -> None:
    edit_signature(signed_file, change)
    provenance = provenance_of(signed_file, read_trusted_keys([public_path(key)]))
    assert provenance.evaluated == "self-reported"
    assert provenance.faults and "team.jsonl.sig" in provenance.faults[0]


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff\xfe", b"{" * 5000, b" " * 20_000])
def test_a_damaged_signature_file_is_reported(signed_file: Path, key: Path, content: bytes) -> None:
    signature_path(signed_file).write_bytes(content)
    assert provenance_of(signed_file, read_trusted_keys([public_path(key)])).faults


def test_a_signature_of_another_file_is_reported(signed_file: Path, key: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.jsonl"
    other.write_bytes(HOSTED + HOSTED)
    signature_path(other).write_bytes(signature_path(signed_file).read_bytes())
    assert provenance_of(other, read_trusted_keys([public_path(key)])).faults


def test_an_attackers_key_in_the_signature_is_not_trusted(signed_file: Path, key: Path, tmp_path: Path) -> None:
    """A signature that is valid under its own key proves nothing, whatever fingerprint it states."""
    generate_key(tmp_path / "evil" / "evil.key")
    sign(signed_file, load_private_key(tmp_path / "evil" / "evil.key"))
    trusted = read_trusted_keys([public_path(key)])
    assert "unknown key" in provenance_of(signed_file, trusted).faults[0]
    trusted_fingerprint = fingerprint(raw_bytes(load_public_key(public_path(key))))
    edit_signature(signed_file, lambda c: c.update(fingerprint=trusted_fingerprint))
    assert "not valid" in provenance_of(signed_file, trusted).faults[0]


def test_a_private_key_is_private(key: Path) -> None:
    assert key.stat().st_mode & 0o777 == 0o600
    secret = key.read_text("ascii")
    assert "PRIVATE" in secret and "PRIVATE" not in public_path(key).read_text("ascii")
    with pytest.raises(OutputError, match="never overwritten"):
        generate_key(key)
    assert key.read_text("ascii") == secret
    key.chmod(0o640)
    with pytest.raises(ConfigError, match="Other users"):
        load_private_key(key)


@pytest.mark.parametrize("content", [b"", b"-----BEGIN PRIVATE KEY-----\nc2VjcmV0\n-----END PRIVATE KEY-----\n", b"\xff" * 100])
def test_messages_never_quote_a_key(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "key"
    path.write_bytes(content)
    path.chmod(0o600)
    for load in (load_private_key, load_public_key):
        with pytest.raises(ConfigError) as excinfo:
            load(path)
        assert "c2VjcmV0" not in str(excinfo.value)


def test_keys_of_other_algorithms_are_refused(tmp_path: Path) -> None:
    from cryptography.hazmat.primitives.asymmetric.x25519 import X25519PrivateKey
    from cryptography.hazmat.primitives.serialization import Encoding, NoEncryption, PrivateFormat, PublicFormat

    other = X25519PrivateKey.generate()
    path = tmp_path / "other.key"
    path.write_bytes(other.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()))
    path.chmod(0o600)
    public_path(path).write_bytes(other.public_key().public_bytes(Encoding.PEM, PublicFormat.SubjectPublicKeyInfo))
    with pytest.raises(ConfigError, match="no Ed25519 private key"):
        load_private_key(path)
    with pytest.raises(ConfigError, match="no Ed25519 public key"):
        read_trusted_keys([public_path(path)])


def test_a_folder_without_keys_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="contains no public key"):
        read_trusted_keys([tmp_path])
    with pytest.raises(ConfigError, match="cannot be read"):
        read_trusted_keys([tmp_path / "missing.pub"])
