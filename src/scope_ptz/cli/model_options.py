"""The options by which commands are told who plans, who sees, and where their servers are."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from scope_ptz.factory.models import ModelOptions

_PANEL = "Models"


PlannerOption = Annotated[
    str | None,
    typer.Option("--planner", help="Who plans: grammar (default), chat, or a model of `scope models`.", rich_help_panel=_PANEL),
]
PerceptionOption = Annotated[
    str | None,
    typer.Option("--perception", help="Who looks: ground-truth (default), noisy, a model, or a backend.", rich_help_panel=_PANEL),
]
PairOption = Annotated[
    str | None,
    typer.Option("--pair", help="PLANNER+EYES, or one model that is both; see `scope models pairs`.", rich_help_panel=_PANEL),
]
PlannerUrlOption = Annotated[
    str | None, typer.Option("--planner-url", help="Address of the planner's server, with its /v1.", rich_help_panel=_PANEL)
]
PerceptionUrlOption = Annotated[
    str | None, typer.Option("--perception-url", help="Address of the eyes' server.", rich_help_panel=_PANEL)
]
PlannerModelOption = Annotated[
    str | None,
    typer.Option("--planner-model", help="What the server calls the planner (default: as it lists it).", rich_help_panel=_PANEL),
]
PerceptionModelOption = Annotated[
    str | None,
    typer.Option("--perception-model", help="What the server calls the eyes (default: as it lists them).", rich_help_panel=_PANEL),
]
PlannerKeyOption = Annotated[
    Path | None,
    typer.Option(
        "--planner-key-file", help="File with the key of the planner's server (or SCOPE_PLANNER_KEY).", rich_help_panel=_PANEL
    ),
]
PerceptionKeyOption = Annotated[
    Path | None,
    typer.Option(
        "--perception-key-file", help="File with the key of the eyes' server (or SCOPE_PERCEPTION_KEY).", rich_help_panel=_PANEL
    ),
]
PlannerOptions = Annotated[
    list[str] | None,
    typer.Option(
        "--planner-option", metavar="NAME=VALUE", help="thinking=on, prompt=..., summarise=true, ...", rich_help_panel=_PANEL
    ),
]
PerceptionOptions = Annotated[
    list[str] | None,
    typer.Option(
        "--perception-option", metavar="NAME=VALUE", help="coordinates=qwen3-vl, max_pixels=..., ...", rich_help_panel=_PANEL
    ),
]
ReaderOption = Annotated[
    str | None, typer.Option("--reader", help="Who reads text in place of the eyes, for example rapidocr.", rich_help_panel=_PANEL)
]
DetectorOption = Annotated[
    str | None,
    typer.Option("--detector", help="Who finds things in place of the eyes, for example owlv2-base.", rich_help_panel=_PANEL),
]
TimeoutOption = Annotated[
    float | None,
    typer.Option("--timeout", min=0.1, help="Seconds for a call to a model server, retries included.", rich_help_panel=_PANEL),
]


def model_options(
    planner: str | None, perception: str | None, pair: str | None, planner_url: str | None, perception_url: str | None,
    planner_model: str | None, perception_model: str | None, planner_key_file: Path | None, perception_key_file: Path | None,
    planner_option: list[str] | None, perception_option: list[str] | None, reader: str | None, detector: str | None,
    timeout: float | None,
) -> ModelOptions:  # fmt: skip
    """The options as one object."""
    from scope_ptz.factory.models import ModelOptions

    return ModelOptions(
        planner=planner,
        perception=perception,
        pair=pair,
        planner_url=planner_url,
        perception_url=perception_url,
        planner_model=planner_model,
        perception_model=perception_model,
        planner_key_file=planner_key_file,
        perception_key_file=perception_key_file,
        planner_options=tuple(planner_option or ()),
        perception_options=tuple(perception_option or ()),
        reader=reader,
        detector=detector,
        timeout_s=timeout,
    )
