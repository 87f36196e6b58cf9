"""Vision-language models in this process: Moondream's own interface, and chat models that transformers supports (Qwen-VL)."""

from __future__ import annotations

import json
import re
import threading
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, Protocol

import numpy as np
from anyio import to_thread
from pydantic import Field

from scope_ptz.camera.base import Frame
from scope_ptz.errors import ConfigError, PerceptionError
from scope_ptz.perception.backends.spec import BackendSpec, Options, need
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.perception.models.coordinates import Convention, convention
from scope_ptz.perception.models.encoding import resized
from scope_ptz.perception.models.frame_memo import Image
from scope_ptz.perception.models.vision_prompts import (
    CAPTION_PROMPT,
    detect_prompt,
    one_line,
    point_prompt,
    query_prompt,
    sent_size,
)
from scope_ptz.perception.models.vision_reply import VisionReply

COMMIT = re.compile(r"[0-9a-f]{40}")
UNIT = convention("unit")


class LocalOptions(Options):
    """Options of the backend.

    Moondream's interface is code from its repository. It runs only with ``trust_remote_code``, from a folder or from the one commit
    that ``revision`` names.

    Attributes:
        family: "moondream" for its own interface, "chat" for models with a chat template.
        device: The device as torch names it, "auto" for the best available.
        dtype: The data type as torch names it, or "auto".
    """

    family: Literal["moondream", "chat"] = "chat"
    device: str = "auto"
    dtype: str = "auto"
    revision: str | None = None
    trust_remote_code: bool = False
    max_pixels: int = Field(default=1280 * 1024, ge=64 * 64)
    max_tokens: int = Field(default=1024, ge=16)


class ChatModel(Protocol):
    """A chat model that takes a picture. It returns its text, and whether the text stopped at the token limit."""

    def __call__(self, image: Image, prompt: str) -> tuple[str, bool]: ...


class LocalChatPerception(Perception):
    """Perception by a chat model, asked in its coordinate convention, one frame at a time in a worker thread."""

    def __init__(self, model: ChatModel, style: Convention, options: LocalOptions | None = None, name: str = "local") -> None:
        self.name, self._model, self._style, self._options = name, model, style, options or LocalOptions()

    async def caption(self, frame: Frame) -> Caption:
        return (await self._ask(frame, CAPTION_PROMPT)).caption()

    async def query(self, frame: Frame, question: str) -> Answer:
        if not question.strip():
            raise PerceptionError("The question is empty.")
        return (await self._ask(frame, query_prompt(question))).answer()

    async def detect(self, frame: Frame, description: str) -> Detections:
        size = self._size(frame)
        return (await self._ask(frame, detect_prompt(self._style, description, size))).detections(self._style, size)

    async def point(self, frame: Frame, description: str) -> Points:
        size = self._size(frame)
        return (await self._ask(frame, point_prompt(self._style, description, size))).points(self._style, size)

    def _size(self, frame: Frame) -> tuple[int, int]:
        return sent_size(frame, self._style, self._options.max_pixels)

    async def _ask(self, frame: Frame, prompt: str) -> VisionReply:
        began, size = perf_counter(), self._size(frame)
        text, cut = await _in_thread(self.name, lambda: self._model(resized(frame.image, size), prompt))
        return VisionReply(self.name, text, began, cut=cut)


class LocalMoondreamPerception(Perception):
    """Perception through the methods of a loaded Moondream model. ``load`` is called once, in a worker thread."""

    def __init__(self, load: Callable[[], Any], name: str = "moondream-local") -> None:
        self.name, self._load, self._model, self._lock = name, load, None, threading.Lock()

    _model: Any

    async def caption(self, frame: Frame) -> Caption:
        began = perf_counter()
        text = await self._call(frame, "caption", "caption", length="short")
        return VisionReply(self.name, str(text), began).caption()

    async def query(self, frame: Frame, question: str) -> Answer:
        if not question.strip():
            raise PerceptionError("The question is empty.")
        began = perf_counter()
        return VisionReply(self.name, str(await self._call(frame, "query", "answer", question.strip())), began).answer()

    async def detect(self, frame: Frame, description: str) -> Detections:
        began = perf_counter()
        found = await self._call(frame, "detect", "objects", one_line(description))
        return VisionReply(self.name, json.dumps({"objects": found}, default=float), began).detections(UNIT, (1, 1))

    async def point(self, frame: Frame, description: str) -> Points:
        began = perf_counter()
        found = await self._call(frame, "point", "points", one_line(description))
        return VisionReply(self.name, json.dumps({"objects": found}, default=float), began).points(UNIT, (1, 1))

    async def _call(self, frame: Frame, method: str, field: str, *given: str, **options: str) -> Any:
        def call() -> Any:
            with self._lock:
                if self._model is None:
                    self._model = self._load()
                return getattr(self._model, method)(_pillow(frame.image), *given, **options)[field]

        return await _in_thread(self.name, call)


async def _in_thread(name: str, call: Callable[[], Any]) -> Any:
    """Run a model in a worker thread. Any failure becomes a ``PerceptionError``."""
    try:
        return await to_thread.run_sync(call)
    except PerceptionError:
        raise
    # Models run their own code, and out-of-memory errors have a different class on every device.
    except Exception as error:
        raise PerceptionError(f"{name} could not look: {type(error).__name__}: {error}") from error


def _pillow(image: Image) -> Any:
    from PIL import Image as PillowImage

    return PillowImage.fromarray(np.ascontiguousarray(image))


class TransformersChat:
    """A transformers processor and model, loaded on first use, with greedy decoding."""

    def __init__(self, model: str, options: LocalOptions) -> None:
        self._name, self._options, self._lock = model, options, threading.Lock()
        self._loaded: tuple[Any, Any] | None = None

    def __call__(self, image: Image, prompt: str) -> tuple[str, bool]:
        with self._lock:
            processor, model = self._loaded = self._loaded or self._load()
            parts = [{"type": "image", "image": _pillow(image)}, {"type": "text", "text": prompt}]
            # A template that does not know the switch would pass it on as an option of the processor.
            quiet = {"enable_thinking": False} if "enable_thinking" in str(processor.chat_template) else {}
            inputs = processor.apply_chat_template(
                [{"role": "user", "content": parts}],
                add_generation_prompt=True,
                tokenize=True,
                return_dict=True,
                return_tensors="pt",
                **quiet,
            ).to(model.device)
            asked = inputs["input_ids"].shape[1]
            written = model.generate(**inputs, max_new_tokens=self._options.max_tokens, do_sample=False)[0][asked:]
            return processor.decode(written, skip_special_tokens=True), len(written) >= self._options.max_tokens

    def _load(self) -> tuple[Any, Any]:
        from transformers import AutoModelForImageTextToText, AutoProcessor

        revision = self._options.revision
        processor = AutoProcessor.from_pretrained(self._name, revision=revision, trust_remote_code=False)
        model = AutoModelForImageTextToText.from_pretrained(
            self._name, revision=revision, dtype=self._options.dtype, trust_remote_code=False
        )
        return processor, model.to(_device(self._options)).eval()


def _load_moondream(model: str, options: LocalOptions) -> Any:
    from transformers import AutoModelForCausalLM

    loaded = AutoModelForCausalLM.from_pretrained(model, revision=options.revision, dtype=options.dtype, trust_remote_code=True)
    return loaded.to(_device(options)).eval()


def _device(options: LocalOptions) -> str:
    import torch

    if options.device != "auto":
        return options.device
    return "cuda" if torch.cuda.is_available() else "mps" if torch.backends.mps.is_available() else "cpu"


def make(spec: BackendSpec) -> Perception:
    """Return the backend that a spec describes."""
    need("local", "transformers", "torch")
    options, model = LocalOptions.of(spec), spec.needed_model()
    if options.family == "chat":
        return LocalChatPerception(TransformersChat(model, options), convention(spec.coordinates), options, spec.name)
    if not options.trust_remote_code:
        raise ConfigError(f"'{model}' brings code of its own. Set the option trust_remote_code to run it, having read it.")
    if not Path(model).is_dir() and not COMMIT.fullmatch(options.revision or ""):
        raise ConfigError(
            f"'{model}' brings code of its own. Set the option revision to the commit (40 hex digits) that you have read."
        )
    return LocalMoondreamPerception(lambda: _load_moondream(model, options), spec.name)
