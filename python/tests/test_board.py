"""Sketches under test: pins, ports, claims."""

from __future__ import annotations

import copy
import importlib.metadata
import pathlib
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest

import rumbo

SKETCH = """
void setup() {
  Serial.begin(115200);
  Serial1.begin(9600);
  pinMode(7, OUTPUT);
  pinMode(8, INPUT_PULLUP);
  delay(100);
  Serial.println("ready");
}

void loop() {
  if (Serial.read() == 'P') {
    PORTH |= 1 << 4;
    __builtin_avr_delay_cycles(798);
    PORTH &= ~(1 << 4);
    Serial.print("A0=");
    Serial.println(analogRead(A0));
    Serial.print("8=");
    Serial.println(digitalRead(8));
  }
  int got = Serial1.read();
  if (got >= 0) {
    Serial1.print("got ");
    Serial1.println(char(got));
    analogWrite(9, 128);
  }
}
"""


@pytest.fixture(scope="session")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    folder = tmp_path_factory.mktemp("sketches") / "hello"
    folder.mkdir()
    (folder / "hello.ino").write_text(SKETCH)
    return folder


@pytest.fixture(scope="session")
def image(sketch: pathlib.Path) -> pathlib.Path:
    try:
        return rumbo.compile_sketch(sketch)
    except ValueError as error:
        if "arduino" in str(error):
            pytest.skip(str(error))
        raise


def test_a_run_and_a_sweep_take_a_sketch_as_they_take_its_image(sketch: pathlib.Path, image: pathlib.Path) -> None:
    run = rumbo.run("mode1", sketch=sketch, trace=True)[0]
    of_image = rumbo.run("mode1", firmware=image, trace=True)[0]
    assert run.metrics == of_image.metrics and run.trace is not None and not run.passed
    swept = rumbo.sweep("mode1", {"battery.open_circuit_v": [7.4]}, seeds=1, sketch=sketch)
    assert not swept.passed.any()
    with pytest.raises(ValueError, match="one program: give sketch= or firmware=, not both"):
        rumbo.run("mode1", sketch=sketch, firmware=image)


def test_a_port_says_what_is_expected_and_what_came_instead(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    assert sim.serial.expect("ready", within_s=1) == "ready"
    assert 0.1 <= sim.t_s <= 0.12
    sim.serial.write("P", "none")
    match = sim.serial.expect(re.compile(r"A0=(\d+)"))
    assert match[1].isdigit()
    sim.step(0.1)
    assert sim.serial.read() == "\n8=1\n"
    assert sim.serial.lines[0] == "ready"
    sim.serial.write("P", "none")
    with pytest.raises(rumbo.ExpectationError, match=r"did not send 'set', but .*8=1.* within 0\.2 s"):
        sim.serial.expect("set", within_s=0.2)


def test_a_pulse_is_exact_to_the_cycle(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    sim.serial.expect("ready")
    assert sim.pin(7).pulses().shape == (0, 2)
    sim.serial.write("P")
    sim.pin(7).expect()
    # 798 cycles, and what a byte of a port beyond the reach of SBI takes: 2 for LDS, 1 for ANDI, 2 for STS.
    [[at_s, width_us]] = sim.pin(7).pulses()
    assert width_us == (798 + 5) / 16
    times, rises = sim.pin(7).edges()
    assert list(rises) == [True, False] and times[0] == at_s
    assert times[1] - times[0] == pytest.approx(width_us * 1e-6, abs=1e-12)


def test_what_is_applied_to_a_pin_is_read_until_it_is_released(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    sim.serial.expect("ready")
    sim.pin("A0").apply(2.5)
    sim.pin(8).drive(False)
    sim.serial.write("P")
    sim.serial.expect("A0=512")
    sim.serial.expect("8=0")
    sim.pin(8).release()
    sim.serial.write("P")
    sim.serial.expect("8=1")


def test_the_module_passes_on_and_a_timer_s_pulses_are_there(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    sim.advance(until=0.2)
    sim.bluetooth.write("x", "none")
    sim.bluetooth.expect("got x")
    assert sim.usart(1).read() == "got x\n"
    began_s = sim.t_s
    sim.step(0.5)
    assert sim.pin(9).duty(began_s) == pytest.approx(0.502, abs=0.001)
    pulses = sim.pin(9).pulses(began_s)
    assert np.diff(pulses[:, 0]) == pytest.approx(510 * 64 / 16e6)


def test_a_copy_and_a_pickle_go_on_to_the_same_bits(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    sim.serial.expect("ready")
    sim.serial.write("P")
    others = [copy.deepcopy(sim), pickle.loads(pickle.dumps(sim))]
    kept = pickle.loads(pickle.dumps(sim.snapshot()))
    sim.step(0.2)
    for other in others:
        other.step(0.2)
        assert other.serial.text == sim.serial.text
        assert (other.pin(7).pulses() == sim.pin(7).pulses()).all()
    text = sim.serial.text
    sim.serial.write("P")
    sim.step(0.2)
    assert sim.serial.text != text
    sim.restore(kept)
    sim.step(0.2)
    assert sim.serial.text == text


def test_what_cannot_be_is_said(image: pathlib.Path) -> None:
    sim = rumbo.Sim(firmware=image)
    for wrong, act in [
        ("did you mean `left_enable`", lambda: sim.pin("lef_enable")),
        ("0 to A15", lambda: sim.pin(99)),
        ("must be 0 to 5", lambda: sim.pin("A0").apply(7)),
        ("must be 0 to 3", lambda: sim.usart(4)),
        ("there are none", lambda: sim.press("start")),
        ("must be one of lf", lambda: sim.serial.write("x", "crlff")),  # type: ignore[arg-type]
        ("no board is emulated", lambda: rumbo.Sim("mode1").serial.text),
        ("not both", lambda: rumbo.Sim(sketch="hello", firmware=image)),
        ("no such file or folder", lambda: rumbo.Sim(sketch="of_nobody")),
        ("0.00 s already", lambda: sim.advance(until=-1)),
        ("pin 7 did not become high within 0.1 s", lambda: sim.pin(7).expect(within_s=0.1)),
        ("moves did not come true", lambda: sim.advance(until=moves, within_s=0.1)),
    ]:
        with pytest.raises((ValueError, rumbo.ExpectationError), match=re.escape(wrong)):
            act()


def moves(sim: rumbo.Sim) -> bool:
    return sim.truth()["forward_m_s"] > 0.1


def test_a_robot_drives_by_its_sketch_and_the_compiler_s_errors_have_their_lines(tmp_path: pathlib.Path) -> None:
    try:
        sim = rumbo.Sim("mode1", sketch="example:wall")
    except ValueError as error:
        pytest.skip(str(error))
    sim.advance(until=moves, within_s=3)
    wrong = tmp_path / "wrong" / "wrong.ino"
    wrong.parent.mkdir()
    wrong.write_text("void setup() {}\nvoid loop() { nothing(); }\n")
    with pytest.raises(ValueError, match=r"wrong\.ino:2.*nothing"):
        rumbo.Sim(sketch=wrong)


def test_a_button_of_the_robot_s_file_is_pressed(image: pathlib.Path, tmp_path: pathlib.Path) -> None:
    robot = rumbo.load("robot", "memoria")
    for wiring in robot["wiring"].values():
        wiring["parts"] = {"start": {"button": 40, "to": "5v"}}
    sim = rumbo.Sim(firmware=image, robot=robot)
    sim.step(0.5)
    assert not sim.pin("start").high
    sim.press("start")
    sim.step(0.1)
    [[at_s, width_us]] = sim.pin("start").pulses()
    assert at_s == pytest.approx(0.5, abs=1e-4) and width_us == pytest.approx(200_000, abs=100)
    sim.press("start", for_s=0.5)
    sim.step(0.1)
    assert sim.pin("start").pulses()[-1, 1] == pytest.approx(500_000, abs=100)


def test_a_key_of_a_remote_control_sends_its_code(image: pathlib.Path) -> None:
    robot = rumbo.load("robot", "memoria")
    for wiring in robot["wiring"].values():
        wiring["parts"] = {"remote": {"infrared": 40}}
    sim = rumbo.Sim(firmware=image, robot=robot)
    sim.step(0.5)
    sim.press("remote", "ok")
    sim.step(0.1)
    leader_us, *bits_us = sim.pin("remote").pulses()[-33:, 1]
    assert leader_us == pytest.approx(4_500, abs=2)
    assert sum((width_us > 1_000) << bit for bit, width_us in enumerate(bits_us)) == 0xE31CFF00
    before = len(sim.pin("remote").pulses())
    sim.press("remote", "ok", for_s=1)
    repeats_us = [width_us for _, width_us in sim.pin("remote").pulses()[before:] if 2_000 < width_us < 2_500]
    # Every 108 ms.
    assert len(repeats_us) in (8, 9)
    for key in ["walk", None]:
        with pytest.raises(ValueError, match="none of its keys: 1, 2, 3"):
            sim.press("remote", key)


def test_a_failed_test_leaves_its_log_and_its_waveform(image: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "test_it.py").write_text(
        f"""
def test_good(rumbo_sim):
    rumbo_sim(firmware={str(image)!r}).serial.expect("ready")

def test_bad(rumbo_sim):
    rumbo_sim(firmware={str(image)!r}).serial.expect("steady", within_s=0.3)
"""
    )
    # An installed package brings the plugin by itself.
    is_installed = "rumbo" in importlib.metadata.entry_points(group="pytest11").names
    plugin = [] if is_installed else ["-p", "rumbo.pytest_plugin"]
    words = ["-m", "pytest", *plugin, "-p", "no:cacheprovider", "-q", "test_it.py"]
    ran = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "1 failed, 1 passed" in ran.stdout, ran.stdout + ran.stderr
    folder = tmp_path / "rumbo-failures" / "test_it.py_test_bad"
    assert "did not send 'steady', but 'ready\\n' within 0.3 s" in ran.stdout
    assert f"rumbo replay {folder.relative_to(tmp_path)}/robot.mcap" in ran.stdout
    log = rumbo.read_log(folder / "robot.mcap")
    assert log.readings["truth"]["t_s"][-1] == pytest.approx(0.3, abs=0.05)
    waves = (folder / "robot.vcd").read_text()
    assert "$timescale 100 ps $end" in waves and "pin_07" in waves
    assert len(list((tmp_path / "rumbo-failures").iterdir())) == 1
