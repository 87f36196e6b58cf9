"""Running the steps: tool calls, tests of conditions, and the answer in words."""
