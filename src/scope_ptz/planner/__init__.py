"""The planner contract, the grammar, chat and hybrid planners, and measurements of planners."""
