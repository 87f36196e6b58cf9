"""Create reports on evaluations, with tables, charts and pages about failed tasks."""
