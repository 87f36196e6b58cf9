"""``scope bench import``: tasks from a file in the paper's published format."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.endings import FAILED, complain, ending, put, put_json

if TYPE_CHECKING:
    from scope_ptz.taskgen.importing.scene_names import SceneNames


def import_tasks(
    file: Annotated[Path, typer.Argument(help="CSV file in the paper's published format.")],
    scenes: Annotated[
        Path | None,
        typer.Option("--scenes", help="Folder of scene packs that the file is about (default: those that scope finds)."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Where the tasks go (JSONL; default: FILE's name with .imported.jsonl, here).")
    ] = None,
    mapping: Annotated[
        Path | None, typer.Option("--map", help="YAML or JSON: scenes by file location, presets by the file's names.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="The whole report as JSON.")] = False,
) -> None:
    """Import tasks: map tools, arguments, categories and scenes; report what is doubtful; write what can be run.

    Exit code 1 when no row can be run.
    """
    with ending(as_json=as_json):
        from scope_ptz.bench.tasks.imported import dump_imported
        from scope_ptz.errors import OutputError
        from scope_ptz.taskgen.importing.import_report import import_file, report_lines

        imported = import_file(file, places_in(scenes, mapping))
        target = out or Path(f"{file.stem}.imported.jsonl")
        report = target.with_name(target.name.removesuffix(".jsonl") + ".report.json")
        dump_imported(imported.tasks, target)
        content = imported.as_dict()
        try:
            report.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")
        except OSError as error:
            raise OutputError(f"The report {report} cannot be written: {error.strerror}.") from error
        if as_json:
            put_json(content, indent=1)
        else:
            for line in report_lines(imported):
                put(line)
            put("")
            put(f"{len(imported.tasks)} tasks in {target}, every row with its findings in {report}")
            if any(content["map_to_fill"].values()):
                put("Unknown names of scenes and presets can be given with --map; 'map_to_fill' in the report lists them.")
        if not imported.tasks and not content["rows"]:
            complain(f"{file} has a header and no rows: there is nothing to import.")
            sys.exit(FAILED)
        if not imported.tasks:
            known = ", ".join(sorted(places_in(scenes, mapping).scenes)) or "none"
            complain(f"no row can be run. Scenes that are there: {known}. Name those of the file with --scenes or --map.")
            sys.exit(FAILED)


def places_in(folder: Path | None, mapping: Path | None) -> SceneNames:
    """The scenes of a folder and the built-in ones, with what a mapping file says. Raises ``InputError``."""
    from scope_ptz.errors import InputError
    from scope_ptz.factory.scenes import scene_search
    from scope_ptz.settings import load_settings
    from scope_ptz.simulator.pack import list_scenes, load_scene
    from scope_ptz.taskgen.importing.scene_names import SceneNameMap, SceneNames, ScenePresets, read_scene_names

    if folder is not None and not folder.is_dir():
        raise InputError(f"There is no folder {folder} of scenes.")
    search = (*([folder] if folder else []), *scene_search(load_settings()))
    known = {}
    for name in list_scenes(search):
        file = load_scene(name, search).file
        known[name] = ScenePresets({preset.name: preset.viewpoint for preset in file.presets}, file.home_preset, file.start_s)
    return SceneNames(known, read_scene_names(mapping) if mapping else SceneNameMap())
