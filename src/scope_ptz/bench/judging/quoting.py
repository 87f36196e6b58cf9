"""Quote untrusted text in judge prompts, so that a judge cannot mistake it for its own instructions.

Every line of the text begins with a bar, so nothing in the text can end the quotation. Control tokens of chat templates are split,
because many servers interpret them in any message.
"""

from __future__ import annotations

import re

BAR = "| "
_LINE_ENDS = re.compile(r"\r\n|[\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029]")
_TOKENS = re.compile(
    r"<(?=[|｜])|(?<=[|｜])>|<(?=/?(?:s|bos|eos|think|thinking|start_of_turn|end_of_turn|im_start|im_end|tool_call)\b)|\[(?=/?(?:INST|SYS)\])",
    re.IGNORECASE,
)
"""Brackets of control tokens such as ``<|im_end|>``, ``</s>`` or ``[/INST]``."""
_HEX_UP_TO = 0xFFFF


def quoted(text: str) -> str:
    """Return a text with a bar before each line. The result is never empty. Unprintable characters are escaped."""
    return "\n".join(BAR + _harmless(line) for line in _LINE_ENDS.split(text))


def inline(text: str, max_chars: int) -> str:
    """Return a name of at most ``max_chars`` characters for use within a line, in quotation marks that it cannot close."""
    line = _harmless(" ".join(_LINE_ENDS.sub(" ", text).split())).replace('"', "'")
    return f'"{line if len(line) <= max_chars else line[: max_chars - 1] + "…"}"'


def cut(text: str, max_chars: int) -> str:
    """Return a text of at most about ``max_chars`` characters. A note replaces the middle of a longer text."""
    if len(text) <= max_chars:
        return text
    head, tail = max_chars * 2 // 3, max_chars // 3
    return f"{text[:head]} [... {len(text) - head - tail} characters left out ...] {text[len(text) - tail :]}"


def _harmless(line: str) -> str:
    line = line.replace("\t", " ")
    if not line.isprintable():
        line = "".join(character if character.isprintable() else _escape(character) for character in line)
    return _TOKENS.sub(_split_token, line)


def _split_token(token: re.Match[str]) -> str:
    """Separate a bracket from the rest of its control token."""
    return f" {token[0]}" if token[0] == ">" else f"{token[0]} "


def _escape(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code <= _HEX_UP_TO else f"\\U{code:08x}"
