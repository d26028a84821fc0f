//! Devices on the two-wire bus of a sketch's board, a remote control and a motor shield, driven register by register.

use super::kits::{column, drive, driven_by, kit, last, there_and_back, to_and_fro};
use super::sketch::rumbo;
use crate::support::{stderr, stdout};
use std::path::Path;

pub(super) const DRIVES: &str = "left_enable = 5\nleft_forward = 7\nleft_backward = 8\nright_enable = 6\nright_forward = 12\n\
                      right_backward = 11\ndebug_tx = 1\ndebug_rx = 0\n";

/// A master of the two-wire bus at 400 kHz: `send` tells whether it was acknowledged.
pub(super) const BUS: &str = "
void wait() { while (!(TWCR & _BV(TWINT))) {} }
bool send(byte value) {
  TWDR = value; TWCR = _BV(TWINT) | _BV(TWEN); wait();
  byte status = TWSR & 0xF8;
  return status == 0x18 || status == 0x28 || status == 0x40;
}
bool start(byte address) { TWCR = _BV(TWINT) | _BV(TWSTA) | _BV(TWEN); wait(); return send(address); }
void stop() { TWCR = _BV(TWINT) | _BV(TWSTO) | _BV(TWEN); while (TWCR & _BV(TWSTO)) {} }
byte receive(bool more) { TWCR = _BV(TWINT) | _BV(TWEN) | (more ? _BV(TWEA) : 0); wait(); return TWDR; }
";

/// What a display has shown, one content after the other.
pub(super) fn shown(bench: &Path, name: &str) -> Vec<serde_json::Value> {
    let text = std::fs::read_to_string(bench.join("out/floor-1-displays.txt")).unwrap();
    let lines = text.lines().filter_map(|line| line.split_once('='));
    lines
        .filter(|(of, _)| *of == name)
        .map(|(_, content)| serde_json::from_str(content).unwrap())
        .collect()
}

#[test]
fn a_sketch_that_integrates_the_gyroscope_knows_how_far_the_robot_has_turned() {
    let sketch = "
void set(byte reg, byte value) { start(0xD0); send(reg); send(value); stop(); }
int words[7];
void measure() {
  start(0xD0); send(0x3B); start(0xD1);
  for (byte at = 0; at < 7; at++) { words[at] = receive(true) << 8; words[at] |= receive(at < 6); }
  stop();
}
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  start(0xD0); send(0x75); start(0xD1); Serial.println(receive(false), HEX); stop();
  Serial.println(start(0xD2) ? \"there\" : \"nobody\"); stop();
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  set(0x6B, 1); set(0x1B, 0x08); set(0x1C, 0x08); set(0x1A, 3); set(0x19, 4);
  delay(100);
  long rest = 0, up = 0;
  for (int n = 0; n < 200; n++) { measure(); rest += words[6]; up += words[2]; delay(2); }
  rest /= 200;
  digitalWrite(8, HIGH); digitalWrite(12, HIGH); analogWrite(5, 110); analogWrite(6, 110);
  float degrees = 0;
  unsigned long before = micros(), end = millis() + 1200;
  while (millis() < end) {
    measure();
    unsigned long now = micros();
    degrees += (words[6] - rest) / 65.5 * (now - before) * 1e-6;
    before = now;
    if (millis() + 400 > end) { digitalWrite(8, LOW); digitalWrite(12, LOW); }
  }
  Serial.println(degrees);
  Serial.println(up / 200 / 8192.0);
}
void loop() {}";
    let wiring = format!("{DRIVES}parts.imu = {{ mpu6050 = 0x68 }}\n");
    let Some(bench) = kit("gyroscope", &wiring, &format!("{BUS}{sketch}")) else {
        return;
    };
    let run = drive(&bench, &[]);
    let said = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    let lines: Vec<&str> = said.lines().collect();
    assert_eq!(lines[..2], ["68", "nobody"], "{said}{}", stderr(&run));
    let turned = last(&bench, "heading_rad").to_degrees();
    let degrees: f64 = lines[2].parse().unwrap();
    assert!(turned > 30.0, "{turned}");
    assert!((degrees / turned - 1.0).abs() < 0.05, "{degrees} {turned}");
    let up: f64 = lines[3].parse().unwrap();
    assert!((up - 1.0).abs() < 0.12 && up != 1.0, "{up}");
    let told = stdout(&run) + &stderr(&run);
    for note in [
        "MPU-6050 by its data sheet, not identified",
        "nobody answers at 0x69 on the two-wire bus: there are imu at 0x68",
    ] {
        assert!(told.contains(note), "{told}");
    }
    assert!(
        rumbo(&bench, &["rerun", "out/floor-1.mcap"])
            .status
            .success()
    );
    let export = rumbo(&bench, &["export", "out/floor-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("floor-1.instruments.csv")).unwrap();
    assert!(
        csv.lines().next().unwrap().contains("imu_yaw_rad_s"),
        "{csv}"
    );
    assert!(!column(&bench, "heading_rad").is_empty());
}

#[test]
fn an_interrupt_comes_with_every_value_of_the_inertial_sensor() {
    let sketch = "
volatile int count;
void ready() { count++; }
void set(byte reg, byte value) { start(0xD0); send(reg); send(value); stop(); }
void setup() {
  Serial.begin(115200);
  attachInterrupt(digitalPinToInterrupt(2), ready, RISING);
  set(0x6B, 1); set(0x1A, 3); set(0x19, 9); set(0x38, 1);
  delay(1000);
  Serial.println(count);
}
void loop() {}";
    let wiring = format!("{DRIVES}parts.imu = {{ mpu6050 = 0x68, interrupt = 2 }}\n");
    let Some(bench) = kit("data_ready", &wiring, &format!("{BUS}{sketch}")) else {
        return;
    };
    drive(&bench, &[]);
    let said = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    let count: i64 = said.trim().parse().unwrap();
    assert!((99..=101).contains(&count), "{said}");
}

#[test]
fn a_screen_of_dots_shows_what_a_sketch_draws_and_the_run_says_so() {
    let sketch = "
const byte begin_[] = {0, 0xAE, 0xA8, 63, 0xD3, 0, 0x40, 0x8D, 0x14, 0x20, 0, 0xA1, 0xC8, 0xDA, 0x12, 0xA6, 0xAF};
void window(byte left, byte right, byte top, byte bottom) {
  start(0x78); send(0); send(0x21); send(left); send(right); send(0x22); send(top); send(bottom); stop();
}
void fill(byte dots, int count) { start(0x78); send(0x40); while (count--) send(dots); stop(); }
void setup() {
  TWBR = 12;
  start(0x78); for (byte each : begin_) send(each); stop();
  window(0, 127, 0, 7); fill(0, 1024);
  window(8, 11, 1, 1); fill(0x81, 4);
  delay(1000);
  start(0x78); send(0x80); send(0xA7); send(0x80); send(0xE3); stop();
  delay(1000);
  start(0x78); send(0); send(0xA6); stop();
}
void loop() {}";
    let wiring = format!("{DRIVES}parts.screen = {{ ssd1306 = 0x3c }}\n");
    let Some(bench) = kit("dots", &wiring, &format!("{BUS}{sketch}")) else {
        return;
    };
    let run = drive(&bench, &[]);
    let contents = shown(&bench, "screen");
    let dots = |content: &serde_json::Value| content["dots"].as_str().unwrap().to_owned();
    // Columns 8 to 11 of the rows 8 and 15.
    let mut expected = "0".repeat(64 * 32);
    for row in [8, 15] {
        expected.replace_range(row * 32 + 2..row * 32 + 3, "f");
    }
    assert_eq!(dots(contents.last().unwrap()), expected);
    let inverted: String = expected
        .chars()
        .map(|digit| if digit == '0' { 'f' } else { '0' })
        .collect();
    assert!(contents.iter().any(|content| dots(content) == inverted));
    let told = stdout(&run);
    assert!(
        told.contains("screen shows\n") && told.contains("\u{2809}\u{2809}"),
        "{told}{}",
        stderr(&run)
    );
    let again = rumbo(&bench, &["rerun", "out/floor-1.mcap"]);
    assert!(
        again.status.success(),
        "{}{}",
        stdout(&again),
        stderr(&again)
    );
}

#[test]
fn a_display_of_letters_shows_text_and_characters_of_the_sketch_s_own() {
    let sketch = "
const byte arrow[] = {4, 14, 31, 4, 4, 4, 0, 0};
void lines(byte value) { start(0x4E); send(value); stop(); }
void half(byte value) { lines(value | 0x0C); lines(value | 0x08); delayMicroseconds(50); }
void put(byte value, byte rs) { half(value & 0xF0 | rs); half(value << 4 | rs); }
void print(byte at, const char *text) { put(0x80 | at, 0); while (*text) put(*text++, 1); }
void setup() {
  TWBR = 72;
  delay(50);
  half(0x30); delay(5); half(0x30); delay(1); half(0x30); half(0x20);
  put(0x28, 0); put(0x0C, 0); put(0x06, 0); put(0x01, 0); delay(2);
  put(0x40, 0);
  for (byte row : arrow) put(row, 1);
  print(0x00, \"Rumbo\");
  print(0x14, \"third row\");
  print(0x40, \"\"); put(0, 1); put(0xDF, 1);
}
void loop() {}";
    let wiring = format!("{DRIVES}parts.text = {{ hd44780 = 0x27, size = \"20x4\" }}\n");
    let Some(bench) = kit("letters_shown", &wiring, &format!("{BUS}{sketch}")) else {
        return;
    };
    let run = drive(&bench, &[]);
    let content = shown(&bench, "text").pop().unwrap();
    let rows = ["Rumbo", "\u{e000}°", "third row", ""].map(|row| format!("{row:20}"));
    assert_eq!(content["rows"], serde_json::json!(rows), "{content}");
    assert_eq!(content["drawn"]["0"], "040e1f0404040000");
    assert_eq!(content["light"], true);
    let told = stdout(&run);
    assert!(told.contains("|Rumbo               |"), "{told}");
    assert!(told.contains("|▯°                  |"), "{told}");
    let tests = "sketch = \"car.ino\"\nscenario = \"floor.toml\"\n[[test]]\nname = \"says where it is\"\n\
                 step = [{ expect = \"third row\", port = \"displays\" }]\n";
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    let checked = rumbo(&bench, &["check", "tests.toml"]);
    assert!(
        checked.status.success(),
        "{}{}",
        stdout(&checked),
        stderr(&checked)
    );
}

#[test]
fn an_address_that_is_taken_or_is_none_and_a_bus_on_taken_pins_are_named() {
    for (number, (parts, why)) in [
        (
            "parts.eye = { ssd1306 = 0x3c }\nparts.screen = { ssd1306 = 0x3c }",
            "ssd1306 = 0x3c: eye has that address already: set another one by its jumpers, 0x3c to 0x3d",
        ),
        (
            "parts.imu = { mpu6050 = 0xD0 }",
            "mpu6050 = 0xd0: is not within 7 bits: it is 0x68 with the bit for reading and writing behind it; write 0x68",
        ),
        (
            "parts.text = { hd44780 = 0x68 }",
            "hd44780 = 0x68: must be an address that it can have, 0x20 to 0x27 or 0x38 to 0x3f",
        ),
        (
            "parts.text = { hd44780 = 0x27, size = \"40x4\" }",
            "size = 40x4: did you mean `16x2` or `20x4`?",
        ),
        (
            "parts.imu = { mpu6050 = 0x68, axes = \"up left forward\" }",
            "axes = \"up left forward\": must be where x, y and z of the chip point, right-handed",
        ),
        (
            "servo = \"A4\"\nparts.imu = { mpu6050 = 0x68 }",
            "servo on its pin A4 (SDA): put servo on another pin",
        ),
        (
            "parts.imu = { mpu6050 = 0x68 }\nparts.start = { button = \"A5\" }",
            "button = A5: the two-wire bus is on that pin already",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let wiring = format!("{DRIVES}{parts}\n");
        let Some(bench) = kit(&format!("address{number}"), &wiring, "void setup() {}\nvoid loop() {}\n")
        else {
            return;
        };
        let refused = drive(&bench, &[]);
        assert_eq!(refused.status.code(), Some(2));
        let said = stderr(&refused);
        assert!(said.contains(why), "{said}");
    }
}

/// Drives by the keys of a remote, told by the time from one falling edge to the next.
const REMOTE: &str = "
volatile unsigned long last, bits;
volatile byte count = 99;
volatile int got = -1, repeats = 0;
void fall() {
  unsigned long now = micros(), gap = now - last;
  last = now;
  if (gap > 13000 && gap < 14000) { count = 0; return; }
  if (gap > 11000 && gap < 11500) { repeats++; return; }
  if (count > 31 || gap < 1000 || gap > 2400) { count = 99; return; }
  bits = bits >> 1 | (gap > 1700 ? 0x80000000 : 0);
  if (++count == 32 && (bits & 0xFFFF) == 0xFF00 && (byte)(bits >> 16) == (byte)~(bits >> 24)) got = bits >> 16 & 0xFF;
}
void setup() {
  Serial.begin(115200);
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  attachInterrupt(digitalPinToInterrupt(2), fall, FALLING);
}
void loop() {
  if (repeats) { repeats--; Serial.println(\"again\"); }
  if (got < 0) return;
  Serial.println(got, HEX);
  digitalWrite(7, got == 0x18); digitalWrite(12, got == 0x18);
  analogWrite(5, 150); analogWrite(6, 150);
  got = -1;
}";

#[test]
fn a_remote_control_drives_the_robot_and_repeats_while_its_key_is_held() {
    let wiring = format!("{DRIVES}parts.remote = {{ infrared = 2 }}\n");
    let Some(bench) = kit("remote", &wiring, REMOTE) else {
        return;
    };
    let run = drive(
        &bench,
        &["--press", "remote=up@0.5", "--press", "remote=0@2"],
    );
    let said = || std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    assert_eq!(
        said(),
        "18\nagain\n19\nagain\n",
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let (way_m, speed) = (last(&bench, "x_m"), last(&bench, "left_rad_s"));
    assert!(way_m > 0.3 && speed.abs() < 0.1, "{way_m} {speed}");
    assert!(
        rumbo(&bench, &["rerun", "out/floor-1.mcap"])
            .status
            .success()
    );
    let tests = "sketch = \"car.ino\"\nscenario = \"floor.toml\"\n[[test]]\nname = \"drives\"\n\
                 step = [{ press = \"remote\", to = \"up\" }, { expect = \"18\" }, { press = \"remote\", to = 5, for_s = 0.5 }, { expect = \"40\" }, \
                 { expect = \"again\" }, { expect = \"again\" }, { expect = \"again\" }]\n";
    std::fs::write(bench.join("tests.toml"), tests).unwrap();
    let checked = rumbo(&bench, &["check", "tests.toml"]);
    assert!(
        checked.status.success(),
        "{}{}",
        stdout(&checked),
        stderr(&checked)
    );
    std::fs::write(bench.join("tests.toml"), tests.replace("up", "walk")).unwrap();
    let refused = stderr(&rumbo(&bench, &["check", "tests.toml"]));
    assert!(refused.contains("and walk none of its keys"), "{refused}");
    let in_vain = stderr(&drive(&bench, &["--command", "F@0.1"]));
    assert!(
        in_vain.contains("the robot has no Bluetooth module"),
        "{in_vain}"
    );
    // Held, by an option and in the scenario.
    let held = || assert_eq!(said(), format!("1C\n{}", "again\n".repeat(5)));
    drive(&bench, &["--press", "remote=ok@1-1.6"]);
    held();
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let press = "[[command]]\nat_s = 1\npress = \"remote\"\nto = \"ok\"\nfor_s = 0.6\n";
    std::fs::write(bench.join("floor.toml"), format!("{scenario}{press}")).unwrap();
    drive(&bench, &[]);
    held();
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    for (press, why) in [
        (
            "remote=walk@1",
            "`remote` is a remote control, and walk none of its keys: 1, 2,",
        ),
        ("remote@1", "and on none of its keys"),
        ("remote=up@3-1", "NAME@FROM-TO holds it"),
    ] {
        let refused = drive(&bench, &["--press", press]);
        assert_eq!(refused.status.code(), Some(2));
        assert!(stderr(&refused).contains(why), "{}", stderr(&refused));
    }
}

#[test]
fn a_remote_of_a_car_radio_is_read_by_samples_of_the_line() {
    // As the common library does: a timer looks at the line every 50 us.
    let sketch = "
volatile byte state, bits;
volatile unsigned int ticks;
volatile unsigned long value;
volatile bool done;
ISR(TIMER2_COMPA_vect) {
  bool mark = !(PINB & _BV(3));
  ticks++;
  if (done) return;
  if (state == 0 && mark) { state = 1; ticks = 0; }
  else if (state == 1 && !mark) { state = ticks > 160 ? 2 : 0; ticks = 0; }
  else if (state == 2 && mark) { state = ticks > 70 ? 3 : 0; bits = 0; ticks = 0; }
  else if (state == 3 && !mark) { state = 4; ticks = 0; }
  else if (state == 4 && mark) {
    value = value << 1 | (ticks > 22);
    state = 3; ticks = 0;
    if (++bits == 32) { done = true; state = 0; }
  }
}
void setup() {
  Serial.begin(115200);
  pinMode(11, INPUT);
  TCCR2A = _BV(WGM21); TCCR2B = _BV(CS21); OCR2A = 99; TIMSK2 = _BV(OCIE2A);
}
void loop() { if (done) { Serial.println(value, HEX); delay(150); done = false; } }";
    let wiring = "left_enable = 5\nleft_forward = 7\ndebug_tx = 1\ndebug_rx = 0\n\
                  parts.remote = { infrared = 11, keys = 21 }\n";
    let Some(bench) = kit("radio", wiring, sketch) else {
        return;
    };
    let keys = [
        "--press",
        "remote=ch-@0.5",
        "--press",
        "remote=100+@1",
        "--press",
        "remote=9@1.5",
    ];
    let run = drive(&bench, &keys);
    let said = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    assert_eq!(
        said,
        "FFA25D\nFF9867\nFF52AD\n",
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let robot = std::fs::read_to_string(bench.join("robot.toml")).unwrap();
    let with = |keys: &str, options: &[&str]| {
        let robot = robot.replace("keys = 21", keys);
        std::fs::write(bench.join("robot.toml"), robot).unwrap();
        drive(&bench, options)
    };
    // A television's, in the two orders in which libraries give a code; and a command alone.
    let go = ["--press", "remote=go@0.5", "--press", "remote=mute@1"];
    for keys in [
        "keys = { go = 551492580, mute = 0x45 }",
        "raw_keys = { go = 0x27D8FB04, mute = 0xBA45FF00 }",
    ] {
        with(keys, &go);
        let said = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
        assert_eq!(said, "20DF1BE4\nFFA25D\n", "{keys}");
    }
    for (keys, why) in [
        ("keys = 20", "there is one with arrows, 17 keys"),
        ("keys = {}", "needs a key, e.g. forward = 0xFF18E7"),
        ("keys = { go = 0x1FFFFFFFF }", "within 0..4294967295"),
    ] {
        let refused = stderr(&with(keys, &[]));
        assert!(refused.contains(why), "{refused}");
    }
}

/// Shifts eight bits into the register of a motor shield.
const SHIFT: &str = "
void put(byte bits) {
  digitalWrite(12, LOW);
  for (int bit = 7; bit >= 0; bit--) {
    digitalWrite(4, LOW); digitalWrite(8, bits >> bit & 1); digitalWrite(4, HIGH);
  }
  digitalWrite(12, HIGH);
  digitalWrite(7, LOW);
}
";

#[test]
fn a_motor_shield_drives_the_motors_that_the_wheels_are_on() {
    // M3 and M4, and then the other way.
    let sketch = to_and_fro(
        "4, 5, 6, 7, 8, 12",
        "put(0x21); analogWrite(6, 150); analogWrite(5, 150);",
        "put(0xC0);",
    );
    let sketch = format!("{SHIFT}{sketch}");
    let wiring = "left_forward = \"M3\"\nright_forward = \"M4\"\n";
    there_and_back(driven_by("motor-shield", "shield", wiring, &sketch));
    // One motor's wires exchanged: it turns on the spot.
    let wiring = "left_forward = \"M3\"\nright_backward = \"M4\"\n";
    let Some(bench) = driven_by("motor-shield", "shield_turns", wiring, &sketch) else {
        return;
    };
    let run = drive(&bench, &[]);
    let heading = column(&bench, "heading_rad");
    let farthest = heading.iter().copied().fold(0.0, f64::min);
    assert!(farthest < -1.0, "{farthest} {}", stderr(&run));
    // While pin 7 is high nothing moves, and a run says which motor.
    let asleep = sketch.replace("digitalWrite(7, LOW);", "digitalWrite(7, HIGH);");
    std::fs::write(bench.join("car.ino"), asleep).unwrap();
    let run = drive(&bench, &[]);
    let told = stdout(&run) + &stderr(&run);
    assert!(
        told.contains("it never drove the left motor: left_forward of M3"),
        "{told}"
    );
}

#[test]
fn a_pin_that_a_motor_shield_has_and_a_motor_that_it_has_not_are_named() {
    for (number, (wiring, why)) in [
        (
            "left_forward = \"M5\"",
            "left_forward = M5: must be a motor of the shield, \"M1\" to \"M4\"",
        ),
        ("left_forward = 6", "must be a motor of the shield"),
        (
            "left_forward = \"M1\"\nleft_backward = \"M1\"",
            "left_backward: a wheel is on one motor",
        ),
        (
            "left_forward = \"M1\"\nservo = 12",
            "servo = 12: the motor shield has that pin",
        ),
        (
            "left_forward = \"M1\"\nfront_echo = 11\nfront_trigger = 2",
            "front_echo = 11: the motor shield has that pin",
        ),
        (
            "left_forward = \"M1\"\nparts.start = { button = 8 }",
            "the motor shield is on that pin already",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let name = format!("shield{number}");
        let Some(bench) = driven_by(
            "motor-shield",
            &name,
            wiring,
            "void setup() {}\nvoid loop() {}\n",
        ) else {
            return;
        };
        let refused = drive(&bench, &[]);
        assert_eq!(refused.status.code(), Some(2), "{wiring}");
        assert!(stderr(&refused).contains(why), "{}", stderr(&refused));
    }
}

#[test]
fn a_new_robot_with_a_motor_shield_has_its_wheels_on_motors() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_path_buf();
    let new = [
        "new",
        "robot",
        "car",
        "--board",
        "uno",
        "--driver",
        "motor-shield",
        "--pins",
        "left_forward=M3,right_backward=M4,servo=10,front_trigger=A0,front_echo=A1",
        "--parts",
        "remote=infrared:2:raw:go=0xBA45FF00:100+=7,knob=potentiometer:A2,screen=ssd1306:0x3c",
    ];
    let made = rumbo(&folder, &new);
    assert!(made.status.success(), "{}", stderr(&made));
    let text = std::fs::read_to_string(folder.join("car.toml")).unwrap();
    assert!(
        text.contains(
            "right_backward = \"M4\"   # motor of the right wheel: FORWARD drives it backward"
        ),
        "{text}"
    );
    let parts = "parts.remote = { infrared = 2, raw_keys = { go = 0xBA45FF00, \"100+\" = 7 } }\nparts.knob = { potentiometer = \"A2\" }\nparts.screen = { ssd1306 = 0x3c }\n";
    assert!(text.contains(parts), "{text}");
    let bare = rumbo(
        &folder,
        &["new", "robot", "bare", "--driver", "motor-shield"],
    );
    assert!(
        stderr(&bare).contains("needs the pins left_forward, right_forward"),
        "{}",
        stderr(&bare)
    );
}

#[test]
fn a_new_robot_on_continuous_servos_drives_at_the_speed_of_their_data_sheet() {
    let Some(bench) = super::sketch::bench("servos") else {
        return;
    };
    let new =
        "new robot car --board uno --driver continuous-servos --pins left_servo=13,right_servo=12";
    let made = rumbo(&bench, &new.split(' ').collect::<Vec<_>>());
    assert!(made.status.success(), "{}", stderr(&made));
    let sketch = "#include <Servo.h>
Servo left, right;
void setup() {
  left.attach(13); right.attach(12);
  left.writeMicroseconds(1700); right.writeMicroseconds(1300); delay(2000);
  left.write(90); right.write(90);
}
void loop() {}";
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let scenario =
        "title = \"On the floor\"\nrobot = \"car.toml\"\nworld = \"open\"\nduration_s = 3\n";
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    let run = drive(&bench, &[]);
    assert!(run.status.success(), "{}", stderr(&run));
    let x_m = column(&bench, "x_m");
    // 50 rpm without a load are 0.17 m/s.
    let speed_m_s = x_m[190] - x_m[90];
    assert!((0.13..0.17).contains(&speed_m_s), "{speed_m_s}");
    assert!((x_m[290] - x_m[240]).abs() < 1e-4);
}

#[test]
fn a_motor_shield_on_the_two_wire_bus_drives_and_turns_as_it_is_told() {
    // M3 and M4: PWM, and the inputs of forward and backward.
    let sketch = "
void set(byte output, unsigned int on, unsigned int off) {
  start(0xC0); send(6 + 4 * output); send(on); send(on >> 8); send(off); send(off >> 8); stop();
}
void run(bool forward) {
  set(2, 0, 2400); set(7, 0, 2400);
  set(4, forward ? 4096 : 0, 0); set(3, forward ? 0 : 4096, 0);
  set(5, forward ? 4096 : 0, 0); set(6, forward ? 0 : 4096, 0);
}
void setup() {
  TWBR = 72;
  start(0xC0); send(0xFE); send(3); stop();
  start(0xC0); send(0); send(0x20); stop();
  delay(1);
}
void loop() { run(true); delay(1500); run(false); delay(100000); }";
    let sketch = format!("{BUS}{sketch}");
    let wiring = "left_forward = \"M3\"\nright_forward = \"M4\"\n";
    there_and_back(driven_by("motor-shield-v2", "shield_v2", wiring, &sketch));
    let taken = format!("{wiring}servo = \"A4\"\n");
    let Some(bench) = driven_by("motor-shield-v2", "shield_v2_taken", &taken, &sketch) else {
        return;
    };
    let refused = stderr(&drive(&bench, &[]));
    assert!(
        refused.contains("servo = A4: the motor shield has that pin"),
        "{refused}"
    );
}

#[test]
fn a_car_on_four_wheels_goes_straight_as_one_on_two_and_turns_less() {
    let Some(bench) = super::sketch::bench("four_wheels") else {
        return;
    };
    let sketch = to_and_fro(
        "5, 6, 7, 8, 9, 11",
        "digitalWrite(7, HIGH); digitalWrite(9, HIGH); analogWrite(5, 150); analogWrite(6, 150);",
        "digitalWrite(9, LOW); digitalWrite(11, HIGH);",
    );
    std::fs::write(bench.join("car.ino"), sketch).unwrap();
    let scenario =
        "title = \"On the floor\"\nrobot = \"car.toml\"\nworld = \"open\"\nduration_s = 3\n";
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
    let driven = |wheels: &str| {
        let _ = std::fs::remove_file(bench.join("car.toml"));
        let made = rumbo(
            &bench,
            &[
                "new",
                "robot",
                "car",
                "--board",
                "uno",
                "--driver",
                "l298n",
                "--wheels",
                wheels,
                "--battery",
                "7.4",
                "--pins",
                "left_enable=5,left_forward=7,left_backward=8,right_enable=6,right_forward=9,right_backward=11",
            ],
        );
        assert!(made.status.success(), "{}", stderr(&made));
        let run = drive(&bench, &[]);
        assert!(run.status.success(), "{}", stderr(&run));
        let x_m = column(&bench, "x_m").into_iter().fold(0.0, f64::max);
        let headings = column(&bench, "heading_rad");
        let pairs = headings.windows(2);
        let turned = pairs.map(|pair| {
            let turned = pair[1] - pair[0];
            turned - (turned / std::f64::consts::TAU).round() * std::f64::consts::TAU
        });
        (x_m, turned.sum::<f64>().abs())
    };
    let (two_m, two_turn) = driven("2");
    let (four_m, four_turn) = driven("4");
    assert!((four_m / two_m - 1.0).abs() < 0.4, "{two_m} {four_m}");
    assert!(
        four_turn > 0.5 && four_turn < 0.7 * two_turn,
        "{two_turn} {four_turn}"
    );
}
