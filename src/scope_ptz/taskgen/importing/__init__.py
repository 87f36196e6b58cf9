"""Import of tasks from CSV files in the paper's format.

``csv_table`` reads the file, and ``structured_cells`` parses the lists and objects in its cells. ``paper_names`` maps the paper's
names to those of SCOPE, and ``scene_names`` maps the names of scenes and presets. ``tool_steps`` and ``call_mapping`` convert
expected tools and arguments to required calls. ``contradictions`` finds fields of a row that contradict each other.
``row_reading`` creates a task from each row, and ``row_checks`` finds rows that are questionable as tasks. ``import_report`` runs
all of these steps and reports on every row. Imported tasks are stored with their findings.
"""
