"""The benchmark: what a task expects, how an answer is read, what a run must show, and how a failed run failed."""
