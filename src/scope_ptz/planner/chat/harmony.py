"""The harmony format of the gpt-oss models, for servers that pass it on as text: messages in channels.

``<|channel|>analysis<|message|>...<|end|>`` is reasoning, ``final`` the answer, and a call is addressed to its tool:
``<|channel|>commentary to=functions.go_home <|constrain|>json<|message|>{}<|call|>``.
"""

from __future__ import annotations

import re

_MESSAGE = re.compile(
    r"(?:<\|start\|>\s*(?P<role>[^<]*))?<\|channel\|>(?P<header>.*?)<\|message\|>(?P<body>.*?)"
    r"(?=<\|end\|>|<\|return\|>|<\|call\|>|<\|start\|>|<\|channel\|>|\Z)(?:<\|(?:end|return|call)\|>)?",
    re.DOTALL,
)
_RECIPIENT = re.compile(r"to=(?:functions\.)?([\w.-]+)")


def read_harmony(text: str) -> tuple[str, list[str]]:
    """The text without its channels, and the reasoning. Calls are left in it as ``<tool_call>`` elements of name and raw
    arguments."""
    if "<|channel|>" not in text:
        return text, []
    thoughts: list[str] = []

    def replace(match: re.Match[str]) -> str:
        header, body = match["header"], match["body"].strip()
        recipient = _RECIPIENT.search(header) or _RECIPIENT.search(match["role"] or "")
        if recipient:
            return f"<tool_call><function={recipient[1]}>{body}</function></tool_call>"
        if header.strip().startswith("analysis"):
            thoughts.append(body)
            return ""
        return body + "\n"

    return _MESSAGE.sub(replace, text), thoughts
