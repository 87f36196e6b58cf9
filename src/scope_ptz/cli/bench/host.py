"""``scope bench keygen`` and ``scope bench host``: evaluate other people's agents on private tasks, and sign the results."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from scope_ptz.cli.bench.flags import SPLITS
from scope_ptz.cli.exit import put, put_json, run_async
from scope_ptz.cli.options import JsonOption, PortOption
from scope_ptz.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from scope_ptz.serve.bench_host.host import Host
    from scope_ptz.serve.security.access import Access
    from scope_ptz.serve.security.tokens import TokenFile

_PACKAGES = ("cryptography", "fastapi", "inspect_ai", "mcp", "mcp_types", "scipy", "starlette", "uvicorn")


def keygen(
    out: Annotated[Path, typer.Option("--out", "-o", help="File for the private key. The public key gets the suffix .pub.")],
    as_json: JsonOption = False,
) -> None:
    """Create the Ed25519 key with which a host signs results. The private key is written to a file and never shown."""
    with _explain_missing_package():
        from scope_ptz.bench.signatures.keys import fingerprint, generate_key, public_path, raw_bytes

        key_fingerprint = fingerprint(raw_bytes(generate_key(out)))
    if as_json:
        put_json({"private_key": str(out), "public_key": str(public_path(out)), "fingerprint": key_fingerprint})
        return
    put(f"{key_fingerprint}  {public_path(out)}")
    put(public_path(out).read_text("ascii").rstrip())
    sys.stderr.write(f"The private key is {out}. Keep it secret: whoever has it can sign results in your name.\n")


def host(
    tasks: Annotated[str, typer.Option("--tasks", help=f"Task file (JSONL), or split ({SPLITS}).")],
    key: Annotated[Path, typer.Option("--key", help="Private key that signs the results; see `scope bench keygen`.")],
    out: Annotated[
        Path, typer.Option("--out", help="Folder of the host: tokens, journals, logs and submissions. An existing one is resumed.")
    ],
    participant: Annotated[
        list[str] | None,
        typer.Option("--participant", help="Register a participant and print its token once (repeatable)."),
    ] = None,
    address: Annotated[
        str, typer.Option("--host", help="Address to listen on. Outside loopback, use a proxy that terminates TLS.")
    ] = "127.0.0.1",
    port: PortOption = 8000,
    name: Annotated[
        list[str] | None, typer.Option("--name", help="Additional host name, such as that of a proxy (repeatable).")
    ] = None,
    perception: Annotated[
        str | None, typer.Option("--perception", help="Perception for all participants (default: ground truth).")
    ] = None,
    perception_url: Annotated[str | None, typer.Option("--perception-url", help="Address of the perception server.")] = None,
    perception_model: Annotated[
        str | None, typer.Option("--perception-model", help="Name of the perception model on its server.")
    ] = None,
    perception_key_file: Annotated[
        Path | None, typer.Option("--perception-key-file", help="File with the key of the perception server.")
    ] = None,
    perception_option: Annotated[
        list[str] | None, typer.Option("--perception-option", help="Option of the perception backend, NAME=VALUE (repeatable).")
    ] = None,
    epochs: Annotated[int, typer.Option("--epochs", min=1, help="Number of runs of each task.")] = 1,
    seed: Annotated[int, typer.Option("--seed", help="Seed for noisy perception. The task order has a secret seed.")] = 1,
    max_steps: Annotated[int, typer.Option("--max-steps", min=1, help="Maximum number of steps of a run.")] = 60,
    step_time: Annotated[float, typer.Option("--step-time", min=1, help="Seconds that an agent may take for a step.")] = 300.0,
    task_time: Annotated[float, typer.Option("--task-time", min=1, help="Seconds that an agent may take for a task.")] = 1800.0,
    until_done: Annotated[bool, typer.Option("--until-done", help="Exit when every participant has finished.")] = False,
    close: Annotated[
        bool,
        typer.Option("--close", help="Do not listen. Count all unfinished tasks as failed, sign the results, and exit."),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Evaluate agents that connect over HTTP or MCP, without revealing the answers to the tasks, and sign the results.

    Each participant gets its own task order, log and submission. A task can be attempted once. Running the same command again
    resumes after an interruption. See docs/hosting.md.
    """
    with _explain_missing_package():
        from scope_ptz.serve.bench_host.host import Host, lock_folder, participants_file
        from scope_ptz.serve.bench_host.wire import EvaluationSettings, PerceptionSettings
        from scope_ptz.serve.security.access import Access
        from scope_ptz.serve.security.tokens import TokenFile

    settings = EvaluationSettings(
        tasks=tasks if not Path(tasks).is_file() else str(Path(tasks).resolve()),
        perception=PerceptionSettings(
            perception=perception,
            perception_url=perception_url,
            perception_model=perception_model,
            perception_key_file=perception_key_file.resolve() if perception_key_file is not None else None,
            perception_options=tuple(perception_option or ()),
        ),
        epochs=epochs,
        seed=seed,
        max_steps=max_steps,
        step_s=step_time,
        task_s=task_time,
    )
    with lock_folder(out):
        tokens = TokenFile(participants_file(out))
        _register(tokens, participant or [], as_json=as_json)
        if not tokens.tokens:
            raise InputError("The host has no participants. Register one with --participant NAME.")

        async def work() -> None:
            bench_host = Host(out, settings, key, fail_unfinished=close, notify=lambda line: _print_result(line, as_json=as_json))
            run_count = await bench_host.check()
            if close:
                await _finish_and_close(bench_host)
                return
            await _serve(
                bench_host, Access(address, bench_host.tokens, tuple(name or ())), port, run_count, until_done, as_json=as_json
            )

        run_async(work)


async def _serve(bench_host: Host, access: Access, port: int, run_count: int, until_done: bool, *, as_json: bool) -> None:
    import asyncio

    from scope_ptz.serve.bench_host.application import serve_host

    async with serve_host(bench_host, access, port=port) as bound_port:
        address = f"[{access.host}]" if ":" in access.host else access.host  # IPv6 addresses need brackets.
        url, names = f"http://{address}:{bound_port}", [token.name for token in bench_host.tokens.tokens]
        if as_json:
            put_json({"url": url, "participants": names, "runs": run_count})
        else:
            put(f"Evaluating {', '.join(names)} on {run_count} runs at {url}/api/v1/messages, and over MCP at {url}/mcp.")
            put("Press Ctrl-C to stop. Running the same command again resumes the evaluation.")
        sys.stdout.flush()
        completion = asyncio.ensure_future(bench_host.wait_until_finished(start=False))
        try:
            await completion
            if not until_done:
                await asyncio.Event().wait()
        finally:
            completion.cancel()


async def _finish_and_close(bench_host: Host) -> None:
    try:
        await bench_host.wait_until_finished(start=True)
    finally:
        await bench_host.close()


def _register(tokens: TokenFile, names: list[str], *, as_json: bool) -> None:
    """Register new participants, and print their tokens once."""
    for name in dict.fromkeys(names):
        if any(token.name == name for token in tokens.tokens):
            continue
        secret = tokens.add(name, "viewer")
        if as_json:
            put_json({"participant": name, "token": secret})
        else:
            put(f"Token for {name} (it cannot be shown again): {secret}")


def _print_result(line: str, *, as_json: bool) -> None:
    if as_json:
        put_json({"finished": line})
    else:
        put(line)
    sys.stdout.flush()


@contextmanager
def _explain_missing_package() -> Iterator[None]:
    """Convert the error for a missing package to an ``InputError`` that states how to install the package."""
    try:
        yield
    except ModuleNotFoundError as error:
        if (package := (error.name or "").split(".")[0]) not in _PACKAGES:
            raise
        raise InputError(
            f"Hosting requires the package {package}. Install it with: pip install 'scope-ptz[bench,serve]'."
        ) from error
