"""Train the linear models of the built-in planner, and measure them."""
