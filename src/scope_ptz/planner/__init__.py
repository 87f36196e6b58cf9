"""Planners: the contract, the grammar planner, chat models and prompt-sensitivity tests."""
