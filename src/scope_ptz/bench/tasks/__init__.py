"""Benchmark tasks as data: their schema, task files and splits."""
