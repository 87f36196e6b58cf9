"""Take part in a hosted evaluation over HTTP: begin each task, call tools, and answer.

Run a host first (see docs/hosting.md), then: python examples/hosted_agent.py http://127.0.0.1:8000 TOKEN_FILE
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import httpx2


def answer_to(instruction: str, ask: Any) -> str:
    """Return the answer to an instruction, using ``ask`` to call tools. This example only counts the objects that it names."""
    call = {"id": "1", "name": "count_objects", "arguments": {"description": instruction.split()[2], "view": "current"}}
    (result,) = ask({"type": "calls", "calls": [call]})["results"]
    return f"I count {result['result']['count']}." if result["error"] is None else "I cannot tell."


def main(url: str, token: str) -> None:
    """Attempt every task once."""
    with httpx2.Client(base_url=url, headers={"Authorization": f"Bearer {token}"}, timeout=600.0) as http:

        def ask(message: dict[str, Any]) -> Any:
            return http.post("/api/v1/messages", json=message).raise_for_status().json()

        while (task := ask({"type": "hello", "protocol": 1, "name": "example"}))["type"] == "task":
            print(task["instruction"])
            print(ask({"type": "reply", "text": answer_to(task["instruction"], ask)})["reason"])


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]).read_text("utf-8").strip())
