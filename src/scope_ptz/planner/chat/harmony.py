"""The harmony format of the gpt-oss models, for servers that return it as text: messages in channels.

``<|channel|>analysis<|message|>...<|end|>`` is reasoning, ``final`` is the answer, and a call is addressed to its tool:
``<|channel|>commentary to=functions.go_home <|constrain|>json<|message|>{}<|call|>``.
"""

from __future__ import annotations

import re

_TOKEN = re.compile(r"<\|(start|channel|constrain|message|end|return|call)\|>")
_RECIPIENT = re.compile(r"to=(?:functions\.)?([\w.-]+)")


def read_harmony(text: str) -> tuple[str, list[str]]:
    """Return the text without its channels, and the reasoning.

    Calls remain in the text as ``<tool_call>`` elements, with their arguments as written.
    """
    if "<|channel|>" not in text:
        return text, []
    visible: list[str] = []
    thoughts: list[str] = []
    header = ""
    in_body = False
    pieces = _TOKEN.split(text)
    if pieces[0].strip():
        header = pieces[0]  # the prompt ended with the role or the name of the channel
    for token, piece in zip(pieces[1::2], pieces[2::2], strict=True):
        if token == "message":  # noqa: S105 - a token of a language, not of a login
            in_body = True
            _file(header, piece.strip(), visible, thoughts)
        elif token in ("start", "channel", "constrain"):
            header = piece if in_body else f"{header} {piece}"
            in_body = False
        else:
            header, in_body = "", False
            visible.append(piece)
    return "".join(visible), thoughts


def _file(header: str, body: str, visible: list[str], thoughts: list[str]) -> None:
    recipient = _RECIPIENT.search(header)
    if recipient:
        visible.append(f"<tool_call><function={recipient[1]}>{body}</function></tool_call>")
    elif "analysis" in header:
        thoughts.append(body)
    else:
        visible.append(body + "\n")
