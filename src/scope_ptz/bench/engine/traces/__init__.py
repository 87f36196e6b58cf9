"""Compute scores from the traces in a log, and verify the traces.

``scored_trials`` computes the trial of a run from its trace. ``traced_trials`` compares the trial with the score in the log, and
``log_completeness`` checks the samples of a log as a whole. ``log_runs`` reads the runs of a log. ``verification`` repeats the
calls of these runs, and ``frame_comparison`` compares the frames.
"""
