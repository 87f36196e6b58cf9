"""How runs, scenes and results show themselves in a notebook: HTML with embedded pictures, for light and dark themes."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

from PIL import Image

from scope_ptz.errors import TraceError

if TYPE_CHECKING:
    from scope_ptz.api.run import CallResult, Run
    from scope_ptz.api.scenes import SceneInfo

PICTURE_WIDTH = 1100  # pixels; wider pictures are scaled down to keep notebooks small
JPEG_QUALITY = 85
MAX_TEXT_CHARS = 300  # longer cells of a table are cut
MAX_OBJECTS = 10  # categories in the card of a scene

_COLOURS = {"answered": "#2e9e5b", "clarification": "#c98a00", "refused": "#c98a00"}
_FAILED = "#d5483b"
_FAINT = "opacity:.65"
_CELL = "text-align:left;vertical-align:top;padding:3px 14px 3px 0"


def run_html(run: Run) -> str:
    """Return a run as HTML: the answer, the filmstrip and a table of the tool calls."""
    colour = _COLOURS.get(run.outcome, _FAILED)
    took = f"{run.timings.total_s:.1f} s"
    facts = [f"planner {run.planner}", run.note.rstrip(".") or f"perception {run.perception}", took]
    parts = [
        f'<div style="border-left:4px solid {colour};padding-left:10px;margin:4px 0 10px">',
        f'<div style="{_FAINT}">{escape(run.instruction)}</div>',
        f'<div style="font-size:1.15em;font-weight:600">{escape(run.answer)}</div>',
        f'<div style="{_FAINT};font-size:.85em">{escape(run.outcome.replace("_", " "))} · {escape(" · ".join(facts))}</div></div>',
    ]
    try:
        parts.append(picture_html(run.filmstrip, "filmstrip"))
    except TraceError as error:
        parts.append(f'<div style="{_FAINT}">{escape(str(error))}</div>')
    if run.calls:
        parts.append(_table(("step", "tool", "arguments", "result", "seconds"), [_call_row(call) for call in run.calls]))
    return _block(parts)


def scene_html(scene: SceneInfo) -> str:
    """Return a scene as HTML: a short card and the contact sheet of its presets."""
    objects = list(scene.objects.items())
    listed = ", ".join(f"{count} {name}" for name, count in objects[:MAX_OBJECTS])
    more = f" and {len(objects) - MAX_OBJECTS} more categories" if len(objects) > MAX_OBJECTS else ""
    places = "; ".join(
        f"{viewpoint}: {', '.join(name for name, of in scene.presets.items() if of == viewpoint) or 'no presets'}"
        for viewpoint in scene.viewpoints
    )
    rows = [("open with", f'scope_ptz.open("{scene.name}")'), ("presets", places), ("objects", listed + more)]
    return _block(
        [
            f'<div style="font-size:1.15em;font-weight:600;margin-bottom:4px">{escape(scene.title)}</div>',
            _table((), rows),
            picture_html(scene.contact_sheet, f"presets of {scene.name}"),
        ]
    )


def table_html(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], note: str = "") -> str:
    """Return a titled table as HTML."""
    parts = [f'<div style="font-size:1.15em;font-weight:600;margin-bottom:4px">{escape(title)}</div>', _table(header, rows)]
    if note:
        parts.append(f'<div style="{_FAINT};font-size:.85em;margin-top:6px">{escape(note)}</div>')
    return _block(parts)


def picture_html(image: Image.Image, alt: str) -> str:
    """Return a picture as an HTML image with its data in it."""
    if image.width > PICTURE_WIDTH:
        image = image.resize((PICTURE_WIDTH, round(image.height * PICTURE_WIDTH / image.width)), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=JPEG_QUALITY)
    data = base64.b64encode(buffer.getvalue()).decode()
    style = "max-width:100%;border-radius:8px;margin-top:8px;display:block"
    return f'<img alt="{escape(alt)}" style="{style}" src="data:image/jpeg;base64,{data}">'


def _call_row(call: CallResult) -> tuple[str, str, str, str, str]:
    arguments = ", ".join(f"{name}={value}" for name, value in call.arguments.items())
    message = call.message if call.ok else f"failed: {call.message}"
    return str(call.step), call.name, arguments, message, f"{call.duration_s:.2f}"


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f'<th style="{_CELL};{_FAINT};font-weight:400">{escape(name)}</th>' for name in header)
    body = "".join(f"<tr>{''.join(_cell(text, first=number == 0) for number, text in enumerate(row))}</tr>" for row in rows)
    top = f"<thead><tr>{head}</tr></thead>" if head else ""
    return f'<table style="border-collapse:collapse;margin:8px 0 0;font-size:.95em">{top}<tbody>{body}</tbody></table>'


def _cell(text: str, *, first: bool) -> str:
    shown = text if len(text) <= MAX_TEXT_CHARS else text[: MAX_TEXT_CHARS - 1] + "…"
    nowrap = ";white-space:nowrap" if first else ""
    return f'<td style="{_CELL}{nowrap}">{escape(shown)}</td>'


def _block(parts: Iterable[str]) -> str:
    return f'<div style="font-family:system-ui,sans-serif;max-width:{PICTURE_WIDTH}px">{"".join(parts)}</div>'
