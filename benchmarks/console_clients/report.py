"""The printed report of the load benchmark."""

from __future__ import annotations

from typing import Any

from console_clients.figures import in_ms

TARGET_FRAMES_PER_S, TARGET_STOP_S, TARGET_BUTTON_S = 10.0, 0.2, 0.1


def report(results: dict[str, Any]) -> None:
    """Print the results."""
    print(f"\nCounted: {results['counted_seconds']:.0f} s")
    for name, viewer in results["viewers"].items():
        rate, worst, age = viewer["frames_per_s"], viewer["worst_10_s_frames_per_s"], viewer["age_s"]
        figures = [f"{rate:.1f} frames/s ({rate / TARGET_FRAMES_PER_S:.2f} times the target of {TARGET_FRAMES_PER_S:g})"]
        if worst is not None:
            figures.append(f"worst 10 s {worst:.1f}")
        if viewer["longest_gap_s"] is not None:
            figures.append(f"longest gap {1000 * viewer['longest_gap_s']:.0f} ms")
        if age is not None:
            figures.append(f"age {in_ms(age)}")
        print(f"{name}: {'; '.join(figures)} {viewer['failure']}".rstrip())
    print(f"stop, by HTTP: {in_ms(results['stop_s'])}; the target is {1000 * TARGET_STOP_S:.0f} ms")
    if results["stop_at_start_s"] is not None:
        print(f"stop, by HTTP, while cameras are opened and clients connect: {in_ms(results['stop_at_start_s'])}")
    if results["button"] is not None:
        report_clicks(results["button"])
    memory, growth, threads = results["memory_mb"], results["memory_growth"], results["threads"]
    parts = f"{memory['start']:.0f} MB, later {memory['end']:.0f} MB: {growth:.3f} x; at most {memory['most']:.0f} MB"
    print(f"Memory: {parts}; with mapped files {memory['with_files']:.0f} MB")
    cores = f"{results['cores_used']:.2f} cores"
    print(f"Processor time of the server: {cores}; threads: {threads['start']:.0f}, at most {threads['most']:.0f}")
    print(f"Wake-up delay of a sleeping thread: {in_ms(results['pauses_s'])}; load of the machine: {results['load']}")
    print(f"Runs by outcome: {results['runs']}; replies to moves without control: {results['intruders']}")
    print(f"Leaked sockets: {results['left_over']['sockets']:.0f}; exit code {results['exit_code']}")
    print(f"Problems: {results['problems'] or 'none'}")


def report_clicks(button: dict[str, Any]) -> None:
    """Print how long clicks on the stop button took, and how many failed."""
    print(f"Clicks on the stop button: {button['clicks']}, of which {button['failed']} failed")
    for reason in button["reasons"]:
        print(f"  failed: {reason}")
    if button["click_s"] is not None:
        print(f"stop, until the browser had clicked: {in_ms(button['click_s'])}")
    if button["reply_s"] is not None:
        print(f"stop, from the click in the page: {in_ms(button['reply_s'])}; the target is {1000 * TARGET_BUTTON_S:.0f} ms")
