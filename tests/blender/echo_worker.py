"""A fake worker that speaks the protocol without Blender, for tests of the client."""

import json
import sys
import time

REPLY_PREFIX = "@scope "


def say(message: dict[str, object]) -> None:
    sys.stdout.write(f"{REPLY_PREFIX}{json.dumps(message)}\n")
    sys.stdout.flush()


sys.stdout.write("Blender 5.0.1 (chatter that is no answer)\n")
say({"hello": "5.0.1"})
for line in sys.stdin:
    request = json.loads(line)
    match request["op"]:
        case "quit":
            break
        case "echo":
            sys.stdout.write("Saved: somewhere\n")
            say({"id": request["id"], "progress": [1, 2]})
            say({"id": request["id"], "result": request["params"]})
        case "fail":
            say({"id": request["id"], "error": "ValueError: no such thing"})
        case "crash":
            sys.stderr.write("Segmentation fault, so to say\n")
            sys.stderr.flush()
            sys.exit(11)
        case "sleep":
            time.sleep(30)
