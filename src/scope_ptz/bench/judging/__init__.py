"""Judging of runs by language models, human labels, and the agreement of all raters."""
