"""The Home Assistant configuration in the documentation works with a running server.

The tests read the YAML of the page, render its templates with Jinja, which Home Assistant also uses, and send the requests.
``HomeAssistant`` is a deliberate stand-in that understands the parts of automations that the page uses.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import httpx2
import pytest
import yaml
from jinja2 import Environment, StrictUndefined

from scope_ptz.serve.security.access import Access
from scope_ptz.serve.security.rate_limits import RateLimits
from scope_ptz.serve.security.tokens import TokenFile
from scope_ptz.serve.site.site import SiteOptions
from tests.serve.conftest import SPEC
from tests.serve.serving import Served, serving

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "home-assistant.md").read_text(encoding="utf-8")
HOST = "scope.local"
ROOT = f"http://{HOST}:8000"
CAMERA, PRESET = "yard-gate", "gate"


class Secret(str):
    """The name of a secret."""


class Loader(yaml.SafeLoader):
    """Reads YAML with the tag ``!secret``."""


Loader.add_constructor("!secret", lambda loader, node: Secret(node.value))

BLOCKS = [yaml.load(text, Loader) for text in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)]  # noqa: S506 - a safe loader
SECRETS = BLOCKS[0]
COMMANDS = BLOCKS[1]["rest_command"]
QUESTION, COUNT = (block["automation"][0] for block in BLOCKS[2:])

TEMPLATES = Environment(undefined=StrictUndefined, autoescape=False)  # noqa: S701 - these templates produce no HTML
TEMPLATES.filters["to_json"] = json.dumps  # a filter of Home Assistant


class _Stop(Exception):  # noqa: N818 - the end of an automation is no error
    """The action ``stop``."""


class HomeAssistant:
    """A stand-in for the parts of Home Assistant that the page uses. ``actions`` lists the actions of other integrations."""

    def __init__(self, client: httpx2.Client, token: str, **variables: Any) -> None:
        self._client, self._token, self._overrides = client, token, variables
        self.actions = list[tuple[str, dict[str, Any]]]()
        self.replies = dict[str, httpx2.Response]()

    def run(self, automation: dict[str, Any]) -> None:
        """Run the actions of an automation."""
        try:
            self._sequence(automation["actions"], automation["variables"] | self._overrides)
        except _Stop:
            return

    def _sequence(self, steps: Sequence[dict[str, Any]], variables: dict[str, Any]) -> None:
        for step in steps:
            if "stop" in step:
                raise _Stop
            if "if" in step:
                true = _render(step["if"], variables) == "True"
                self._sequence(step["then"] if true else step.get("else", ()), variables)
                continue
            domain, _, name = step["action"].partition(".")
            data = {key: _render(value, variables) for key, value in step.get("data", step.get("target", {})).items()}
            if domain != "rest_command":
                self.actions.append((step["action"], data))
                continue
            reply = self._request(COMMANDS[name], data)
            self.replies[name] = reply
            if "response_variable" in step:
                is_json = reply.headers["content-type"] == "application/json"
                content = reply.json() if is_json else reply.text
                variables[step["response_variable"]] = {"status": reply.status_code, "content": content}

    def _request(self, command: dict[str, Any], data: dict[str, Any]) -> httpx2.Response:
        assert set(command) <= {"url", "method", "headers", "content_type", "payload", "timeout"}
        headers = {
            name: SECRETS[value].replace("scope_...", self._token) if isinstance(value, Secret) else value
            for name, value in command["headers"].items()
        }
        if "content_type" in command:
            headers["Content-Type"] = command["content_type"]
        content = _render(command["payload"], data).encode() if "payload" in command else None
        address = _render(command["url"], data)
        assert address.startswith(ROOT)
        return self._client.request(command["method"], address.removeprefix(ROOT), headers=headers, content=content)


def _render(template: Any, variables: dict[str, Any]) -> str:
    return TEMPLATES.from_string(str(template)).render(**variables)


@pytest.fixture(scope="module")
def site(scenes: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, dict[str, str]]]:
    """A server with the camera, the preset and the tokens of the page, and a token of another operator."""
    folder = tmp_path_factory.mktemp("home-assistant")
    file = TokenFile(folder / "tokens.json")
    created = re.findall(r"scope token add (\S+) --role (\S+)", PAGE)
    assert [role for _, role in created] == ["operator", "viewer"]
    tokens = {role: file.add(name, role) for name, role in created} | {"other": file.add("ben", "operator")}
    access = Access("127.0.0.1", file, hosts=(HOST,), limits=RateLimits(None))
    with serving(SiteOptions(folder / "runs"), access, {CAMERA: SPEC}) as served:
        with served.client(tokens["operator"]) as client:
            assert client.put(f"/cameras/{CAMERA}/presets/{PRESET}", json={}).status_code == 200
        yield served, tokens


@pytest.fixture
def client(site: tuple[Served, dict[str, str]]) -> Iterator[httpx2.Client]:
    """A client that reaches the server under the name on the page, of a camera that nobody controls."""
    served, _ = site
    for station in served.site.stations.values():
        served.call(station.control.clear)
    with httpx2.Client(base_url=served.root, headers={"Host": f"{HOST}:8000"}, timeout=60.0, trust_env=False) as opened:
        yield opened


@pytest.fixture
def tokens(site: tuple[Served, dict[str, str]]) -> dict[str, str]:
    return site[1]


def test_the_automation_shows_the_answer(client: httpx2.Client, tokens: dict[str, str]) -> None:
    home = HomeAssistant(client, tokens["operator"], question="how many balls are there?")
    home.run(QUESTION)
    assert {name: reply.status_code for name, reply in home.replies.items()} == {
        "scope_go_to_preset": 200, "scope_ask": 200, "scope_release_control": 200,
    }  # fmt: skip
    answer = home.replies["scope_ask"].json()["answer"]
    assert "2 balls" in answer
    assert home.actions == [("persistent_notification.create", {"title": "how many balls are there?", "message": answer})]
    control = client.get(f"/api/v1/cameras/{CAMERA}/control", headers={"Authorization": f"Bearer {tokens['other']}"})
    assert control.json()["holder"] is None, "the automation leaves the camera to others"


def test_the_question_of_the_page_is_understood(client: httpx2.Client, tokens: dict[str, str]) -> None:
    home = HomeAssistant(client, tokens["operator"])
    home.run(QUESTION)
    assert home.replies["scope_ask"].status_code == 200
    ((_, shown),) = home.actions
    assert shown["message"]


def test_text_with_quotes_and_slashes_is_passed_on_unchanged(client: httpx2.Client, tokens: dict[str, str]) -> None:
    question = 'what is "behind" the \\ ball {{ 1 }}?'
    home = HomeAssistant(client, tokens["operator"], question=question)
    home.run(QUESTION)
    assert home.replies["scope_ask"].json()["instruction"] == question
    home = HomeAssistant(client, tokens["operator"], preset="no such place?x=1")
    home.run(QUESTION)
    assert home.actions[0][1]["message"].startswith("There is no preset 'no such place?x=1'.")


def test_the_automation_reports_why_there_is_no_answer(client: httpx2.Client, tokens: dict[str, str]) -> None:
    home = HomeAssistant(client, tokens["operator"], question="sing a song")
    home.run(QUESTION)
    assert home.replies["scope_ask"].json()["outcome"] != "answered"
    assert home.actions == [
        ("persistent_notification.create", {"title": "No answer", "message": home.replies["scope_ask"].json()["answer"]})
    ]
    home = HomeAssistant(client, tokens["operator"], question="")
    home.run(QUESTION)
    assert home.actions[0][1]["message"] == home.replies["scope_ask"].json()["error"]["message"]


def test_the_automation_stops_if_somebody_else_controls_the_camera(client: httpx2.Client, tokens: dict[str, str]) -> None:
    taken = client.post(f"/api/v1/cameras/{CAMERA}/control", headers={"Authorization": f"Bearer {tokens['other']}"})
    assert taken.json()["holder"] == "ben"
    home = HomeAssistant(client, tokens["operator"])
    home.run(QUESTION)
    assert set(home.replies) == {"scope_go_to_preset"}
    ((_, shown),) = home.actions
    assert shown["title"] == "The camera did not move"
    assert "ben" in shown["message"]


@pytest.mark.parametrize(("description", "acts"), [("balls", True), ("red cubes", False), ("", False)])
def test_a_count_decides_about_an_action(client: httpx2.Client, tokens: dict[str, str], description: str, acts: bool) -> None:
    HomeAssistant(client, tokens["operator"]).run(QUESTION)  # the camera looks at the preset
    home = HomeAssistant(client, tokens["operator"], description=description)
    home.run(COUNT)
    assert home.actions == ([("light.turn_on", {"entity_id": "light.gate"})] if acts else [])


def test_the_addresses_of_the_pictures(client: httpx2.Client, tokens: dict[str, str]) -> None:
    stream, still = (address.removeprefix(ROOT) for address in re.findall(r"\| `(http\S+)` \|", PAGE))
    authentication = ("home-assistant-picture", tokens["viewer"])
    picture = client.get(still, auth=authentication)
    assert (picture.status_code, picture.headers["content-type"]) == (200, "image/jpeg")
    with client.stream("GET", stream, auth=authentication) as reply:
        assert reply.headers["content-type"].startswith("multipart/x-mixed-replace")
        assert next(reply.iter_bytes()).startswith(b"--")
    for wrong in (None, ("home-assistant-picture", "scope_wrong"), (tokens["viewer"], "")):
        assert client.get(still, auth=wrong).status_code == 401
    assert client.post(f"/api/v1/cameras/{CAMERA}/home", auth=authentication).status_code == 403
