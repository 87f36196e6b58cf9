"""The MCP tools: the nine camera tools, instructions and runs, and the cameras themselves."""
