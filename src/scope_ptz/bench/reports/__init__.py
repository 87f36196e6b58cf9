"""Reports of evaluations: what the paper shows, for any set of runs, as a page, Markdown and CSV."""
