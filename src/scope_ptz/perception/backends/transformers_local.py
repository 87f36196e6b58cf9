"""Vision-language models that run in this process: Moondream, and chat models that transformers supports, such as Qwen-VL."""

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
from scope_ptz.perception.backends.spec import BackendSpec, Options, require_packages
from scope_ptz.perception.base import Answer, Caption, Detections, Perception, Points
from scope_ptz.perception.models.coordinates import Convention, get_convention
from scope_ptz.perception.models.encoding import resize
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

COMMIT_HASH = re.compile(r"[0-9a-f]{40}")
UNIT = get_convention("unit")


class LocalOptions(Options):
    """Options for local models.

    Moondream's interface is Python code in the model's repository. It runs only if ``trust_remote_code`` is set, and only from a
    local folder or from the commit that ``revision`` pins.

    Attributes:
        family: "moondream" for Moondream's own interface, "chat" for models with a chat template.
        device: The torch device, or "auto" for the best one available.
        dtype: The torch data type, or "auto".
        revision: The branch, tag or commit of the model's repository.
        trust_remote_code: Whether to run the code in the model's repository.
        max_pixels: Frames with more pixels are scaled down to this number.
        max_tokens: Maximum number of tokens in a reply.
    """

    family: Literal["moondream", "chat"] = "chat"
    device: str = "auto"
    dtype: str = "auto"
    revision: str | None = None
    trust_remote_code: bool = False
    max_pixels: int = Field(default=1280 * 1024, ge=64 * 64)
    max_tokens: int = Field(default=1024, ge=16)


class ChatModel(Protocol):
    """A chat model: a function that takes an image and a prompt, and returns the reply and whether it reached the token limit."""

    def __call__(self, image: Image, prompt: str) -> tuple[str, bool]: ...


class LocalChatPerception(Perception):
    """Perception by a local chat model, prompted in its coordinate convention. A worker thread processes one frame at a time."""

    def __init__(self, model: ChatModel, convention: Convention, options: LocalOptions | None = None, name: str = "local") -> None:
        self.name, self._model, self._convention, self._options = name, model, convention, options or LocalOptions()

    async def caption(self, frame: Frame) -> Caption:
        return (await self._ask(frame, CAPTION_PROMPT)).caption()

    async def query(self, frame: Frame, question: str) -> Answer:
        if not question.strip():
            raise PerceptionError("The question is empty.")
        return (await self._ask(frame, query_prompt(question))).answer()

    async def detect(self, frame: Frame, description: str) -> Detections:
        size = self._size(frame)
        return (await self._ask(frame, detect_prompt(self._convention, description, size))).detections(self._convention, size)

    async def point(self, frame: Frame, description: str) -> Points:
        size = self._size(frame)
        return (await self._ask(frame, point_prompt(self._convention, description, size))).points(self._convention, size)

    def _size(self, frame: Frame) -> tuple[int, int]:
        return sent_size(frame, self._convention, self._options.max_pixels)

    async def _ask(self, frame: Frame, prompt: str) -> VisionReply:
        began, size = perf_counter(), self._size(frame)
        text, truncated = await _run_in_thread(self.name, lambda: self._model(resize(frame.image, size), prompt))
        return VisionReply(self.name, text, began, truncated=truncated)


class LocalMoondreamPerception(Perception):
    """Perception through a loaded Moondream model's methods. ``load`` is called once, in a worker thread."""

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
        objects = await self._call(frame, "detect", "objects", one_line(description))
        return VisionReply(self.name, json.dumps({"objects": objects}, default=float), began).detections(UNIT, (1, 1))

    async def point(self, frame: Frame, description: str) -> Points:
        began = perf_counter()
        objects = await self._call(frame, "point", "points", one_line(description))
        return VisionReply(self.name, json.dumps({"objects": objects}, default=float), began).points(UNIT, (1, 1))

    async def _call(self, frame: Frame, method: str, field: str, *args: str, **options: str) -> Any:
        def call() -> Any:
            with self._lock:
                if self._model is None:
                    self._model = self._load()
                return getattr(self._model, method)(_pillow(frame.image), *args, **options)[field]

        return await _run_in_thread(self.name, call)


async def _run_in_thread(name: str, call: Callable[[], Any]) -> Any:
    """Run a model in a worker thread. Any exception is raised as a ``PerceptionError``."""
    try:
        return await to_thread.run_sync(call)
    except PerceptionError:
        raise
    # Model code can raise any exception, and the class of out-of-memory errors depends on the device.
    except Exception as error:
        raise PerceptionError(f"{name} failed: {type(error).__name__}: {error}") from error


def _pillow(image: Image) -> Any:
    from PIL import Image as PillowImage

    return PillowImage.fromarray(np.ascontiguousarray(image))


class TransformersChat:
    """A transformers chat model with greedy decoding, loaded on first use."""

    def __init__(self, model: str, options: LocalOptions) -> None:
        self._name, self._options, self._lock = model, options, threading.Lock()
        self._loaded: tuple[Any, Any] | None = None

    def __call__(self, image: Image, prompt: str) -> tuple[str, bool]:
        with self._lock:
            processor, model = self._loaded = self._loaded or self._load()
            parts = [{"type": "image", "image": _pillow(image)}, {"type": "text", "text": prompt}]
            # Options that the template does not use would be passed to the processor.
            template_options = {"enable_thinking": False} if "enable_thinking" in str(processor.chat_template) else {}
            inputs = processor.apply_chat_template(
                [{"role": "user", "content": parts}],
                add_generation_prompt=True,
                tokenize=True,
                return_dict=True,
                return_tensors="pt",
                **template_options,
            ).to(model.device)
            prompt_tokens = inputs["input_ids"].shape[1]
            generated = model.generate(**inputs, max_new_tokens=self._options.max_tokens, do_sample=False)[0][prompt_tokens:]
            return processor.decode(generated, skip_special_tokens=True), len(generated) >= self._options.max_tokens

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
    """Create the backend that a spec describes."""
    require_packages("local", "transformers", "torch")
    options, model = LocalOptions.of(spec), spec.needed_model()
    if options.family == "chat":
        return LocalChatPerception(TransformersChat(model, options), get_convention(spec.coordinates), options, spec.name)
    if not options.trust_remote_code:
        raise ConfigError(f"'{model}' contains its own code. Review the code, then set the option trust_remote_code to run it.")
    if not Path(model).is_dir() and not COMMIT_HASH.fullmatch(options.revision or ""):
        raise ConfigError(
            f"'{model}' contains its own code. Set the option revision to the commit (40 hex digits) that you reviewed."
        )
    return LocalMoondreamPerception(lambda: _load_moondream(model, options), spec.name)
