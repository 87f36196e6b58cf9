"""Take part in a hosted evaluation over MCP, with the official client library.

Run a host first (see docs/hosting.md), then: python examples/hosted_agent_mcp.py http://127.0.0.1:8000/mcp TOKEN_FILE
"""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

import httpx2
from mcp import Client
from mcp.client.streamable_http import streamable_http_client


async def main(url: str, token: str) -> None:
    """Attempt every task once. Replace the call of ``count_objects`` with your agent."""
    async with (
        httpx2.AsyncClient(headers={"Authorization": f"Bearer {token}"}, timeout=600.0) as http,
        Client(streamable_http_client(url, http_client=http)) as client,
    ):
        while True:
            task = (await client.call_tool("begin_task", {"frames": False})).structured_content
            if not isinstance(task, dict) or "instruction" not in task:
                break
            print(task["instruction"])
            noun = str(task["instruction"]).split()[2]
            reply = await client.call_tool("count_objects", {"description": noun, "view": "current"})
            report = reply.structured_content
            number = report["result"]["count"] if isinstance(report, dict) and report["result"] else None
            await client.call_tool("answer", {"text": "I cannot tell." if number is None else f"I count {number}."})


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], Path(sys.argv[2]).read_text("utf-8").strip()))
