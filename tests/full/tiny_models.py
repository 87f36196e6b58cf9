"""Train tiny checkpoints for tests: planners and a judge, overfitted to a few lessons.

The code that loads and serves real checkpoints loads and serves these. Only their size differs.
"""

from __future__ import annotations

import random
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from tokenizers import Tokenizer, decoders, models, pre_tokenizers, trainers
from transformers import PreTrainedTokenizerFast, Qwen3Config, Qwen3ForCausalLM

# The template of a real model contains whole prompts and schemas. This one truncates them, because long prompts are slow.
MARKS = ["<|endoftext|>", "<|im_start|>", "<|im_end|>"]
CHAT_TEMPLATE = """
{%- for message in messages -%}
{%- if message.role == 'system' -%}
<|im_start|>system
{{ message.content[:200] }}
Tools:{% for tool in tools or [] %} {{ tool.function.name }}{% endfor %}<|im_end|>
{% elif message.role == 'tool' -%}
<|im_start|>user
<tool_response>{{ message.content[:300] }}</tool_response><|im_end|>
{% else -%}
<|im_start|>{{ message.role }}
{{ message.content or '' }}
{%- for call in message.tool_calls or [] -%}
<tool_call>{"name": "{{ call.function.name }}", "arguments": {{ call.function.arguments | tojson }}}</tool_call>
{%- endfor -%}
<|im_end|>
{% endif -%}
{%- endfor -%}
{%- if add_generation_prompt -%}
<|im_start|>assistant
{% endif -%}
""".strip()
# For lessons that differ only in the beginning of their instructions.
BRIEF_TEMPLATE = """
{%- for message in messages if message.role != 'system' -%}
{%- if message.role == 'tool' -%}
<|im_start|>user
<tool_response>{{ message.content[:20] }}</tool_response><|im_end|>
{% else -%}
<|im_start|>{{ message.role }}
{{ (message.content or '')[:48] }}
{%- for call in message.tool_calls or [] -%}
<tool_call>{{ call.function.name }}</tool_call>
{%- endfor -%}
<|im_end|>
{% endif -%}
{%- endfor -%}
{%- if add_generation_prompt -%}
<|im_start|>assistant
{% endif -%}
""".strip()
# A judge's prompt begins with the category and ends with the agent's answer.
JUDGE_TEMPLATE = """
{%- for message in messages if message.role != 'system' -%}
<|im_start|>{{ message.role }}
{{ message.content[:40] }} ... {{ message.content[-80:] }}<|im_end|>
{% endfor -%}
{%- if add_generation_prompt -%}
<|im_start|>assistant
{% endif -%}
""".strip()


_MAX_STEPS, _STABLE_STEPS, _MAX_LOSS = 600, 4, 0.02
"""Training ends after ``_STABLE_STEPS`` consecutive steps in which every lesson's loss is below ``_MAX_LOSS``."""


_BATCH_SIZE = 16
"""Number of lessons in a batch. The lessons of a batch have similar lengths."""


_ALTERED_SHARE = 0.15
"""Share of the letters of a tool result that are replaced, when not all of them are."""
_IGNORED_LABEL = -100


@dataclass(frozen=True)
class Lesson:
    """A request in the wire format, and the reply to train."""

    messages: Sequence[dict[str, Any]]
    tools: Sequence[dict[str, Any]]
    reply: str


def tiny_planner(folder: Path, lessons: Sequence[Lesson], seed: int = 0, template: str = CHAT_TEMPLATE) -> Path:
    """Train a small Qwen3 to answer each lesson's prompt with its reply, and save it in ``folder``."""
    return _train(folder, lessons, template, seed)


def tiny_judge(folder: Path, lessons: Sequence[Lesson], seed: int = 0) -> Path:
    """Train a small Qwen3 as a judge. Its template shows so little of a run that many runs are the same lesson."""
    return _train(folder, lessons, JUDGE_TEMPLATE, seed)


def _train(folder: Path, lessons: Sequence[Lesson], template: str, seed: int) -> Path:
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    rng = random.Random(seed)
    tokenizer = _tokenizer(lessons, template)
    replies = {_render_prompt(tokenizer, lesson): lesson.reply for lesson in lessons}
    rows = sorted(replies.items(), key=lambda row: len(row[0]) + len(row[1]))
    batches = [rows[start : start + _BATCH_SIZE] for start in range(0, len(rows), _BATCH_SIZE)]
    model = Qwen3ForCausalLM(
        Qwen3Config(
            vocab_size=len(tokenizer), hidden_size=128, intermediate_size=256, num_hidden_layers=2, num_attention_heads=4,
            num_key_value_heads=2, head_dim=32, max_position_embeddings=16_384, tie_word_embeddings=True,
            bos_token_id=None, eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id,
        )
    )  # fmt: skip
    model.generation_config.do_sample = False
    model.generation_config.max_new_tokens = 200
    optimiser = torch.optim.AdamW(model.parameters(), lr=3e-3, weight_decay=0.0)
    stable_steps = 0
    for step in range(_MAX_STEPS):
        max_loss = 0.0
        for batch in batches:
            prompts = [prompt if step % 2 else _augment(prompt, rng) for prompt, _ in batch]
            losses = _losses(model, tokenizer, prompts, [reply for _, reply in batch])
            (losses.sum() / len(rows)).backward()
            max_loss = max(max_loss, float(losses.detach().max()))
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        optimiser.zero_grad()
        stable_steps = stable_steps + 1 if max_loss < _MAX_LOSS else 0
        if stable_steps == _STABLE_STEPS:
            break
    else:
        raise AssertionError("the tiny model did not learn its lessons")
    model.eval()
    model.save_pretrained(folder)
    tokenizer.save_pretrained(folder)
    return folder


def _tokenizer(lessons: Sequence[Lesson], template: str) -> PreTrainedTokenizerFast:
    core = Tokenizer(models.BPE())
    core.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    core.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=1500, special_tokens=MARKS, initial_alphabet=pre_tokenizers.ByteLevel.alphabet(), show_progress=False
    )
    plain = _wrap_tokenizer(core, template)
    core.train_from_iterator([text for lesson in lessons for text in (_render_prompt(plain, lesson), lesson.reply)], trainer)
    return _wrap_tokenizer(core, template)


def _wrap_tokenizer(core: Tokenizer, template: str) -> PreTrainedTokenizerFast:
    tokenizer = PreTrainedTokenizerFast(tokenizer_object=core, eos_token=MARKS[2], pad_token=MARKS[0])
    tokenizer.chat_template = template
    return tokenizer


def _render_prompt(tokenizer: PreTrainedTokenizerFast, lesson: Lesson) -> str:
    text = tokenizer.apply_chat_template(
        list(lesson.messages), tools=list(lesson.tools) or None, add_generation_prompt=True, tokenize=False
    )
    assert isinstance(text, str)
    return text


def _augment(prompt: str, rng: random.Random) -> str:
    """Return a prompt with other digits, and with other letters in tool results, some of which are also truncated.

    The reply must not depend on poses, times or counts, nor on the words of a perception answer.
    """

    def alter(match: re.Match[str]) -> str:
        share = rng.choice((_ALTERED_SHARE, 1.0))
        text = match[0] if share < 1 else match[0][: rng.randint(0, len(match[0]))]
        return re.sub(r"[a-z]", lambda m: rng.choice("etaoinshr") if rng.random() < share else m[0], text)

    prompt = re.sub(r"(?<=<tool_response>).*?(?=</tool_response>)", alter, prompt, flags=re.DOTALL)
    return re.sub(r"\d", lambda _: rng.choice("0123456789"), prompt)


def _losses(
    model: Qwen3ForCausalLM, tokenizer: PreTrainedTokenizerFast, prompts: Sequence[str], replies: Sequence[str]
) -> torch.Tensor:
    """Return the mean cross-entropy of each reply, of shape ``(lessons,)``, from one batch that is padded at the end."""
    prompt_ids = [tokenizer(prompt, add_special_tokens=False)["input_ids"] for prompt in prompts]
    reply_ids = [[*tokenizer(reply, add_special_tokens=False)["input_ids"], tokenizer.eos_token_id] for reply in replies]
    longest = max(len(a) + len(b) for a, b in zip(prompt_ids, reply_ids, strict=True))
    ids = torch.full((len(prompt_ids), longest), tokenizer.pad_token_id)
    labels = torch.full((len(prompt_ids), longest), _IGNORED_LABEL)
    for row, (a, b) in enumerate(zip(prompt_ids, reply_ids, strict=True)):
        ids[row, : len(a) + len(b)] = torch.tensor(a + b)
        labels[row, len(a) : len(a) + len(b)] = torch.tensor(b)
    logits = model(input_ids=ids).logits[:, :-1].transpose(1, 2)
    token_losses = torch.nn.functional.cross_entropy(logits, labels[:, 1:], ignore_index=_IGNORED_LABEL, reduction="none")
    return token_losses.sum(1) / (labels[:, 1:] != _IGNORED_LABEL).sum(1)
