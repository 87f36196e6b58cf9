"""A planner that asks a language model behind an OpenAI-compatible server."""

from scope_ptz.planner.chat.planner import ChatOptions, ChatPlanner
from scope_ptz.planner.chat.prompts import Prompt, load_prompt, prompt_names

__all__ = ["ChatOptions", "ChatPlanner", "Prompt", "load_prompt", "prompt_names"]
