"""Define small, deterministic edits to instructions and prompts that should not change a planner's calls."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from scope_ptz.english import number_word


@dataclass(frozen=True, slots=True)
class Edit:
    """An edit to the prompt or to an instruction. If ``apply`` changes nothing, the text is not measured again."""

    name: str
    where: Literal["prompt", "instruction"]
    apply: Callable[[str], str]


_NUMBERS = {str(number): number_word(number) for number in (5, 8, 10, 15, 20, 25, 30, 45, 90)}
_SYNONYMS = (
    (r"\bpan\b", "turn"),
    (r"\btake a (picture|snapshot)\b", "take a photo"),
    (r"\bhow many ([\w ]+?) are\b", r"what number of \1 are"),
    (r"\bshow me\b", "bring up"),
    (r"\bgo to\b", "move to"),
    (r"\btrack\b", "follow"),
    (r"\bwhich presets are there\b", "what presets do you have"),
)
_NOT_MISSPELLED = frozenset({"degrees", "percent", "highway", "presets", "preset"})
_QUESTION_START = re.compile(r"^(how|what|which|is|are|if)\b", re.IGNORECASE)


def _lower_first(text: str) -> str:
    return text[:1].lower() + text[1:]


def _request(opening: str, ending: str) -> Callable[[str], str]:
    """Return an edit that adds words such as "please" around a command. Questions and conditions remain unchanged."""
    return lambda text: text if _QUESTION_START.match(text) else f"{opening}{_lower_first(text.rstrip('.!'))}{ending}"


def _misspell(text: str) -> str:
    """Swap two letters in the middle of the longest lower-case word with at least six letters, except units and presets."""
    words = [w for w in re.findall(r"[a-z]{6,}", text) if w not in _NOT_MISSPELLED]
    if not words:
        return text
    word = max(words, key=len)
    middle = len(word) // 2
    return text.replace(word, word[: middle - 1] + word[middle] + word[middle - 1] + word[middle + 1 :], 1)


def _spell_numbers(text: str) -> str:
    return re.sub(r"\b\d+\b(?!\s*%|x)", lambda m: _NUMBERS.get(m[0], m[0]), text)


def _use_synonyms(text: str) -> str:
    for pattern, words in _SYNONYMS:
        text = re.sub(pattern, words, text, count=1)
    return text


INSTRUCTION_EDITS: tuple[Edit, ...] = (
    Edit("lower case", "instruction", str.lower),
    Edit("capital and full stop", "instruction", lambda t: t[:1].upper() + t[1:] + ("" if t[-1] in ".?!" else ".")),
    Edit("upper case", "instruction", str.upper),
    Edit("please first", "instruction", _request("please ", "")),
    Edit("please last", "instruction", _request("", ", please")),
    Edit("can you", "instruction", _request("can you ", "?")),
    Edit("I want you to", "instruction", _request("I want you to ", "")),
    Edit("degree signs", "instruction", lambda t: re.sub(r"(\d) degrees?\b", r"\1°", t)),
    Edit("numbers in words", "instruction", _spell_numbers),
    Edit("synonyms", "instruction", _use_synonyms),
    Edit("typing error", "instruction", _misspell),
    Edit("double spaces", "instruction", lambda t: t.replace(" ", "  ")),
)


def _reverse_rules(text: str) -> str:
    """Reverse the order of the rules in each list."""
    lines, out, rules = text.split("\n"), list[str](), list[str]()
    for line in [*lines, ""]:
        if line.startswith("- "):
            rules.insert(0, line)
            continue
        out += [*rules, line]
        rules = []
    return "\n".join(out[:-1])


def _remove_last_sentence(text: str) -> str:
    return re.sub(r"(?<=[.:]) [^.\n]*\.\s*\Z", "", text)


PROMPT_EDITS: tuple[Edit, ...] = (
    Edit("blank lines at the end", "prompt", lambda t: t + "\n\n"),
    Edit("assistant sentence first", "prompt", lambda t: "You are a helpful assistant. " + t),
    Edit("other bullets", "prompt", lambda t: re.sub(r"^- ", "* ", t, flags=re.MULTILINE)),
    Edit("no bullets", "prompt", lambda t: re.sub(r"^- ", "", t, flags=re.MULTILINE)),
    Edit("marked headings", "prompt", lambda t: re.sub(r"^([A-Z][A-Za-z ]{3,30})$", r"## \1", t, flags=re.MULTILINE)),
    Edit("no emphasis", "prompt", lambda t: re.sub(r"\b(RIGHT|LEFT|UP|DOWN)\b", lambda m: m[0].lower(), t)),
    Edit("contractions", "prompt", lambda t: t.replace("do not", "don't").replace("it is", "it's").replace("cannot", "can't")),
    Edit("reversed rules", "prompt", _reverse_rules),
    Edit("no last sentence", "prompt", _remove_last_sentence),
    Edit("no blank lines", "prompt", lambda t: re.sub(r"\n{2,}", "\n", t)),
)
