"""A capture over the port is what the rig measured: every sample once, in SI, from the wire log alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from command import knobcam, refused
from peer import Nth, Peer

import knobcam as kc
from knobcam.rig import port as port_module
from knobcam.rig.emulator import EmulatedRig
from knobcam.rig.figures import Figures
from knobcam.rig.leadin import led_in
from knobcam.rig.record import Enough, log_path

SPEED = 8.0


@pytest.fixture(scope="module")
def rig() -> Iterator[EmulatedRig]:
    with EmulatedRig("knob3", speed=SPEED, noise=False) as rig:
        yield rig


def test_every_sample_of_a_motion_arrives_and_is_what_was_commanded(rig: EmulatedRig, tmp_path: Path) -> None:
    capture = kc.record(rig.port, "sweep", duration_s=3.0, output=tmp_path / "a.npz")
    track = led_in(kc.motion("sweep", 3.0), 5000.0)
    assert capture.samples == len(track.t) and capture.mask.all() and capture.findings == ()
    assert capture.meta["account"]["missing"] == 0
    np.testing.assert_allclose(capture.t, track.t, atol=1e-12)
    start = capture.theta[0] - track.theta[0]
    assert capture.omega is not None and capture.alpha is not None
    np.testing.assert_allclose(capture.theta, start + track.theta, atol=1e-5)
    np.testing.assert_allclose(capture.omega, track.omega, atol=3e-4)
    np.testing.assert_allclose(capture.alpha, track.alpha, atol=0.4)


def test_who_has_seen_enough_ends_the_run_and_has_what_came(rig: EmulatedRig, tmp_path: Path) -> None:
    def watch(figures: Figures) -> None:
        if figures.received > 5000:
            raise Enough

    capture = kc.record(rig.port, "turns", duration_s=30.0, output=tmp_path / "a.npz", progress=watch)
    account = capture.meta["account"]
    assert 5000 < capture.samples == account["received"] == account["produced"] < 150_000
    assert kc.load(tmp_path / "a.npz").samples == capture.samples


def test_the_torque_is_that_of_the_knob(rig: EmulatedRig, tmp_path: Path) -> None:
    capture = kc.record(rig.port, "turns", duration_s=4.0, output=tmp_path / "a.kcwire")
    knob, fit = kc.Model.load("knob3"), kc.fit(capture)
    for name in ("coulomb.neg", "coulomb.pos", "inertia.M", "viscous.pos"):
        assert fit.params[name].value == pytest.approx(knob.params[name].value, rel=0.05), name


@pytest.mark.parametrize("motion", ["sweep", "multisine", "turns", "micro"])
def test_a_motion_is_led_in_from_rest_without_a_jump(motion: str) -> None:
    rate = 5000.0
    track = kc.motion(motion, 2.0)
    led = led_in(track, rate)
    assert [column[0] for column in led] == [0.0, 0.0, 0.0, 0.0]
    np.testing.assert_array_equal(led.theta[-len(track.t) :], track.theta)
    # Speed is the slope of the angle, acceleration that of the speed, also across the joint.
    lead = slice(0, len(led.t) - len(track.t) + 5)
    for value, slope in ((led.theta, led.omega), (led.omega, led.alpha)):
        middle = 0.5 * (slope[1:] + slope[:-1])[lead]
        np.testing.assert_allclose(np.diff(value)[lead] * rate, middle, atol=2e-3 * np.ptp(slope) + 1e-9)


def test_what_a_hand_does_is_recorded_without_a_motor(rig: EmulatedRig, tmp_path: Path) -> None:
    capture = kc.record(rig.port, "hand", duration_s=1.0, output=tmp_path / "a.kcwire")
    assert capture.samples == 5000 and np.ptp(capture.theta) > 0.0


def test_a_model_is_rendered_while_the_motion_moves_it(rig: EmulatedRig, tmp_path: Path) -> None:
    other = kc.Model.load("knob1")
    capture = kc.record(rig.port, "turns", duration_s=3.0, model=other, output=tmp_path / "a.kcwire")
    assert kc.WireLog.load(tmp_path / "a.kcwire").header["model"] == other.text()
    assert kc.fit(capture).params["coulomb.pos"].value == pytest.approx(
        other.params["coulomb.pos"].value, rel=0.1
    )


def test_one_link_makes_many_runs_and_a_log_of_each(rig: EmulatedRig, tmp_path: Path) -> None:
    with kc.Link(rig.port) as link:
        for name in ("a", "b"):
            capture = kc.record(link, "micro", duration_s=0.5, output=tmp_path / f"{name}.kcwire")
            assert capture.meta["account"]["missing"] == 0
    runs = [kc.load(tmp_path / f"{name}.kcwire").meta["run"] for name in ("a", "b")]
    assert runs[1] == runs[0] + 1


def test_a_rig_is_found_by_its_serial_number(rig: EmulatedRig, tmp_path: Path) -> None:
    with kc.Link.to(rig.serial_number, [str(tmp_path / "absent"), rig.port]) as link:
        assert link.port == rig.port
    with pytest.raises(kc.InputError, match=rf"no rig XX-1 is found .*{rig.serial_number}"):
        kc.Link.to("XX-1", [rig.port])


def test_a_calibration_takes_the_place_of_the_nominal_sensitivity(rig: EmulatedRig, tmp_path: Path) -> None:
    more = SimpleNamespace(c_cal=1.05 * 1148.0, date="2026-01-01")
    calibrated = kc.record(rig.port, "sweep", duration_s=1.0, calibration=more, output=tmp_path / "a.kcwire")
    log = kc.WireLog.load(tmp_path / "a.kcwire")
    nominal = log.capture(calibration=SimpleNamespace(c_cal=1148.0))
    assert calibrated.alpha is not None and nominal.alpha is not None
    np.testing.assert_allclose(calibrated.alpha, 1.05 * nominal.alpha)
    assert "2026-01-01" in kc.load(log.path).meta["calibration"]["from"]


def test_the_port_is_read_by_python_where_the_core_cannot(
    rig: EmulatedRig, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(port_module, "READS_ITSELF", False)
    capture = kc.record(rig.port, "turns", duration_s=2.0, output=tmp_path / "a.kcwire")
    assert capture.meta["account"]["missing"] == 0


def test_lost_chunks_of_an_upload_are_sent_again(tmp_path: Path) -> None:
    lossy = Nth("EXCITE", {1, 7, 8, 20, 40})
    with Peer(hears=lossy, noise=False) as peer:
        capture = kc.record(peer.port, "sweep", duration_s=1.0, output=tmp_path / "a.kcwire")
    track = led_in(kc.motion("sweep", 1.0), 5000.0)
    np.testing.assert_allclose(capture.theta, track.theta, atol=1e-5)


@pytest.mark.parametrize("lost", ["ARM", "START", "DISARM", "STOP"])
def test_a_command_that_got_lost_is_repeated(lost: str, tmp_path: Path) -> None:
    with Peer(hears=Nth(lost, {0})) as peer:
        capture = kc.record(peer.port, "micro", duration_s=0.5, output=tmp_path / "a.kcwire")
        assert capture.meta["account"]["missing"] == 0
        assert peer.state == "idle"


@pytest.mark.parametrize("lost", ["ACK", "STARTED", "STOPPED"])
def test_an_answer_that_got_lost_costs_no_sample(lost: str, tmp_path: Path) -> None:
    with Peer(says=Nth(lost, {0})) as peer:
        capture = kc.record(peer.port, "hand", duration_s=0.5, output=tmp_path / "a.kcwire")
        assert capture.samples == 2500


def test_what_the_line_loses_stays_a_gap(tmp_path: Path) -> None:
    def damaged(frame: bytes) -> bytes:
        return frame[:20] + b"\x55" + frame[21:]

    says = Nth("DATA", {3, 4, 30}, damaged)
    with Peer(says=says) as peer:
        capture = kc.record(peer.port, "turns", duration_s=1.0, output=tmp_path / "a.kcwire")
    account = capture.meta["account"]
    assert (account["missing"], account["gaps"], account["lost_on_the_way"]) == (75, 2, 75)
    assert capture.samples == account["produced"] - 75
    assert np.count_nonzero(np.diff(capture.t) > 1.5 / 5000.0) == 2
    assert {finding.kind for finding in capture.findings} == {"gap", "corrupt"}


def test_a_capture_that_no_rig_made_is_exported_too(tmp_path: Path) -> None:
    kc.simulate("knob3", duration_s=0.5).save(tmp_path / "simulated.npz")
    ended = knobcam("export", tmp_path / "simulated.npz", "-o", tmp_path / "simulated.csv", "--json")
    assert ended.code == 0, ended
    assert ended.document["capture"]["planned"] is None
    assert kc.load(tmp_path / "simulated.csv").samples == 2500


def test_the_command_writes_the_log_beside_the_capture_and_exports_it(
    rig: EmulatedRig, tmp_path: Path
) -> None:
    output = tmp_path / "run.csv.gz"
    ended = knobcam("capture", "--port", rig.port, "--duration", "1", "-o", output, "--json")
    assert ended.code == 0, ended
    document = ended.document
    assert document["schema"] == "knobcam.capture/1" and document["capture"]["missing"] == 0
    assert document["files"] == {"log": str(tmp_path / "run.kcwire"), "capture": str(output)}
    exported = knobcam("export", tmp_path / "run.kcwire", "-o", tmp_path / "run.npz")
    assert exported.code == 0, exported
    np.testing.assert_array_equal(kc.load(tmp_path / "run.npz").tau, kc.load(output).tau)
    refused(knobcam("capture", "--port", rig.port, "-o", output), "run.kcwire", "not written over")
    (tmp_path / "run.kcwire").unlink()
    before = output.read_bytes()
    words = ("capture", "--port", rig.port, "--duration", "1", "-o", output)
    refused(knobcam(*words), "run.csv.gz", "is there already", "--overwrite")
    assert output.read_bytes() == before and not (tmp_path / "run.kcwire").exists()
    assert knobcam(*words, "--overwrite").code == 0 and output.read_bytes() != before


def test_the_log_stands_beside_its_output() -> None:
    assert log_path("x/a.kcwire") == Path("x/a.kcwire")
    assert log_path("x/a.csv.gz") == Path("x/a.kcwire")
    assert log_path("a.b.npz") == Path("a.b.kcwire")
