"""Parse the harmony format used by the gpt-oss models, for servers that return it unparsed.

A reply is a sequence of messages in channels. The channel ``analysis`` contains the reasoning
(``<|channel|>analysis<|message|>...<|end|>``), and ``final`` contains the answer. A tool call is a message whose recipient is the
tool:
``<|channel|>commentary to=functions.go_home <|constrain|>json<|message|>{}<|call|>``.
"""

from __future__ import annotations

import re

_TOKEN = re.compile(r"<\|(start|channel|constrain|message|end|return|call)\|>")
_RECIPIENT = re.compile(r"to=(?:functions\.)?([\w.-]+)")


def read_harmony(text: str) -> tuple[str, list[str]]:
    """Separate a reply into its visible text and its reasoning messages. Text in another format is returned unchanged.

    Tool calls become ``<tool_call>`` elements in the visible text, with their arguments as written.
    """
    if "<|channel|>" not in text:
        return text, []
    visible: list[str] = []
    reasoning_parts: list[str] = []
    header = ""
    in_body = False
    pieces = _TOKEN.split(text)
    if pieces[0].strip():
        header = pieces[0]  # the prompt contains the start of the header, so the reply begins inside the header
    for token, piece in zip(pieces[1::2], pieces[2::2], strict=True):
        if token == "message":  # noqa: S105 - a token of the format, not a password
            in_body = True
            _append_message(header, piece.strip(), visible, reasoning_parts)
        elif token in ("start", "channel", "constrain"):
            header = piece if in_body else f"{header} {piece}"
            in_body = False
        else:
            header, in_body = "", False
            visible.append(piece)
    return "".join(visible), reasoning_parts


def _append_message(header: str, body: str, visible: list[str], reasoning_parts: list[str]) -> None:
    """Append a message to the visible text or to the reasoning, depending on its header."""
    recipient = _RECIPIENT.search(header)
    if recipient:
        visible.append(f"<tool_call><function={recipient[1]}>{body}</function></tool_call>")
    elif "analysis" in header:
        reasoning_parts.append(body)
    else:
        visible.append(body + "\n")
