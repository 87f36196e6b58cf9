"""Give a camera an instruction in plain language and read the answer."""

import scope_ptz


def main() -> None:
    with scope_ptz.open("highway-works") as scope:
        run = scope.ask("Go to the highway preset, then pan right in 15 degree steps until you see at least six cones")
        print(run.answer)
        print(f"\nOutcome: {run.outcome} after {len(run.calls)} calls. The camera is at {run.pose}. Calls:")
        for call in run.calls:
            print(f"  {call.step}. {call}")

        print("\nThe session remembers earlier instructions. Events arrive while the run is in progress:")
        for event in scope.stream("now zoom in 2x and count the workers"):
            print(f"  {event}")

        run.filmstrip.save("filmstrip.png")
        print("\nSaved a picture of the first run: filmstrip.png")


if __name__ == "__main__":
    main()
