"""Scene cards, which describe a scene's contents and production, for the terminal or as a Markdown page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from scope_ptz.simulator.models import CapturedFrom, Layer, Manifest, SceneFile, ScenePreset, SceneViewpoint
from scope_ptz.simulator.pack import Scene


@dataclass(frozen=True, slots=True)
class CardSection:
    """A section of a scene card.

    Attributes:
        title: The heading.
        lines: Pairs of a label, which may be empty, and its text.
    """

    title: str
    lines: tuple[tuple[str, str], ...]


def folder_bytes(folder: Path) -> int:
    """Return the total size of the files in a folder, in bytes."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def megabytes(size: int) -> str:
    """Format a number of bytes in megabytes."""
    return f"{size / 1e6:.1f} MB"


def object_counts(file: SceneFile) -> list[tuple[str, int]]:
    """Return the categories of a scene's objects with their numbers, the most frequent first. Moving objects are included."""
    return Counter([instance.category for instance in file.instances] + [actor.category for actor in file.actors]).most_common()


def contents(file: SceneFile) -> Iterator[tuple[str, list[str]]]:
    """Yield the lists of a short card, each with a title: objects, texts, moving objects, and objects that are absent."""
    counts = [f"{count} {category}" for category, count in object_counts(file)]
    yield f"Objects ({len(file.instances) + len(file.actors)})", counts
    yield f"Texts ({len(file.texts)})", [f"“{text}”" for text in dict.fromkeys(" ".join(t.text.split()) for t in file.texts)]
    yield "Moving objects", [actor.name for actor in file.actors]
    yield "Deliberately absent", list(file.absent)


def card(scene: Scene) -> Iterator[CardSection]:
    """Yield the sections of a scene's card."""
    file = scene.file
    for viewpoint in file.viewpoints:
        presets = [p for p in file.presets if p.viewpoint == viewpoint.name]
        yield CardSection(f"Viewpoint {viewpoint.name}", (("", _place(scene, viewpoint)), *(_preset(scene, p) for p in presets)))
    if file.captured is not None:
        yield CardSection("Captured", tuple(_capture_details(scene, file.captured)))
        yield CardSection("Checksums (SHA-256)", tuple(_checksums(scene)))
        return
    counts = object_counts(file)
    inventory = ", ".join(f"{count} {category}" for category, count in counts)
    yield CardSection(
        f"{len(file.instances)} static and {len(file.actors)} moving objects in {len(counts)} categories", (("", inventory),)
    )
    readable = Counter(f"“{' '.join(t.text.split())}”" for t in file.texts)
    texts = "; ".join(f"{text} ({n} times)" if n > 2 else text for text, n in readable.items())
    yield CardSection(f"{len(file.texts)} texts", (("", texts or "none"),))
    moving_objects = tuple((a.name, _presence(a.waypoints[0][0], a.waypoints[-1][0], a.period_s)) for a in file.actors)
    yield CardSection("Moving objects", moving_objects or (("", "none"),))
    yield CardSection("Deliberately absent", (("", ", ".join(file.absent) or "none"),))
    yield CardSection("How it was made", tuple(_production(scene)))
    yield CardSection("Checksums (SHA-256)", tuple(_checksums(scene)))


def markdown(scene: Scene, picture: str | None) -> str:
    """Return a scene's card as a Markdown page.

    Args:
        scene: The scene.
        picture: Path of the contact sheet, relative to the page. None for a page without a picture.
    """
    parts = [f"# {scene.file.title}", f"`{scene.name}`, version {scene.file.version}"]
    if picture:
        parts.append(f"![All presets of {scene.name}]({picture})")
    for section in card(scene):
        parts.append(f"## {section.title}")
        if len(section.lines) == 1 and not section.lines[0][0]:
            parts.append(section.lines[0][1])
        else:
            parts.append("\n".join(f"- **{name}**: {body}" if name else f"- {body}" for name, body in section.lines))
    return "\n\n".join(parts) + "\n"


def _place(scene: Scene, viewpoint: SceneViewpoint) -> str:
    x, y, z = viewpoint.position_m
    size = megabytes(folder_bytes(scene.folder / viewpoint.name))
    return f"{viewpoint.description}; position ({x:.1f}, {y:.1f}, {z:.1f}) m; files {size}"


def _preset(scene: Scene, preset: ScenePreset) -> tuple[str, str]:
    home = ", home" if preset.name == scene.file.home_preset else ""
    pose = f"pan {preset.pan_deg:g}°, tilt {preset.tilt_deg:g}°, zoom {preset.zoom:g}x{home}"
    return preset.name, f"{pose}; {preset.description}" if preset.description else pose


def capture_summary(captured: CapturedFrom) -> str:
    """Return a short description of where a captured scene comes from."""
    unseen = f"{captured.unseen_share:.1%} of the camera's range was not captured" if captured.unseen_share else "fully captured"
    return f"from {captured.camera} at {captured.captured_at}; {unseen}; no ground truth"


def _capture_details(scene: Scene, captured: CapturedFrom) -> Iterator[tuple[str, str]]:
    yield "", capture_summary(captured)
    (low_pan, high_pan), (low_tilt, high_tilt), (low, high) = captured.pan_range_deg, captured.tilt_range_deg, captured.zoom_range
    yield "limits", f"pan {low_pan:g}° to {high_pan:g}°, tilt {low_tilt:g}° to {high_tilt:g}°, zoom {low:g}x to {high:g}x"
    for place in scene.file.viewpoints:
        manifest = scene.viewpoint(place.name).manifest
        yield place.name, f"panorama {manifest.base.width}x{manifest.base.height}; {len(manifest.tiles)} sharper tiles"


def _presence(start_s: float, end_s: float, period_s: float) -> str:
    """Describe when a moving object is in the scene."""
    if round(start_s) == 0 and round(end_s) >= round(period_s):
        return "always in the scene"
    return f"in the scene from {start_s:.0f} to {end_s:.0f} s of every {period_s:.0f} s"


def _production(scene: Scene) -> Iterator[tuple[str, str]]:
    yield (
        "",
        f"modelled in code (`scope scene build {scene.name}`) and rendered with Cycles in Blender {scene.file.blender_version}",
    )
    for place in scene.file.viewpoints:
        manifest = scene.viewpoint(place.name).manifest
        sprites = sum(len(sheet.sprites) for sheet in manifest.actors)
        layers = ", ".join(f"{part} {layer.width}x{layer.height}" for part, layer in _panoramas(manifest))
        rest = f"{len(manifest.tiles)} tiles of higher resolution and {sprites} sprites of moving objects"
        yield place.name, f"{layers}, {manifest.samples} samples per pixel, denoised; {rest}"


def _panoramas(manifest: Manifest) -> tuple[tuple[str, Layer], ...]:
    return ("panorama", manifest.base), ("instance IDs", manifest.ids), ("depth", manifest.depth)


def _checksums(scene: Scene) -> Iterator[tuple[str, str]]:
    yield "scene.json", f"`{_digest(scene.folder / 'scene.json')}`"
    for place in scene.file.viewpoints:
        yield (
            f"{place.name}/manifest.json",
            f"`{_digest(scene.folder / place.name / 'manifest.json')}` (contains the checksums of the viewpoint's other files)",
        )


def _digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()
