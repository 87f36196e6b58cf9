"""Rule out patterns that cannot match, without compiling them, because words or classes that they need are missing.

Compiling a regular expression takes about a millisecond, and most patterns need a word that an instruction does not contain.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

_TOKEN = re.compile(r"\(\?(?:P<\w+>|:)|(?P<look>\(\?<?[=!])|\\.|'?[A-Za-z][A-Za-z_'-]*|\s+|[()|]|[?*+]\??|\{\d*,?\d*\}\??|.")
_NAME = re.compile(r"'?[A-Za-z]")
_OPTIONAL = ("?", "*", "{0", "{,")

Requirement = bool | str | tuple[str, tuple["Requirement", ...]]
"""A required name; or "all" or "any" with a tuple of requirements; or True if nothing is required, False if nothing can match."""


def requirement_of(pattern: str) -> Requirement:
    """Return which words and classes a pattern needs in order to match."""
    return _alternatives(iter(_TOKEN.finditer(pattern)))


def is_met(requirement: Requirement, names: Set[str]) -> bool:
    """Return whether the given words and classes meet a requirement."""
    if isinstance(requirement, bool):
        return requirement
    if isinstance(requirement, str):
        return requirement in names
    kind, parts = requirement
    return all(is_met(p, names) for p in parts) if kind == "all" else any(is_met(p, names) for p in parts)


def _alternatives(tokens: Iterator[re.Match[str]]) -> Requirement:
    """Return the requirement of the alternatives up to the end of the pattern or of the current group."""
    branches: list[list[Requirement]] = [[]]
    for token in tokens:
        text = token[0]
        if text == ")":
            break
        if text == "|":
            branches.append([])
        elif token["look"]:
            _alternatives(tokens)  # a look-around needs no lexeme
            branches[-1].append(True)
        elif text.startswith("("):
            branches[-1].append(_alternatives(tokens))
        elif text.startswith(_OPTIONAL):
            branches[-1][-1:] = [True]
        elif _NAME.match(text):
            branches[-1].append(text)
    return _combined("any", [_combined("all", branch) for branch in branches])


def _combined(kind: str, parts: list[Requirement]) -> Requirement:
    is_any = kind == "any"
    if is_any and True in parts:
        return True
    parts = [part for part in parts if part is not True]
    if not parts:
        return not is_any
    return parts[0] if len(parts) == 1 else (kind, tuple(parts))
