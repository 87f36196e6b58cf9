"""A marker for tests that need a sandbox, and the reason if no sandbox can be created here."""

from __future__ import annotations

import pytest

from scope_ptz.bench.agents.sandbox import require_sandbox
from scope_ptz.errors import ConfigError


def sandbox_problem() -> str:
    """Return the reason why no sandbox can be created here, or an empty string."""
    try:
        require_sandbox()
    except ConfigError as error:
        return str(error)
    return ""


SANDBOX_PROBLEM = sandbox_problem()
needs_sandbox = pytest.mark.skipif(bool(SANDBOX_PROBLEM), reason=SANDBOX_PROBLEM or "never")
