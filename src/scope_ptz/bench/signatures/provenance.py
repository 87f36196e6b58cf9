"""Determine who evaluated a submission: a trusted host or its authors."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from scope_ptz.bench.signatures.detached import check_signature, read_signature, signature_path
from scope_ptz.bench.signatures.keys import fingerprint
from scope_ptz.errors import ConfigError, InputError

Evaluated = Literal["hosted", "self-reported"]


@dataclass(frozen=True, slots=True)
class Provenance:
    """The provenance of a submission: who evaluated it.

    Attributes:
        evaluated: "hosted" if a trusted host signed exactly this file, otherwise "self-reported".
        faults: Reasons to reject the file, such as an edit after it was signed.
        notes: Remarks that are not faults.
        signer: Fingerprint of the trusted key with which the file was signed; empty for self-reported files.
    """

    evaluated: Evaluated
    faults: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    signer: str = ""


def provenance_of(path: Path, trusted: Mapping[bytes, str]) -> Provenance:
    """Determine who evaluated a submission. The signature is read from ``FILE.sig``.

    Args:
        path: The submission.
        trusted: The file names of trusted public keys, by raw key.

    Raises:
        InputError: The submission cannot be read.
        ConfigError: There is a signature, but the package for checking signatures is not installed.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"The submission {path} cannot be read: {error.strerror}.") from error
    claims_hosted = _claims_hosted(content)
    sig = signature_path(path).name
    try:
        signature = read_signature(path)
        if signature is None:
            missing = f"the header states that a host evaluated it, but there is no signature {sig}"
            return Provenance("self-reported", (missing,) if claims_hosted else ())
        raw = signature.raw_key()
        check_signature(signature, content)
    except InputError as error:
        reason = str(error).rstrip(".")
        return Provenance("self-reported", (reason if sig in reason else f"the signature {sig} is not valid: {reason}",))
    except ModuleNotFoundError as error:
        raise ConfigError(
            "Signatures require the package cryptography. Install it with: pip install 'scope-ptz[bench]'."
        ) from error
    if raw not in trusted:
        unknown = f"it is signed by the unknown key {fingerprint(raw)}" + (
            "" if trusted else "; no host keys are trusted, so give one with --host-key"
        )
        return Provenance("self-reported", (unknown,))
    if claims_hosted is False:
        return Provenance("self-reported", notes=(f"signed by {trusted[raw]}, but the header states that it is self-reported",))
    return Provenance("hosted", notes=(f"signed by {trusted[raw]} ({fingerprint(raw)})",), signer=fingerprint(raw))


def _claims_hosted(content: bytes) -> bool | None:
    """Return whether the header of a submission states that a host evaluated it; None if the header does not state this."""
    try:
        header = json.loads(content.split(b"\n", 1)[0])
        evaluated = header.get("evaluated")
    except (ValueError, AttributeError, RecursionError):
        return None  # The content checks report damaged headers.
    return None if evaluated is None else evaluated == "hosted"
