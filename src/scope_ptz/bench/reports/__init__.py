"""Reports on evaluations: tables, charts, pages of failed tasks, and submissions."""
