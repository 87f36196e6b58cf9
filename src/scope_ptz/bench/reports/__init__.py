"""Create reports on evaluations, with tables, charts and pages of failed tasks."""
