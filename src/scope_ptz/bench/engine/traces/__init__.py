"""Scores and verification from the traces of a log.

``scored_trials`` computes the trial of a run from its trace. ``traced_trials`` compares it with the score in the log, and
``log_completeness`` checks the samples of a log as a whole. ``log_runs`` reads the runs of a log. ``verification`` makes their
calls again, and ``frame_comparison`` compares the frames.
"""
