"""Whether sandboxes can be created where the tests run."""

from __future__ import annotations

import pytest

from scope_ptz.bench.agents.sandbox import require_sandbox
from scope_ptz.errors import ConfigError


def reason_against() -> str:
    """Return why no sandbox can be created here; empty if one can."""
    try:
        require_sandbox()
    except ConfigError as error:
        return str(error)
    return ""


REASON = reason_against()
needs_sandbox = pytest.mark.skipif(bool(REASON), reason=REASON or "never")
