"""Find and parse the tool calls in a reply's text, for servers that return calls as text.

Everything inside the tags of a tagged notation is treated as a call, and calls that cannot be parsed are reported to the planner.
Text without tags (JSON or Python calls, bare or in a code fence) counts as a call only if it names an offered tool, so that an
answer in JSON remains an answer.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from json import JSONDecoder

from scope_ptz.planner.chat.strict import encodable, strict_json
from scope_ptz.planner.chat.written_calls import (
    MAX_QUOTED_CHARS,
    Signatures,
    WrittenCall,
    call_from_object,
    malformed_call,
    plain_name,
    read_arguments,
)

_CallParser = Callable[[str, Signatures], list[WrittenCall]]


@dataclass(frozen=True, slots=True)
class FoundCalls:
    """The calls found in the text of a reply.

    Attributes:
        rest: The text without the calls.
        notation: Name of the notation in which the calls are written; empty if there are no calls.
    """

    calls: tuple[WrittenCall, ...]
    rest: str
    notation: str


def find_calls(text: str, tools: Signatures, *, tagged_only: bool = False) -> FoundCalls:
    """Return the calls in the text of a reply, in order.

    Args:
        text: The text of a reply.
        tools: The offered tools.
        tagged_only: Whether to ignore notations without tags.

    Returns:
        The calls in the first notation of ``_TAGGED_NOTATIONS`` that occurs in the text, otherwise the calls without tags.
    """
    text = encodable(text)
    for notation, pattern, parse in _TAGGED_NOTATIONS:
        parsed = [(match, parse(match["body"], tools)) for match in pattern.finditer(text)]
        if any(calls for _, calls in parsed):
            return FoundCalls(tuple(call for _, calls in parsed for call in calls), pattern.sub("", text).strip(), notation)
    return FoundCalls((), text.strip(), "") if tagged_only else _find_untagged(text, tools)


def _json_or_xml_calls(body: str, tools: Signatures) -> list[WrittenCall]:
    """Parse the contents of a ``<tool_call>`` element: JSON (Hermes), XML functions (Qwen3-Coder), or XML keys and values (GLM)."""
    if "<function" in body:
        return _xml_calls(body, tools)
    if "<arg_key>" in body:
        return [_call_from_keys(body, tools)]
    name = body.strip()
    return [WrittenCall(name, {})] if name in tools else _json_calls(body, tools) or [malformed_call(body)]


def _json_calls(body: str, tools: Signatures) -> list[WrittenCall]:  # noqa: ARG001 - all parsers share one signature
    """Parse a sequence of JSON objects or lists of JSON objects. A value that cannot be parsed becomes a malformed call."""
    calls: list[WrittenCall] = []
    for chunk in _json_chunks(body):
        try:
            value = strict_json(chunk)
        except ValueError:
            calls.append(malformed_call(chunk))
            continue
        for item in value if isinstance(value, list) else [value]:
            calls.append(call_from_object(item) or malformed_call(chunk))
    return calls


def _json_chunks(body: str) -> list[str]:
    """Split text into JSON values. An incomplete value at the end becomes the last item."""
    decoder, chunks, position = JSONDecoder(), [], 0
    while position < len(body):
        if body[position].isspace() or body[position] in ",;":
            position += 1
            continue
        try:
            _, end = decoder.raw_decode(body, position)
        except (ValueError, RecursionError):
            chunks.append(body[position:])
            break
        chunks.append(body[position:end])
        position = end
    return chunks


_FUNCTION = re.compile(
    r"<function(?:=|\s+name=[\"']?)(?P<name>[^>\"'\s]+)[\"']?\s*>(?P<body>.*?)(?:</function>|(?=<function)|\Z)", re.DOTALL
)
_PARAMETER = re.compile(
    r"<parameter(?:=|\s+name=[\"']?)(?P<key>[^>\"'\s]+)[\"']?\s*>(?P<value>.*?)(?:</parameter>|(?=<parameter)|\Z)", re.DOTALL
)
_KEY_AND_VALUE = re.compile(
    r"<arg_key>(?P<key>[^<]{1,100})</arg_key>\s*<arg_value>(?P<value>.*?)(?:</arg_value>|(?=<arg_key>)|\Z)", re.DOTALL
)


def _xml_calls(body: str, tools: Signatures) -> list[WrittenCall]:
    calls = []
    for match in _FUNCTION.finditer(body):
        name, inside = plain_name(match["name"]), match["body"].strip()
        if inside.startswith("{"):
            arguments, malformed = read_arguments(inside)
            calls.append(WrittenCall(name, arguments, malformed))
            continue
        arguments = {m["key"]: tools.value(name, m["key"], _unwrap(m["value"])) for m in _PARAMETER.finditer(inside)}
        unparsed = _PARAMETER.sub("", inside).strip()
        calls.append(WrittenCall(name, {}, inside[:MAX_QUOTED_CHARS]) if unparsed else WrittenCall(name, arguments))
    return calls or [malformed_call(body)]


def _unwrap(value: str) -> str:
    """Remove the line breaks that the notation puts around a value."""
    return value.removeprefix("\n").removesuffix("\n")


def _call_from_keys(body: str, tools: Signatures) -> WrittenCall:
    name = plain_name(body.partition("<arg_key>")[0])
    return WrittenCall(
        name, {m["key"].strip(): tools.value(name, m["key"].strip(), m["value"]) for m in _KEY_AND_VALUE.finditer(body)}
    )


_MAX_PYTHON_CHARS = 20_000  # longer texts are not parsed as Python


def _python_calls(body: str, tools: Signatures) -> list[WrittenCall]:
    """Parse Python calls with literal keyword arguments: ``[adjust_ptz(pan_deg=20), go_home()]``."""
    if body.strip().startswith(("{", "[{")):
        return _json_calls(body, tools)
    if len(body) > _MAX_PYTHON_CHARS:
        return [malformed_call(body)]
    try:
        tree = ast.parse(body.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return [malformed_call(body)]
    nodes = tree.elts if isinstance(tree, ast.List | ast.Tuple) else [tree]
    return [_python_call(node) or malformed_call(body) for node in nodes]


def _python_call(node: ast.expr) -> WrittenCall | None:
    if not isinstance(node, ast.Call):
        return None
    name = plain_name(ast.unparse(node.func))
    try:
        arguments = {keyword.arg: ast.literal_eval(keyword.value) for keyword in node.keywords if keyword.arg}
    except (ValueError, RecursionError):
        return WrittenCall(name, {}, ast.unparse(node)[:MAX_QUOTED_CHARS])
    only_literals = all(
        isinstance(v, str | int | bool | None) or (isinstance(v, float) and math.isfinite(v)) for v in arguments.values()
    )
    if node.args or len(arguments) != len(node.keywords) or not only_literals:
        return WrittenCall(name, {}, ast.unparse(node)[:MAX_QUOTED_CHARS])
    return WrittenCall(name, arguments)


def _mistral_calls(body: str, tools: Signatures) -> list[WrittenCall]:
    """Parse ``[{"name": ..., "arguments": ...}]``, or a name, optionally ``[ARGS]``, and its arguments."""
    if body.strip().startswith("["):
        return _json_calls(body, tools)
    name, brace, tail = body.replace("[ARGS]", "").partition("{")
    arguments, malformed = read_arguments(brace + tail)
    return [WrittenCall(plain_name(name.partition("[CALL_ID]")[0]), arguments, malformed)]


def _between(opening: str, closing: str) -> re.Pattern[str]:
    """Return a pattern for the text between two tags. The closing tag may be missing before the next call or at the end."""
    return re.compile(f"{opening}(?P<body>.*?)(?:{closing}|(?={opening})|\\Z)", re.DOTALL)


_TAGGED_NOTATIONS: tuple[tuple[str, re.Pattern[str], _CallParser], ...] = (
    ("tool_call", _between("<tool_call>", "</tool_call>"), _json_or_xml_calls),
    ("function", re.compile(r"(?P<body><function(?:=|\s+name=).*?(?:</function>|\Z))", re.DOTALL), _xml_calls),
    ("tools", _between("<tools>", "</tools>"), _json_calls),
    ("function_call", _between("<function_call>", "</function_call>"), _json_calls),
    ("lfm", _between(r"<\|tool_call_start\|>", r"<\|tool_call_end\|>"), _python_calls),
    ("phi", _between(r"<\|tool_call\|>", r"<\|/tool_call\|>"), _json_calls),
    ("mistral", _between(r"\[TOOL_CALLS\]", r"(?=\[TOOL_CALLS\])"), _mistral_calls),
    ("llama", _between(r"<\|python_tag\|>", r"<\|eom_id\|>|<\|eot_id\|>"), _json_calls),
)
_MAX_START_LINES = 20
"""Maximum number of lines with an opening bracket to try as the start of calls. A text with more such lines is a table or code."""
_FENCE = re.compile(r"```[\w-]*[ \t]*\n(?P<body>.*?)(?:\n[ \t]*```|\Z)", re.DOTALL)


def _find_untagged(text: str, tools: Signatures) -> FoundCalls:
    """Return JSON or Python calls in code fences, or in text that consists of calls, possibly after prose."""
    fences = [(m, _calls_to_tools(m["body"], tools)) for m in _FENCE.finditer(text)]
    if any(calls for _, calls in fences):
        rest = text
        for match, calls in fences:
            rest = rest.replace(match[0], "") if calls else rest
        return FoundCalls(tuple(call for _, calls in fences for call in calls), rest.strip(), "fence")
    if calls := _calls_to_tools(text, tools):
        return FoundCalls(tuple(calls), "", "bare")
    # Try prose that is followed only by calls.
    for match in islice(re.finditer(r"^[ \t]*[\[{]", text, re.MULTILINE), _MAX_START_LINES):
        if calls := _calls_to_tools(text[match.start() :], tools):
            return FoundCalls(tuple(calls), text[: match.start()].strip(), "bare")
    return FoundCalls((), text.strip(), "")


def _calls_to_tools(body: str, tools: Signatures) -> list[WrittenCall]:
    """Parse text that consists only of calls to offered tools. Return an empty list for any other text."""
    body = body.strip()
    calls: list[WrittenCall] = []
    if body.startswith(("{", "[{")):
        calls = _json_calls(body, tools)
    elif re.match(r"\[?\s*[a-z_]+\(", body) and body.endswith((")", "]")):
        calls = _python_calls(body, tools)
    return calls if calls and all(call.name in tools for call in calls) else []
