"""The MCP tools: the nine camera tools, and tools for instructions, runs and the cameras themselves."""
