"""Import of tasks from CSV files in the paper's format.

``csv_table`` reads the file and ``structured_cells`` the lists and objects in its cells. ``paper_names`` maps the paper's names to
those of this project, ``scene_names`` does so for scenes and presets, and ``tool_steps`` and ``call_mapping`` turn expected tools
and arguments into required calls. ``row_reading`` makes a task of each row, ``row_checks`` finds rows that are doubtful as tasks,
and ``import_report`` runs all of this and reports on every row. The details of findings are stored with the imported tasks.
"""
