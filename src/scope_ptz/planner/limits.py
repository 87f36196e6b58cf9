"""Limits of what planners take."""

MAX_INSTRUCTION_CHARS = 4000  # longer instructions raise InputError
