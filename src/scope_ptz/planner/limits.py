"""Limits on the input of planners."""

MAX_INSTRUCTION_CHARS = 4000  # longer instructions raise InputError
