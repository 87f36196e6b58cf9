"""Ask the same questions at every preset of a scene, and print a table."""

import scope_ptz

OBJECTS = ("workers", "cars", "traffic cones")


def main() -> None:
    with scope_ptz.open("highway-works") as scope:
        presets = scope.get_presets().presets
        print(f"{'preset':<14}{'pose':<26}" + "".join(f"{name:>15}" for name in OBJECTS))
        for preset in presets:
            pose = scope.go_to_preset(preset).pose
            counts = [scope.count_objects(name) for name in OBJECTS]
            pose_text = f"{pose.pan_deg:+.0f}°, {pose.tilt_deg:+.0f}°, {pose.zoom:.1f}x"
            print(f"{preset:<14}{pose_text:<26}" + "".join(f"{result.count:>15}" for result in counts))

        best = max(presets, key=lambda preset: count_workers(scope, preset))
        print(f"\nMost workers are in view at '{best}'.")


def count_workers(scope: scope_ptz.Scope, preset: str) -> int:
    scope.go_to_preset(preset)
    return scope.count_objects("workers").count


if __name__ == "__main__":
    main()
