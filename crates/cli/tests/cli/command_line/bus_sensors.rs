//! Sensors of distance by light and compasses on the two-wire bus, and a display of letters on pins, driven by sketches that
//! write to their registers and lines.

use super::devices::{BUS, DRIVES, shown};
use super::kits::{drive, kit, last};
use super::sketch::rumbo;
use crate::support::{stderr, stdout};
use std::path::{Path, PathBuf};

const REGISTERS: &str = "
void put(byte at, byte reg, byte value) { start(at << 1); send(reg); send(value); stop(); }
byte get(byte at, byte reg) {
  start(at << 1); send(reg); start(at << 1 | 1);
  byte value = receive(false);
  stop();
  return value;
}
bool there(byte at) { bool answered = start(at << 1); stop(); return answered; }
";

/// Walls 0.8 m ahead and 0.5 m to the left of the start.
const WALLS: &str = "title = \"A corner\"\n[arena]\nfrom_m = [-1, -1]\nto_m = [1, 1]\n[[wall]]\nfrom_m = [0.8, -1]\n\
                     to_m = [0.8, 1]\n[[wall]]\nfrom_m = [-1, 0.5]\nto_m = [0.8, 0.5]\n";

/// Puts the robot into another world.
fn into_world(bench: &Path, world: &str) {
    std::fs::write(bench.join("here.toml"), world).unwrap();
    let scenario = std::fs::read_to_string(bench.join("floor.toml")).unwrap();
    let scenario = scenario.replace("world = \"open\"", "world = \"here.toml\"");
    std::fs::write(bench.join("floor.toml"), scenario).unwrap();
}

fn said(bench: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(bench.join("out/floor-1-usart0.txt")).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn two_sensors_of_distance_that_xshut_tells_apart_measure_the_walls_before_them() {
    let sketch = "
byte keep[2];
void hold(byte at, byte value) {
  put(at, 0x80, 1); put(at, 0xFF, 1); put(at, 0x00, 0);
  if (value) put(at, 0x91, value); else keep[at & 1] = get(at, 0x91);
  put(at, 0x00, 1); put(at, 0xFF, 0); put(at, 0x80, 0);
}
void ready(byte at) { while (!(get(at, 0x13) & 7)) {} put(at, 0x0B, 1); }
void setup_sensor(byte at) {
  hold(at, 0);
  put(at, 0xFF, 7); put(at, 0x94, 0x6B); put(at, 0x83, 0);
  while (!get(at, 0x83)) {}
  Serial.println(get(at, 0x92) & 0x7F);
  put(at, 0xFF, 0); put(at, 0x52, 0x96); put(at, 0x0A, 4);
  put(at, 0x01, 1); put(at, 0x00, 0x41); ready(at); put(at, 0x00, 0);
  put(at, 0x01, 2); put(at, 0x00, 1); ready(at); put(at, 0x00, 0);
  put(at, 0x01, 0xE8);
  hold(at, keep[at & 1]);
  put(at, 0x00, 2);
}
int mean(byte at) {
  long sum = 0;
  for (byte n = 0; n < 30; n++) {
    while (!(get(at, 0x13) & 7)) {}
    sum += get(at, 0x1E) << 8 | get(at, 0x1F);
    put(at, 0x0B, 1);
  }
  return sum / 30;
}
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  pinMode(2, OUTPUT); pinMode(3, OUTPUT);
  delay(5);
  Serial.println(there(0x29));
  pinMode(2, INPUT); delay(2);
  put(0x29, 0x8A, 0x30);
  Serial.println(there(0x29));
  pinMode(3, INPUT); delay(2);
  Serial.println(there(0x29) && there(0x30));
  setup_sensor(0x29); setup_sensor(0x30);
  Serial.println(mean(0x29)); Serial.println(mean(0x30));
}
void loop() {}";
    let wiring = format!(
        "{DRIVES}parts.ahead = {{ vl53l0x = 0x29, x_m = 0.1, xshut = 2 }}\n\
         parts.aside = {{ vl53l0x = 0x29, y_m = 0.05, angle_deg = 90, xshut = 3 }}\n"
    );
    let Some(bench) = kit("light", &wiring, &format!("{BUS}{REGISTERS}{sketch}")) else {
        return;
    };
    into_world(&bench, WALLS);
    let run = drive(&bench, &[]);
    let lines = said(&bench);
    assert_eq!(
        lines[..5],
        ["0", "0", "1", "5", "5"],
        "{lines:?}{}",
        stderr(&run)
    );
    let [aside, ahead] = [5, 6].map(|at| lines[at].parse::<f64>().unwrap());
    assert!((aside - 450.0).abs() < 30.0, "{aside}");
    assert!((ahead - 700.0).abs() < 45.0, "{ahead}");
    let told = stdout(&run) + &stderr(&run);
    assert!(
        told.contains("VL53L0X by its data sheet, not identified"),
        "{told}"
    );
    let again = rumbo(&bench, &["rerun", "out/floor-1.mcap"]);
    assert!(again.status.success(), "{}", stderr(&again));
    let export = rumbo(&bench, &["export", "out/floor-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("floor-1.instruments.csv")).unwrap();
    assert!(csv.lines().next().unwrap().contains("ahead_m"), "{csv}");
    // Both at once answer as one, and a run says so.
    let sketch = sketch.replace("pinMode(2, OUTPUT); pinMode(3, OUTPUT);", "");
    std::fs::write(
        bench.join("car.ino"),
        format!("{BUS}{REGISTERS}{sketch}").replace("pinMode(3, INPUT)", "put(0x30, 0x8A, 0x29)"),
    )
    .unwrap();
    let run = drive(&bench, &[]);
    let told = stdout(&run) + &stderr(&run);
    assert!(told.contains("several answer at once at 0x29"), "{told}");
}

#[test]
fn a_sensor_of_distance_on_the_servo_looks_where_that_points() {
    let sketch = "
int range() {
  put(0x29, 0x00, 1);
  while (!(get(0x29, 0x13) & 7)) {}
  put(0x29, 0x0B, 1);
  return get(0x29, 0x1E) << 8 | get(0x29, 0x1F);
}
void look(int us) {
  for (byte n = 0; n < 30; n++) { digitalWrite(10, HIGH); delayMicroseconds(us); digitalWrite(10, LOW); delay(17); }
}
void setup() {
  Serial.begin(115200);
  pinMode(10, OUTPUT);
  put(0x29, 0x0A, 4); put(0x29, 0x01, 0xE8);
  look(1500); Serial.println(range());
  look(2400); Serial.println(range());
  look(600); Serial.println(range());
}
void loop() {}";
    let wiring = format!("{DRIVES}servo = 10\nparts.eye = {{ vl53l0x = 0x29, on_servo = true }}\n");
    let Some(bench) = kit("eye", &wiring, &format!("{BUS}{REGISTERS}{sketch}")) else {
        return;
    };
    into_world(&bench, WALLS);
    let run = drive(&bench, &[]);
    let read = said(&bench);
    let read: Vec<f64> = read.iter().map(|line| line.parse().unwrap()).collect();
    let [ahead, left, right] = read[..] else {
        panic!("{read:?}{}", stderr(&run))
    };
    assert!((ahead - 800.0).abs() < 110.0, "{read:?}");
    assert!((left - 500.0).abs() < 80.0, "{read:?}");
    assert_eq!(right, 8190.0);
}

/// Prints where both compasses point, clockwise from north, before and after a turn on the spot.
const COMPASSES: &str = "
float azimuth(byte at, byte low, byte x, byte y) {
  float sums[2] = {0, 0};
  for (byte n = 0; n < 40; n++) {
    byte bytes[6];
    start(at << 1); send(low); start(at << 1 | 1);
    for (byte i = 0; i < 6; i++) bytes[i] = receive(i < 5);
    stop();
    byte high = at == 0x0D;
    sums[0] += (int)(bytes[x + high] << 8 | bytes[x + 1 - high]);
    sums[1] += (int)(bytes[y + high] << 8 | bytes[y + 1 - high]);
    delay(6);
  }
  float degrees = atan2(sums[1], sums[0]) * 57.2958;
  return degrees < 0 ? degrees + 360 : degrees;
}
void tell() { Serial.println(azimuth(0x0D, 0, 0, 2)); Serial.println(azimuth(0x1E, 3, 0, 4)); }
void setup() {
  Serial.begin(115200);
  TWBR = 12;
  for (byte pin = 5; pin <= 12; pin++) pinMode(pin, OUTPUT);
  put(0x0D, 0x0B, 1); put(0x0D, 0x09, 0x0D);
  put(0x1E, 0, 0x18); put(0x1E, 2, 0);
  delay(50);
  tell();
  digitalWrite(8, HIGH); digitalWrite(12, HIGH); analogWrite(5, 110); analogWrite(6, 110);
  delay(700);
  digitalWrite(8, LOW); digitalWrite(12, LOW);
  delay(400);
  tell();
}
void loop() {}";

fn with_compasses(name: &str, more: &str) -> Option<PathBuf> {
    let wiring = format!(
        "{DRIVES}parts.q = {{ qmc5883l = 0x0d{more} }}\nparts.h = {{ hmc5883l = 0x1e{more} }}\n"
    );
    kit(name, &wiring, &format!("{BUS}{REGISTERS}{COMPASSES}"))
}

#[test]
fn compasses_turn_with_the_robot_against_the_north_of_the_world() {
    let Some(bench) = with_compasses("compass", "") else {
        return;
    };
    let off = |azimuth: f64, expected: f64| ((azimuth - expected + 540.0) % 360.0 - 180.0).abs();
    for north_deg in [90.0, -30.0] {
        let north = match north_deg {
            90.0 => String::new(),
            other => format!("north_deg = {other}\n"),
        };
        into_world(&bench, &(north + WALLS));
        let run = drive(&bench, &[]);
        let read: Vec<f64> = said(&bench)
            .iter()
            .map(|line| line.parse().unwrap())
            .collect();
        let turned = last(&bench, "heading_rad").to_degrees();
        assert!(turned.abs() > 30.0, "{turned}{}", stderr(&run));
        for (at, heading) in [0.0, 0.0, turned, turned].into_iter().enumerate() {
            let expected = north_deg - heading;
            assert!(off(read[at], expected) < 6.0, "{read:?} {expected}");
        }
        let told = stdout(&run) + &stderr(&run);
        assert!(
            told.contains("compass: QMC5883L and HMC5883L by their data sheets"),
            "{told}"
        );
    }
}

#[test]
fn iron_of_the_robot_draws_a_compass_to_it() {
    let Some(bench) = with_compasses("iron", ", iron_x_ut = 25, axes = \"backward right up\"")
    else {
        return;
    };
    drive(&bench, &[]);
    // East is ahead, and as much of the robot's own field as of the Earth's: half way, seen from behind.
    for line in &said(&bench)[..2] {
        let azimuth: f64 = line.parse().unwrap();
        assert!((azimuth - 225.0).abs() < 6.0, "{azimuth}");
    }
}

#[test]
fn a_display_on_six_pins_shows_what_is_written_to_its_lines() {
    let sketch = "
const byte data[] = {4, 9, 10, 13};
void half(byte value) {
  for (byte bit = 0; bit < 4; bit++) digitalWrite(data[bit], value >> bit & 1);
  digitalWrite(3, HIGH); delayMicroseconds(1); digitalWrite(3, LOW); delayMicroseconds(100);
}
void put(byte value, bool letter) { digitalWrite(2, letter); half(value >> 4); half(value); }
void setup() {
  pinMode(2, OUTPUT); pinMode(3, OUTPUT);
  for (byte pin : data) pinMode(pin, OUTPUT);
  delay(50);
  half(3); delay(5); half(3); delay(1); half(3); half(2);
  put(0x28, 0); put(0x0C, 0); put(0x06, 0); put(0x01, 0); delay(2);
  for (const char *text = \"on pins\"; *text; text++) put(*text, 1);
  put(0xC3, 0); put('!', 1);
}
void loop() {}";
    let lines = "rs = 2, e = 3, d4 = 4, d5 = 9, d6 = 10, d7 = 13";
    let wiring = format!("{DRIVES}parts.text = {{ hd44780 = {{ {lines} }} }}\n");
    let Some(bench) = kit("on_pins", &wiring, sketch) else {
        return;
    };
    let run = drive(&bench, &[]);
    let content = shown(&bench, "text").pop().unwrap();
    let rows = ["on pins", "   !"].map(|row| format!("{row:16}"));
    assert_eq!(content["rows"], serde_json::json!(rows), "{}", stderr(&run));
    assert_eq!(content["light"], true);
}

#[test]
fn lines_and_addresses_that_cannot_be_are_named() {
    for (number, (parts, why)) in [
        (
            "parts.a = { vl53l0x = 0x29, xshut = 2 }\nparts.b = { vl53l0x = 0x29 }\nparts.c = { vl53l0x = 0x29 }",
            "vl53l0x = 0x29: b has that address already: give all but one a pin for their XSHUT, xshut = 7",
        ),
        (
            "parts.a = { vl53l0x = 0x30 }",
            "vl53l0x = 0x30: must be an address that it can have, 0x29",
        ),
        (
            "parts.a = { vl53l0x = 0x29, xshut = 5 }",
            "xshut = 5: left_enable is on that pin already",
        ),
        (
            "parts.a = { qmc5883l = 0x0d }\nparts.b = { qmc5883l = 0x0d }",
            "qmc5883l = 0x0d: a has that address already: a bus has one of them",
        ),
        (
            "parts.text = { hd44780 = { rs = 2, e = 3, d4 = 4, d5 = 9, d6 = 10 } }",
            "needs d7: the pins of the display are rs, e, d4, d5, d6 and d7",
        ),
        (
            "parts.text = { hd44780 = { rs = 2, e = 3, d4 = 4, d5 = 9, d6 = 10, d7 = 4 } }",
            "d7 = 4: another line of the display is on that pin",
        ),
        (
            "parts.text = { hd44780 = { rs = 2, e = 3, d4 = 4, d5 = 9, d6 = 10, d7 = \"A5\" } }\nparts.b = { button = \"A5\" }",
            "button = A5: text is on that pin already",
        ),
    ]
    .into_iter()
    .enumerate()
    {
        let wiring = format!("{DRIVES}{parts}\n");
        let name = format!("lines{number}");
        let Some(bench) = kit(&name, &wiring, "void setup() {}\nvoid loop() {}\n") else {
            return;
        };
        let refused = drive(&bench, &[]);
        assert_eq!(refused.status.code(), Some(2), "{parts}");
        assert!(stderr(&refused).contains(why), "{}", stderr(&refused));
    }
}

#[test]
fn a_new_robot_takes_sensors_of_the_bus_with_their_places_and_a_display_with_its_pins() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().to_path_buf();
    let new = [
        "new",
        "robot",
        "car",
        "--board",
        "nano",
        "--driver",
        "l298n-jumpers",
        "--pins",
        "left_forward=5,left_backward=6,right_forward=9,right_backward=10",
        "--parts",
        "tof=vl53l0x:0x29:7,north=qmc5883l:0x0d,text=hd44780:12:11:4:3:2:A0:20x4",
        "--sensors",
        "tof=0.1:0.02:30",
    ];
    let made = rumbo(&folder, &new);
    assert!(made.status.success(), "{}", stderr(&made));
    let text = std::fs::read_to_string(folder.join("car.toml")).unwrap();
    for part in [
        "parts.tof = { vl53l0x = 0x29, xshut = 7, x_m = 0.1, y_m = 0.02, angle_deg = 30 }",
        "parts.north = { qmc5883l = 0x0d }",
        "parts.text = { hd44780 = { rs = 12, e = 11, d4 = 4, d5 = 3, d6 = 2, d7 = \"A0\" }, size = \"20x4\" }",
    ] {
        assert!(text.contains(part), "{text}");
    }
}
