"""Measure two planners on the same benchmark tasks and compare them by category."""

import tempfile

import scope_ptz
from scope_ptz.contracts import Decision, Finish, State


class SaysNo(scope_ptz.Planner):
    """A baseline that always answers no, without calling tools."""

    name = "says-no"

    async def step(self, state: State) -> Decision:
        return Finish(kind="answered", text="No, there is none.")


def main() -> None:
    tasks = scope_ptz.load_tasks("core", limit=24)
    print(f"{len(tasks)} tasks, for example: {tasks[0].instruction!r}")

    with tempfile.TemporaryDirectory() as out:
        grammar = scope_ptz.evaluate("grammar", "ground-truth", tasks=tasks, out=out, pictures=False)
        baseline = scope_ptz.evaluate(SaysNo(), "ground-truth", tasks=tasks, out=out, pictures=False)
        print(f"\n{'category':<24}{'grammar':>10}{'says-no':>10}")
        for category, score in grammar.scores.items():
            print(f"{category:<24}{score:>10.0%}{baseline.scores[category]:>10.0%}")
        print(f"{'macro':<24}{grammar.macro:>10.0%}{baseline.macro:>10.0%}")

        table = scope_ptz.load_results(grammar.log).to_pandas()
        print("\nWhy runs of the grammar failed:")
        print(table["error_mode"].value_counts().to_string())


if __name__ == "__main__":
    main()
