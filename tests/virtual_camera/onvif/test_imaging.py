"""The Imaging service, driven by onvif-zeep-async."""

from __future__ import annotations

from typing import Any

import pytest
from zeep.exceptions import Fault

from scope_ptz.virtual_camera.device import VirtualDevice
from tests.virtual_camera.onvif.test_client import subcodes

pytestmark = pytest.mark.anyio


@pytest.fixture
async def imaging(client: Any) -> Any:
    return await client.create_imaging_service()


@pytest.fixture
async def source(client: Any) -> dict[str, str]:
    media = await client.create_media_service()
    return {"VideoSourceToken": (await media.GetVideoSources())[0].token}


async def test_options_and_settings_agree(imaging: Any, source: dict[str, str]) -> None:
    options, settings = await imaging.GetOptions(source), await imaging.GetImagingSettings(source)
    assert settings.Focus.AutoFocusMode in options.Focus.AutoFocusModes
    assert settings.Exposure.Mode in options.Exposure.Mode
    assert options.Exposure.Iris.Min <= settings.Exposure.Iris <= options.Exposure.Iris.Max


async def test_focus_moves_and_reports_its_position(imaging: Any, source: dict[str, str], device: VirtualDevice) -> None:
    options = await imaging.GetMoveOptions(source)
    assert (options.Absolute.Position.Min, options.Absolute.Position.Max) == (0.0, 1.0)
    before = (await imaging.GetStatus(source)).FocusStatus20
    assert before.MoveStatus == "IDLE"
    await imaging.Move({**source, "Focus": {"Relative": {"Distance": -0.2}}})
    assert (await imaging.GetStatus(source)).FocusStatus20.MoveStatus == "MOVING"
    await imaging.Stop(source)
    after = (await imaging.GetStatus(source)).FocusStatus20
    assert after.MoveStatus == "IDLE"
    assert after.Position <= before.Position
    assert (await imaging.GetImagingSettings(source)).Focus.AutoFocusMode == "MANUAL"
    await imaging.Move({**source, "Focus": {"Continuous": {"Speed": 1.0}}})
    assert device.lens.is_focusing
    await imaging.SetImagingSettings({**source, "ImagingSettings": {"Focus": {"AutoFocusMode": "AUTO"}}})
    assert device.lens.autofocus


async def test_iris_is_an_attenuation(imaging: Any, source: dict[str, str], device: VirtualDevice) -> None:
    await imaging.SetImagingSettings({**source, "ImagingSettings": {"Exposure": {"Mode": "MANUAL", "Iris": 0.0}}})
    assert (device.lens.autoiris, device.lens.iris) == (False, 1.0)
    bright = device.expose().image.mean()
    await imaging.SetImagingSettings({**source, "ImagingSettings": {"Exposure": {"Mode": "MANUAL", "Iris": 20.0}}})
    assert device.expose().image.mean() < bright
    assert device.lens.autofocus  # what a request does not name stays as it is
    await imaging.SetImagingSettings({**source, "ImagingSettings": {"Exposure": {"Mode": "AUTO"}}})
    assert device.lens.autoiris


@pytest.mark.parametrize(
    "focus",
    [{"Absolute": {"Position": 2.0}}, {"Relative": {"Distance": -7.0}}, {"Continuous": {"Speed": float("nan")}}, {}],
)
async def test_wrong_moves_are_refused(imaging: Any, source: dict[str, str], device: VirtualDevice, focus: Any) -> None:
    with pytest.raises(Fault) as refused:
        await imaging.Move({**source, "Focus": focus})
    assert subcodes(refused.value) == ["InvalidArgVal", "SettingsInvalid"]
    assert device.lens.autofocus


async def test_unknown_sources_are_refused(imaging: Any) -> None:
    for operation in ("GetImagingSettings", "GetOptions", "GetMoveOptions", "GetStatus", "Stop"):
        with pytest.raises(Fault) as refused:
            await getattr(imaging, operation)({"VideoSourceToken": "nowhere"})
        assert subcodes(refused.value) == ["InvalidArgVal", "NoSource"]
