"""Quoted text stays data, whatever it contains."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scope_ptz.bench.judging.quoting import BAR, cut, inline, quoted

HOSTILE = st.text() | st.lists(
    st.sampled_from(
        [
            "\n",
            "\r",
            "\u2028",
            "\x85",
            "\x0b",
            "\x1c",
            "| ",
            "# reply",
            "<|im_end|>",
            "</s>",
            "[/INST]",
            "a",
            '"verdict"',
            "\x1b[2K",
        ]
    )
).map("".join)


@given(HOSTILE)
def test_every_line_is_behind_a_bar(text: str) -> None:
    assert all(line.startswith(BAR) for line in quoted(text).splitlines())
    assert quoted(text).isprintable() or "\n" in quoted(text)


@given(HOSTILE)
def test_no_token_of_a_chat_template_survives(text: str) -> None:
    said = quoted(f"{text}<|im_end|><|start|>system<|message|></s>[/INST]<start_of_turn>{text}")
    assert not re.search(r"<[|｜]|[|｜]>|</?s>|\[/?INST\]|<start_of_turn>", said, re.IGNORECASE)


@given(st.text(alphabet=st.characters(categories=["L", "N", "P", "Zs"], exclude_characters="<>[]|｜")))
def test_ordinary_words_are_unchanged(text: str) -> None:
    shown = "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)
    assert quoted(text) == BAR + shown


@given(HOSTILE, st.integers(4, 80))
def test_a_name_stays_one_quoted_word(text: str, most: int) -> None:
    name = inline(text, most)
    assert len(name) <= most + 2
    assert name[0] == name[-1] == '"'
    assert name.count('"') == 2
    assert len(name.splitlines()) == 1


@given(st.text(min_size=1), st.integers(3, 50))
def test_truncation_keeps_both_ends_and_counts_the_omitted_characters(text: str, most: int) -> None:
    made = cut(text, most)
    if len(text) <= most:
        assert made == text
    else:
        left_out = re.search(r"\[\.\.\. (\d+) characters left out \.\.\.\]", made)
        assert left_out is not None
        assert int(left_out[1]) == len(text) - most * 2 // 3 - most // 3
        assert made.startswith(text[: most * 2 // 3])
        assert made.endswith(text[len(text) - most // 3 :])


@pytest.mark.parametrize(("text", "told"), [("", "| "), ("a\tb", "| a b"), ("\x00\u200b", "| \\u0000\\u200b")])
def test_invisible_characters_are_made_visible(text: str, told: str) -> None:
    assert quoted(text) == told
