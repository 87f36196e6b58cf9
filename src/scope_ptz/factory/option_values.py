"""Parse ``NAME=VALUE`` options."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from scope_ptz.errors import InputError


def parse_options(pairs: Iterable[str], option: str) -> dict[str, Any]:
    """Parse ``NAME=VALUE`` options. A value that is valid JSON is parsed as JSON; any other value is text.

    Args:
        pairs: The options, as specified by the user.
        option: Name of the command-line option, for error messages.

    Returns:
        The values by name.

    Raises:
        InputError: A pair has no name or no equals sign.
    """
    options: dict[str, Any] = {}
    for pair in pairs:
        name, equals, value = pair.partition("=")
        if not equals or not name.strip():
            raise InputError(f"{option} must have the form NAME=VALUE; got '{pair[:80]}'.")
        try:
            options[name.strip()] = json.loads(value)
        except ValueError:
            options[name.strip()] = value
    return options
