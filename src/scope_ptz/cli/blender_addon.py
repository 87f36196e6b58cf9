"""``scope blender-addon``: build the add-on for Blender."""

from __future__ import annotations

from pathlib import Path


def build(out: Path, *, as_json: bool) -> None:
    """Write the add-on's zip file, and print how to install it."""
    from scope_ptz.blender.addon_zip import write_addon_zip
    from scope_ptz.cli.exit import put, put_json

    write_addon_zip(out)
    if as_json:
        put_json({"file": str(out.absolute())})
        return
    put(f"Wrote {out}.")
    put("Blender 4.2 or later: Edit > Preferences > Get Extensions > menu at the top right > Install from Disk.")
    put("Blender 3.4 to 4.1: Edit > Preferences > Add-ons > Install, then enable SCOPE.")
