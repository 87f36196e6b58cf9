"""Clients of the console for benchmarks: the console in a separate process, viewers, conversations, intruders and Chromium."""
