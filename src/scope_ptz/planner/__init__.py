"""Planners: their contract, the grammar planner, the planner for chat models, and measurements of planners."""
