"""Tiny vision checkpoints: detectors with random weights, and a vision model that is trained to recognise one type of object.

The code that loads real checkpoints, in process and in servers, loads these. Only their size differs.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import torch
from PIL import Image as PillowImage
from tokenizers import Tokenizer, decoders, models, pre_tokenizers, trainers
from transformers import (
    BertConfig,
    BertTokenizer,
    CLIPTokenizer,
    CLIPVisionConfig,
    GroundingDinoConfig,
    GroundingDinoForObjectDetection,
    GroundingDinoProcessor,
    LlavaConfig,
    LlavaForConditionalGeneration,
    LlavaProcessor,
    Owlv2Config,
    Owlv2ForObjectDetection,
    Owlv2Processor,
    PreTrainedTokenizerFast,
    Qwen2Config,
    SwinConfig,
)
from transformers.models.clip.image_processing_pil_clip import CLIPImageProcessorPil
from transformers.models.grounding_dino.image_processing_pil_grounding_dino import GroundingDinoImageProcessorPil
from transformers.models.owlv2.image_processing_pil_owlv2 import Owlv2ImageProcessorPil

from tests.full.vision import square

SIDE, PATCH = 56, 14
MARKS = ["<|endoftext|>", "<|im_start|>", "<|im_end|>", "<image>"]
# The template of a real model contains whole prompts. This one truncates them, because long prompts are slow.
CHAT_TEMPLATE = """
{%- for message in messages -%}
<|im_start|>{{ message.role }}
{% if message.content is string %}{{ message.content }}{% else %}
{%- for part in message.content %}{% if part.type == 'text' %}{{ part.text[:40] }}{% else %}<image>{% endif %}{% endfor %}
{%- endif %}<|im_end|>
{% endfor -%}
{%- if add_generation_prompt -%}
<|im_start|>assistant
{% endif -%}
""".strip()


def tiny_vision_chat(folder: Path, lessons: Sequence[tuple[str, dict[str, str]]], seed: int = 0) -> Path:
    """Train a small LLaVA, and save it. ``lessons`` are pairs of a prompt and its replies by the corner of the square."""
    torch.manual_seed(seed)
    torch.set_num_threads(1)
    processor = _processor([text for prompt, replies in lessons for text in (prompt, *replies.values())])
    tokenizer = processor.tokenizer
    vision = CLIPVisionConfig(
        hidden_size=64, intermediate_size=128, num_hidden_layers=2, num_attention_heads=4, image_size=SIDE, patch_size=PATCH
    )
    text = Qwen2Config(
        vocab_size=len(tokenizer), hidden_size=96, intermediate_size=192, num_hidden_layers=2, num_attention_heads=4,
        num_key_value_heads=2, max_position_embeddings=2048, tie_word_embeddings=True,
        bos_token_id=None, eos_token_id=tokenizer.eos_token_id, pad_token_id=tokenizer.pad_token_id,
    )  # fmt: skip
    mark = tokenizer.convert_tokens_to_ids("<image>")
    model = LlavaForConditionalGeneration(LlavaConfig(vision_config=vision, text_config=text, image_token_index=mark))
    model.generation_config.do_sample = False
    batches = [_batch(processor, prompt, replies) for prompt, replies in lessons]
    optimiser = torch.optim.AdamW(model.parameters(), lr=2e-3, weight_decay=0.0)
    for step in range(400):
        losses = [_loss(model, batch) for batch in batches]
        torch.stack(losses).mean().backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        optimiser.zero_grad()
        if step > 20 and max(float(loss.detach()) for loss in losses) < 0.004:
            break
    else:
        raise AssertionError("the tiny vision model did not learn its lessons")
    model.eval()
    model.save_pretrained(folder)
    processor.save_pretrained(folder)
    return folder


def _processor(texts: Sequence[str]) -> LlavaProcessor:
    core = Tokenizer(models.BPE())
    core.pre_tokenizer = pre_tokenizers.ByteLevel(add_prefix_space=False)
    core.decoder = decoders.ByteLevel()
    trainer = trainers.BpeTrainer(
        vocab_size=1500, special_tokens=MARKS, initial_alphabet=pre_tokenizers.ByteLevel.alphabet(), show_progress=False
    )
    core.train_from_iterator(texts, trainer)
    tokenizer = PreTrainedTokenizerFast(tokenizer_object=core, eos_token="<|im_end|>", pad_token="<|endoftext|>")
    tokenizer.chat_template = CHAT_TEMPLATE
    size = {"height": SIDE, "width": SIDE}
    images = CLIPImageProcessorPil(size=size, crop_size=size, do_center_crop=False)
    return LlavaProcessor(
        image_processor=images, tokenizer=tokenizer, patch_size=PATCH, vision_feature_select_strategy="default",
        image_token="<image>",
        num_additional_image_tokens=1, chat_template=CHAT_TEMPLATE,
    )  # fmt: skip


def _batch(processor: LlavaProcessor, prompt: str, replies: dict[str, str]) -> dict[str, torch.Tensor]:
    """Return a batch of one prompt with all corners. Replies are padded, and only their tokens are trained."""
    tokenizer: Any = processor.tokenizer
    content = [{"type": "image"}, {"type": "text", "text": prompt}]
    prompt_text = processor.apply_chat_template([{"role": "user", "content": content}], add_generation_prompt=True, tokenize=False)
    images = [PillowImage.fromarray(square(corner)) for corner in replies]
    head = processor(images=images, text=[prompt_text] * len(images), return_tensors="pt")
    reply_ids = [[*tokenizer(reply, add_special_tokens=False)["input_ids"], tokenizer.eos_token_id] for reply in replies.values()]
    longest = max(map(len, reply_ids))
    tail = torch.tensor([ids + [tokenizer.pad_token_id] * (longest - len(ids)) for ids in reply_ids])
    labels = torch.tensor([ids + [-100] * (longest - len(ids)) for ids in reply_ids])
    return {"input_ids": torch.cat([head["input_ids"], tail], dim=1), "pixel_values": head["pixel_values"], "labels": labels}


def _loss(model: LlavaForConditionalGeneration, batch: dict[str, torch.Tensor]) -> torch.Tensor:
    labels = batch["labels"]
    output = model(input_ids=batch["input_ids"], pixel_values=batch["pixel_values"], logits_to_keep=labels.shape[1] + 1)
    logits = output.logits[:, :-1]
    return torch.nn.functional.cross_entropy(logits.reshape(-1, logits.shape[-1]), labels.reshape(-1), ignore_index=-100)


def tiny_owlv2(folder: Path, seed: int = 0) -> Path:
    """Save an OWLv2 with random weights. A text must not begin with token 0, which the model treats as padding."""
    torch.manual_seed(seed)
    words = ["!", "<|startoftext|>", "<|endoftext|>", *[c + end for c in "abcdefghijklmnopqrstuvwxyz" for end in ("", "</w>")]]
    vocabulary = {word: number for number, word in enumerate(words)}
    tokenizer = CLIPTokenizer(vocab=vocabulary, merges=[], pad_token="!", model_max_length=16)
    config = Owlv2Config(
        text_config={"vocab_size": len(words), "hidden_size": 32, "intermediate_size": 64, "num_hidden_layers": 1,
                     "num_attention_heads": 2, "max_position_embeddings": 16,
                     "bos_token_id": 1, "eos_token_id": 2, "pad_token_id": 0},
        vision_config={"hidden_size": 32, "intermediate_size": 64, "num_hidden_layers": 1, "num_attention_heads": 2,
                       "image_size": 96, "patch_size": 16},
        projection_dim=32,
    )  # fmt: skip
    Owlv2ForObjectDetection(config).eval().save_pretrained(folder)
    images = Owlv2ImageProcessorPil(size={"height": 96, "width": 96})
    Owlv2Processor(image_processor=images, tokenizer=tokenizer).save_pretrained(folder)
    return folder


def tiny_grounding_dino(folder: Path, seed: int = 0) -> Path:
    """Save a Grounding DINO with random weights."""
    torch.manual_seed(seed)
    words = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", ".", "?", "!", "a", "cone", "square", "traffic", "orange"]
    tokenizer = BertTokenizer(vocab={word: number for number, word in enumerate(words)}, model_max_length=64)
    config = GroundingDinoConfig(
        backbone_config=SwinConfig(
            image_size=64, patch_size=4, embed_dim=16, depths=[1, 1, 1, 1], num_heads=[1, 2, 2, 4], window_size=4,
            out_features=["stage2", "stage3", "stage4"],
        ),
        text_config=BertConfig(
            vocab_size=len(words), hidden_size=32, intermediate_size=64, num_hidden_layers=1, num_attention_heads=2,
            max_position_embeddings=64,
        ),
        d_model=32, encoder_layers=1, decoder_layers=2, encoder_attention_heads=2, decoder_attention_heads=2,
        encoder_ffn_dim=64, decoder_ffn_dim=64, num_queries=20, max_text_len=64,
    )  # fmt: skip
    GroundingDinoForObjectDetection(config).eval().save_pretrained(folder)
    images = GroundingDinoImageProcessorPil(size={"shortest_edge": 64, "longest_edge": 128})
    GroundingDinoProcessor(image_processor=images, tokenizer=tokenizer).save_pretrained(folder)
    return folder
