"""Text of others as data: what an agent, a camera or a task file wrote cannot be taken for the judge's own prompt.

Every line of such text begins with a bar. Nothing inside can end the quotation, because whatever ends a line begins a new one with
a bar, and control tokens of chat templates are broken up, since many servers read them in any message.
"""

from __future__ import annotations

import re

BAR = "| "
_LINE_ENDS = re.compile(r"\r\n|[\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029]")
_TOKENS = re.compile(
    r"<(?=[|｜])|(?<=[|｜])>|<(?=/?(?:s|bos|eos|think|thinking|start_of_turn|end_of_turn|im_start|im_end|tool_call)\b)|\[(?=/?(?:INST|SYS)\])",
    re.IGNORECASE,
)
"""Where tokens such as ``<|im_end|>``, ``</s>`` or ``[/INST]`` begin or end."""
_HEX_UP_TO = 0xFFFF


def quoted(text: str) -> str:
    """The text with a bar before each line; never empty. Characters that do not show are written as escapes."""
    return "\n".join(BAR + _harmless(line) for line in _LINE_ENDS.split(text))


def inline(text: str, most: int) -> str:
    """A name for use within a line: one line, cut to ``most`` characters, in quotation marks that it cannot close."""
    line = _harmless(" ".join(_LINE_ENDS.sub(" ", text).split())).replace('"', "'")
    return f'"{line if len(line) <= most else line[: most - 1] + "…"}"'


def cut(text: str, most: int) -> str:
    """The head and the tail of a text that is longer than ``most`` characters, with a note of how much is missing."""
    if len(text) <= most:
        return text
    head, tail = most * 2 // 3, most // 3
    return f"{text[:head]} [... {len(text) - head - tail} characters left out ...] {text[len(text) - tail :]}"


def _harmless(line: str) -> str:
    line = line.replace("\t", " ")
    if not line.isprintable():
        line = "".join(character if character.isprintable() else _escape(character) for character in line)
    return _TOKENS.sub(_apart, line)


def _apart(token: re.Match[str]) -> str:
    """The bracket moved away from what makes a token of it."""
    return f" {token[0]}" if token[0] == ">" else f"{token[0]} "


def _escape(character: str) -> str:
    code = ord(character)
    return f"\\u{code:04x}" if code <= _HEX_UP_TO else f"\\U{code:08x}"
