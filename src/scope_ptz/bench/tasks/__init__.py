"""Tasks as data: the schema, task files, splits."""
