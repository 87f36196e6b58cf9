"""Resolve the names and embedded questions in the steps of an instruction, so that the steps can run."""
