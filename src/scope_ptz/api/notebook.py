"""Display runs, scenes and results in notebooks as HTML with embedded pictures, for light and dark themes."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable, Sequence
from html import escape

from PIL import Image

PICTURE_WIDTH = 1100  # pixels; wider pictures are scaled down to keep notebooks small
JPEG_QUALITY = 85
MAX_CELL_CHARS = 300  # longer table cells are truncated

_OUTCOME_COLOURS = {"answered": "#2e9e5b", "clarification": "#c98a00", "refused": "#c98a00"}
_FAILURE_COLOUR = "#d5483b"
_FAINT_STYLE = "opacity:.65"
_CELL_STYLE = "text-align:left;vertical-align:top;padding:3px 14px 3px 0"


def run_html(
    instruction: str, answer: str, outcome: str, facts: Sequence[str], filmstrip: Image.Image | str, calls: Sequence[Sequence[str]]
) -> str:
    """Return a run as HTML: the answer, the filmstrip and a table of the tool calls.

    Args:
        instruction: The instruction.
        answer: The final text of the run.
        outcome: The outcome, which determines the colour of the bar.
        facts: Short phrases that state the planner, the perception backend and the duration.
        filmstrip: The filmstrip, or a sentence that explains why there is none.
        calls: Step, tool, arguments, result and seconds of each tool call.
    """
    colour = _OUTCOME_COLOURS.get(outcome, _FAILURE_COLOUR)
    parts = [
        f'<div style="border-left:4px solid {colour};padding-left:10px;margin:4px 0 10px">',
        f'<div style="{_FAINT_STYLE}">{escape(instruction)}</div>',
        f'<div style="font-size:1.15em;font-weight:600">{escape(answer)}</div>',
        f'<div style="{_FAINT_STYLE};font-size:.85em">{escape(" · ".join((outcome.replace("_", " "), *facts)))}</div></div>',
        f'<div style="{_FAINT_STYLE}">{escape(filmstrip)}</div>'
        if isinstance(filmstrip, str)
        else picture_html(filmstrip, "filmstrip"),
    ]
    if calls:
        parts.append(_table(("step", "tool", "arguments", "result", "seconds"), calls))
    return _block(parts)


def card_html(title: str, rows: Iterable[Sequence[str]], picture: Image.Image) -> str:
    """Return a card as HTML: a title, rows of labels and values, and a picture."""
    heading = f'<div style="font-size:1.15em;font-weight:600;margin-bottom:4px">{escape(title)}</div>'
    return _block([heading, _table((), rows), picture_html(picture, title)])


def table_html(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], note: str = "") -> str:
    """Return a titled table as HTML."""
    parts = [f'<div style="font-size:1.15em;font-weight:600;margin-bottom:4px">{escape(title)}</div>', _table(header, rows)]
    if note:
        parts.append(f'<div style="{_FAINT_STYLE};font-size:.85em;margin-top:6px">{escape(note)}</div>')
    return _block(parts)


def picture_html(image: Image.Image, alt: str) -> str:
    """Return a picture as an HTML ``img`` element with embedded JPEG data."""
    if image.width > PICTURE_WIDTH:
        image = image.resize((PICTURE_WIDTH, round(image.height * PICTURE_WIDTH / image.width)), Image.Resampling.LANCZOS)
    buffer = io.BytesIO()
    image.save(buffer, "JPEG", quality=JPEG_QUALITY)
    data = base64.b64encode(buffer.getvalue()).decode()
    style = "max-width:100%;border-radius:8px;margin-top:8px;display:block"
    return f'<img alt="{escape(alt)}" style="{style}" src="data:image/jpeg;base64,{data}">'


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    head = "".join(f'<th style="{_CELL_STYLE};{_FAINT_STYLE};font-weight:400">{escape(name)}</th>' for name in header)
    body = "".join(f"<tr>{''.join(_cell(text, first=number == 0) for number, text in enumerate(row))}</tr>" for row in rows)
    top = f"<thead><tr>{head}</tr></thead>" if head else ""
    return f'<table style="border-collapse:collapse;margin:8px 0 0;font-size:.95em">{top}<tbody>{body}</tbody></table>'


def _cell(text: str, *, first: bool) -> str:
    truncated = text if len(text) <= MAX_CELL_CHARS else text[: MAX_CELL_CHARS - 1] + "…"
    nowrap = ";white-space:nowrap" if first else ""
    return f'<td style="{_CELL_STYLE}{nowrap}">{escape(truncated)}</td>'


def _block(parts: Iterable[str]) -> str:
    return f'<div style="font-family:system-ui,sans-serif;max-width:{PICTURE_WIDTH}px">{"".join(parts)}</div>'
