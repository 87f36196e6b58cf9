"""What ``scope profile`` reports, and how people read it."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict
from rich.console import Console
from rich.text import Text

from scope_ptz.cli.display import plain
from scope_ptz.planner.profile import Sensitivity
from scope_ptz.planner.profile.speed import Speed, Spread


class PerceptionSpeed(BaseModel):
    """Seconds by skill over frames of a scene; ``failures`` counted by kind, with the words of the first."""

    model_config = ConfigDict(frozen=True)

    frames: int
    by_skill: dict[str, Spread]
    never_worked: tuple[str, ...] = ()
    failures: dict[str, int]
    first_failure: str = ""


class Side(BaseModel):
    """A planner or eyes as they were measured. ``meets_real_time`` is None when nothing, or nothing of one skill, succeeded."""

    model_config = ConfigDict(frozen=True)

    name: str
    served_as: str = ""
    url: str = ""
    planner: Speed | None = None
    eyes: PerceptionSpeed | None = None
    slowest_median_s: float | None = None
    meets_real_time: bool | None = None
    memory_gb: float | None = None
    computed_memory_gb: float | None = None
    serving: dict[str, str] = {}


def show(console: Console, report: dict[str, Any]) -> None:
    """Print a report as people read it."""
    for role in ("planner", "eyes"):
        if role in report:
            _show_side(console, role, Side.model_validate(report[role]))
    words = {"met": "met", "missed": "missed", "unknown": "cannot be told: something never worked"}[report["real_time"]]
    style = {"met": "bold green", "missed": "bold yellow", "unknown": "bold red"}[report["real_time"]]
    console.print(Text.assemble("Real-time bar of the paper (2 Hz, 500 ms an inference): ", (words, style)))
    if "prompts" in report:
        _show_prompts(console, Sensitivity.model_validate(report["prompts"]))


def _show_side(console: Console, role: str, side: Side) -> None:
    served = f", served as {side.served_as}" if side.served_as not in ("", side.name) else ""
    console.print(
        Text.assemble((f"{role} {side.name}", "bold"), f"{served}{f' at {side.url}' if side.url else ''}"), soft_wrap=True
    )
    if side.planner is not None:
        p = side.planner
        console.print(f"  {p.turns} instructions, first step of each")
        _line(console, "first token", p.first_token_s, " s")
        _line(console, "whole turn", p.turn_s, " s")
        _line(console, "tokens/s", p.tokens_per_s, "")
        for label, rate in (("valid calls", p.valid), ("expected call", p.right), ("inverted moves", p.inverted)):
            share = (
                "-"
                if rate.share is None
                else f"{rate.share:.1%} ({rate.count} of {rate.of}, 95% {rate.low:.0%} to {rate.high:.0%})"
            )
            console.print(f"  {label:16}{share}")
        _failures(console, p.failures, p.first_failure)
    if side.eyes is not None:
        console.print(f"  {side.eyes.frames} frames")
        for skill, spread in side.eyes.by_skill.items():
            _line(console, skill, spread, " s")
        for skill in side.eyes.never_worked:
            console.print(Text(f"  {skill:16}never worked", style="red"))
        _failures(console, side.eyes.failures, side.eyes.first_failure)
    told = f"{side.memory_gb:g} GB, as the server tells" if side.memory_gb is not None else "not told by the server"
    computed = f"; computed: {side.computed_memory_gb:g} GB" if side.computed_memory_gb is not None else ""
    console.print(f"  {'memory':16}{told}{computed}")
    for name, value in side.serving.items():
        console.print(Text(plain(f"  {name}: {value}"), style="dim"), soft_wrap=True)


def _line(console: Console, label: str, spread: Spread | None, unit: str) -> None:
    console.print(f"  {label:16}{'-' if spread is None else f'{spread.median:.3g}{unit} (95%: {spread.p95:.3g}{unit})'}")


def _failures(console: Console, failures: dict[str, int], first: str) -> None:
    if failures:
        console.print(Text(f"  {'failures':16}{', '.join(f'{n} {kind}' for kind, n in failures.items())}", style="red"))
    if failures and first:
        console.print(Text(f"  {'the first':16}{plain(first)}", style="red"), soft_wrap=True)


def _show_prompts(console: Console, s: Sensitivity) -> None:
    console.print(Text(f"prompt {s.prompt}, {s.instructions} instructions", style="bold"))
    rates = {
        "tools changed by prompt edits": s.by_prompt,
        "by instruction edits": s.by_instruction,
        "by nothing (noise)": s.noise,
        "inverted moves, all trials": s.inverted_anywhere,
    }
    for label, rate in rates.items():
        console.print(f"  {label:32}{'-' if rate.share is None else f'{rate.share:.1%} ({rate.count} of {rate.of})'}")
    for example in s.inversions[:5]:
        console.print(Text(plain(f"  inverted: {example}"), style="yellow"), soft_wrap=True)
