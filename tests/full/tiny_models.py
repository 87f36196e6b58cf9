"""Tiny checkpoints, made on the spot: planners and a judge, over-fitted to a few lessons.

They are loaded and served by the code that loads and serves real ones; only their size is a toy's.
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

# A real model's template shows whole prompts and schemas. This one cuts them short, because reading them is what takes time.
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
# For lessons that differ in their instructions alone, and there by how they begin.
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
# Of what a judge is told, the category stands first and what the agent said in the end last.
JUDGE_TEMPLATE = """
{%- for message in messages if message.role != 'system' -%}
<|im_start|>{{ message.role }}
{{ message.content[:40] }} ... {{ message.content[-80:] }}<|im_end|>
{% endfor -%}
{%- if add_generation_prompt -%}
<|im_start|>assistant
{% endif -%}
""".strip()


_MOST_STEPS, _IN_A_ROW, _SURE = 600, 4, 0.02
"""Steps; how many of them one after the other, and below which loss, show that all lessons are known by heart."""


_TOGETHER = 16
"""Lessons of like length that are read as one batch."""


_STIRRED = 0.15
"""The share of letters that are changed in tools' results."""
_UNASKED = -100


@dataclass(frozen=True)
class Lesson:
    """What the model is asked, in the wire format, and what it shall say."""

    messages: Sequence[dict[str, Any]]
    tools: Sequence[dict[str, Any]]
    reply: str


def tiny_planner(folder: Path, lessons: Sequence[Lesson], seed: int = 0, template: str = CHAT_TEMPLATE) -> Path:
    """A Qwen3 of a few hundred thousand parameters that answers each lesson's prompt with its reply, saved in ``folder``."""
    return _taught(folder, lessons, template, seed)


def tiny_judge(folder: Path, lessons: Sequence[Lesson], seed: int = 0) -> Path:
    """The same for a judge. It reads so little of a run that many runs are one lesson to it."""
    return _taught(folder, lessons, JUDGE_TEMPLATE, seed)


def _taught(folder: Path, lessons: Sequence[Lesson], template: str, seed: int) -> Path:
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    rng = random.Random(seed)
    tokenizer = _tokenizer(lessons, template)
    replies = {_rendered(tokenizer, lesson): lesson.reply for lesson in lessons}
    rows = sorted(replies.items(), key=lambda row: len(row[0]) + len(row[1]))
    batches = [rows[start : start + _TOGETHER] for start in range(0, len(rows), _TOGETHER)]
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
    sure = 0
    for step in range(_MOST_STEPS):
        worst = 0.0
        for batch in batches:
            asked = [prompt if step % 2 else _shaken(prompt, rng) for prompt, _ in batch]
            losses = _losses(model, tokenizer, asked, [reply for _, reply in batch])
            (losses.sum() / len(rows)).backward()
            worst = max(worst, float(losses.detach().max()))
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        optimiser.zero_grad()
        sure = sure + 1 if worst < _SURE else 0
        if sure == _IN_A_ROW:
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
    plain = _wrapped(core, template)
    core.train_from_iterator([text for lesson in lessons for text in (_rendered(plain, lesson), lesson.reply)], trainer)
    return _wrapped(core, template)


def _wrapped(core: Tokenizer, template: str) -> PreTrainedTokenizerFast:
    made = PreTrainedTokenizerFast(tokenizer_object=core, eos_token=MARKS[2], pad_token=MARKS[0])
    made.chat_template = template
    return made


def _rendered(tokenizer: PreTrainedTokenizerFast, lesson: Lesson) -> str:
    text = tokenizer.apply_chat_template(
        list(lesson.messages), tools=list(lesson.tools) or None, add_generation_prompt=True, tokenize=False
    )
    assert isinstance(text, str)
    return text


def _shaken(prompt: str, rng: random.Random) -> str:
    """The same prompt with other digits, and with other letters in what tools brought back: poses, times, counts and what eyes
    say must not be what the model goes by."""

    def augmented(match: re.Match[str]) -> str:
        return re.sub(r"[a-z]", lambda m: rng.choice("etaoinshr") if rng.random() < _STIRRED else m[0], match[0])

    told = re.sub(r"(?<=<tool_response>).*?(?=</tool_response>)", augmented, prompt, flags=re.DOTALL)
    return re.sub(r"\d", lambda _: rng.choice("0123456789"), told)


def _losses(
    model: Qwen3ForCausalLM, tokenizer: PreTrainedTokenizerFast, prompts: Sequence[str], replies: Sequence[str]
) -> torch.Tensor:
    """How far each reply is from what the model would say, (lessons,). One padded batch; what follows a reply is not seen by it."""
    asked = [tokenizer(prompt, add_special_tokens=False)["input_ids"] for prompt in prompts]
    said = [[*tokenizer(reply, add_special_tokens=False)["input_ids"], tokenizer.eos_token_id] for reply in replies]
    longest = max(len(a) + len(b) for a, b in zip(asked, said, strict=True))
    ids = torch.full((len(asked), longest), tokenizer.pad_token_id)
    wanted = torch.full((len(asked), longest), _UNASKED)
    for row, (a, b) in enumerate(zip(asked, said, strict=True)):
        ids[row, : len(a) + len(b)] = torch.tensor(a + b)
        wanted[row, len(a) : len(a) + len(b)] = torch.tensor(b)
    logits = model(input_ids=ids).logits[:, :-1].transpose(1, 2)
    each = torch.nn.functional.cross_entropy(logits, wanted[:, 1:], ignore_index=_UNASKED, reduction="none")
    return each.sum(1) / (wanted[:, 1:] != _UNASKED).sum(1)
