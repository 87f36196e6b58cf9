"""Decide who ran the evaluation of a submission: the participant (self-reported), or a host that signed the file (hosted).

The signature is a file beside the submission. It covers the bytes of the submission, so any change makes it invalid. The statement
in the header alone proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from scope_ptz.bench.reports.submission import Evaluated, Header
from scope_ptz.errors import InputError

SIGNATURE_SUFFIX = ".sig"
"""Suffix that is added to the name of a submission for the file of its signature."""
MAX_SIGNATURE_BYTES = 10_000

Verifier = Callable[[bytes, bytes], str | None]
"""Returns the name of the trusted host whose signature (second argument) of the content (first argument) is valid; else None."""


@dataclass(frozen=True, slots=True)
class EvaluatedBy:
    """Who ran an evaluation.

    Attributes:
        evaluated: "hosted" only if the signature is valid.
        host: The name of the host that signed.
        note: Why a file that states "hosted" is not accepted as such; empty otherwise.
        fault: What is wrong with the signature; empty if there is none or if it is valid.
    """

    evaluated: Evaluated
    host: str = ""
    note: str = ""
    fault: str = ""


def signature_file(path: Path) -> Path:
    """Return the path of the signature of a submission."""
    return path.with_name(path.name + SIGNATURE_SUFFIX)


def evaluated_by(path: Path, header: Header, verifier: Verifier | None = None) -> EvaluatedBy:
    """Return who ran the evaluation of a submission.

    Args:
        path: The submission.
        header: Its header.
        verifier: Checks signatures with the trusted keys; None if no key is trusted.

    Raises:
        InputError: The submission or its signature cannot be read.
    """
    signature = signature_file(path)
    if header.evaluated != "hosted":
        return EvaluatedBy("self-reported")
    if not signature.is_file():
        return EvaluatedBy("self-reported", note=f"the header states hosted, but there is no signature {signature.name}")
    if verifier is None:
        return EvaluatedBy(
            "self-reported", note="the header states hosted, but no host is trusted, so the signature is not checked"
        )
    try:
        content, signed = path.read_bytes(), signature.read_bytes()[:MAX_SIGNATURE_BYTES]
    except OSError as error:
        raise InputError(f"The submission {path} or its signature cannot be read: {error.strerror}.") from error
    host = verifier(content, signed)
    if host is None:
        return EvaluatedBy("self-reported", fault=f"the signature {signature.name} is not valid under a trusted key")
    return EvaluatedBy("hosted", host=host)
