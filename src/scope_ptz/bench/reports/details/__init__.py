"""The sections of a report below its first screen, one module each."""
