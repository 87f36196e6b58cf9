"""Give a camera an instruction in plain language and read the answer."""

import scope_ptz


def main() -> None:
    with scope_ptz.open("highway-works") as scope:
        run = scope.ask("Go to the highway preset, then pan right in 15 degree steps until you see at least six cones")
        print(run.answer)
        print(f"\nIt {run.outcome} after {len(run.calls)} calls, and the camera is at {run.pose}:")
        for call in run.calls:
            print(f"  {call.step}. {call}")

        print("\nThe session remembers what was said, and events arrive as they happen:")
        for event in scope.stream("now zoom in 2x and count the workers"):
            print(f"  {event}")

        run.filmstrip.save("filmstrip.png")
        print("\nThe first run in one picture: filmstrip.png")


if __name__ == "__main__":
    main()
