"""``scope mcp``: wrong options. tests/serve/mcp tests the server."""

from __future__ import annotations

import pytest

from tests.cli.conftest import Scope


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--transport", "carrier-pigeon"), "--transport must be stdio or http"),
        (("--role", "king"), "--role must be viewer or operator"),
        (("--json",), "--json applies to --transport http"),
        (("--camera", "sim:x"), "sim:x"),
        (("--transport", "http", "--host", "0.0.0.0"), "without tokens"),  # noqa: S104 - refused
    ],
)
def test_wrong_options(scope: Scope, options: tuple[str, ...], message: str) -> None:
    done = scope("mcp", *options)
    assert (done.code, message in done.err) == (2, True), done.err
