"""``scope bench card``: the page that describes a dataset."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from scope_ptz.cli.endings import ending, put
from scope_ptz.errors import OutputError


def card(
    data: Annotated[Path | None, typer.Option("--data", help="A dataset folder; by default the published dataset.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Where the page goes (Markdown); by default it is printed.")] = None,
) -> None:
    """Write the dataset card from the dataset's own files."""
    with ending():
        from scope_ptz.bench.tasks.splits import published_folder
        from scope_ptz.taskgen.dataset.card import Dataset
        from scope_ptz.taskgen.dataset.card import card as text_of

        folder = data or published_folder()
        if out is not None:
            write_card(folder, out)
            put(f"card of {folder} in {out}")
        else:
            put(text_of(Dataset.read(folder)).rstrip())


def write_card(folder: Path, out: Path) -> None:
    """Write the card of a dataset folder."""
    from scope_ptz.taskgen.dataset.card import Dataset
    from scope_ptz.taskgen.dataset.card import card as text_of

    text = text_of(Dataset.read(folder))
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text, "utf-8")
    except OSError as error:
        raise OutputError(f"The card {out} cannot be written: {error.strerror}.") from error
