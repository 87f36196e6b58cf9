"""The benchmark: tasks, answer parsing, scoring, statistics, the evaluation engine, judging and reports."""
