"""Quote untrusted text in judge prompts, so that a judge cannot mistake it for its own instructions.

A bar is added before every line, so no text can end the quotation. Control tokens of chat templates are split, because many servers
interpret them in any message.
"""

from __future__ import annotations

import re

BAR = "| "
"""Prefix of every quoted line."""
_LINE_ENDS = re.compile(r"\r\n|[\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029]")
_TOKENS = re.compile(
    r"<(?=[|｜])|(?<=[|｜])>|<(?=/?(?:s|bos|eos|think|thinking|start_of_turn|end_of_turn|im_start|im_end|tool_call)\b)|\[(?=/?(?:INST|SYS)\])",
    re.IGNORECASE,
)
"""Brackets of control tokens such as ``<|im_end|>``, ``</s>`` or ``[/INST]``."""
_MAX_FOUR_DIGIT_CODE = 0xFFFF
"""Largest character code that is escaped with four hexadecimal digits."""


def quote(text: str) -> str:
    """Add a bar before each line of text, and escape unprintable characters. An empty text becomes a single bar."""
    return "\n".join(BAR + _neutralize(line) for line in _LINE_ENDS.split(text))


def quote_name(text: str, max_chars: int) -> str:
    """Format a name as a single line of at most ``max_chars`` characters in double quotes. Double quotes in it are replaced."""
    line = _neutralize(" ".join(_LINE_ENDS.sub(" ", text).split())).replace('"', "'")
    return f'"{line if len(line) <= max_chars else line[: max_chars - 1] + "…"}"'


def shorten(text: str, max_chars: int) -> str:
    """Shorten text to about ``max_chars`` characters. Its middle is replaced with a note."""
    if len(text) <= max_chars:
        return text
    head, tail = max_chars * 2 // 3, max_chars // 3
    return f"{text[:head]} [... {len(text) - head - tail} characters left out ...] {text[len(text) - tail :]}"


def _neutralize(line: str) -> str:
    """Escape the unprintable characters of a line, and split its control tokens."""
    line = line.replace("\t", " ")
    if not line.isprintable():
        line = "".join(character if character.isprintable() else _escape(character) for character in line)
    return _TOKENS.sub(_split_token, line)


def _split_token(token: re.Match[str]) -> str:
    """Separate a bracket from the rest of its control token."""
    return f" {token[0]}" if token[0] == ">" else f"{token[0]} "


def _escape(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code <= _MAX_FOUR_DIGIT_CODE else f"\\U{code:08x}"
