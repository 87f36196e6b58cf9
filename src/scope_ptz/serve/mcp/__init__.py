"""The MCP server: cameras, tools and runs for agents that speak the Model Context Protocol."""
