"""The agent loop: state, budgets, trace, replay."""
