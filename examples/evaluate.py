"""Measure a planner and perception on benchmark tasks, and compare perception with and without mistakes."""

import tempfile

import scope_ptz


def main() -> None:
    tasks = scope_ptz.load_tasks("core", limit=16)
    print(f"{len(tasks)} tasks, for example: {tasks[0].instruction!r}")

    with tempfile.TemporaryDirectory() as out:
        for perception in ("ground-truth", "noisy"):
            results = scope_ptz.evaluate("grammar", perception, tasks=tasks, out=out)
            print(f"\n{results.pair}: {results.macro:.0%} (mean of {len(results.scores)} categories)")
            for trial in results.trials:
                if trial.headline == "incorrect":
                    print(f"  {trial.task.instruction!r}\n    expected {trial.task.expected!r}, got {trial.answer!r}")

        table = scope_ptz.load_results(results.log).to_pandas()
        print("\nMean duration of a run by category, in seconds:")
        print(table.groupby("category")["total_s"].mean().round(2).to_string())


if __name__ == "__main__":
    main()
