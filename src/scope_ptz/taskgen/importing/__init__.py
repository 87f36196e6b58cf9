"""Import tasks from CSV files in the paper's format.

``csv_table`` reads the file, and ``structured_cells`` parses the lists and objects in its cells. ``paper_names`` maps the paper's
names to SCOPE's, and ``scene_names`` maps scene and preset names. ``tool_steps`` and ``call_mapping`` convert expected tools and
arguments to required calls. ``contradictions`` finds fields of a row that contradict each other.
``row_reading`` creates a task from each row, and ``row_checks`` finds rows that make questionable tasks. ``import_report`` runs
all of these steps and reports on every row. Imported tasks are stored with their findings.
"""
