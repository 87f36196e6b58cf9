"""Run the steps of an instruction: make tool calls, test conditions and phrase the answer."""
