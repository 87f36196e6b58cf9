"""Ask the same questions at every preset of a scene, and print a table."""

import scope_ptz

THINGS = ("workers", "cars", "traffic cones")


def main() -> None:
    with scope_ptz.open("highway-works") as scope:
        presets = scope.get_presets().presets
        print(f"{'preset':<14}{'pose':<26}" + "".join(f"{thing:>15}" for thing in THINGS))
        for preset in presets:
            pose = scope.go_to_preset(preset).pose
            counts = [scope.count_objects(thing) for thing in THINGS]
            where = f"{pose.pan_deg:+.0f}°, {pose.tilt_deg:+.0f}°, {pose.zoom:.1f}x"
            print(f"{preset:<14}{where:<26}" + "".join(f"{result.count:>15}" for result in counts))

        best = max(presets, key=lambda preset: busy(scope, preset))
        print(f"\nMost workers are in view at '{best}'.")


def busy(scope: scope_ptz.Scope, preset: str) -> int:
    scope.go_to_preset(preset)
    return scope.count_objects("workers").count


if __name__ == "__main__":
    main()
