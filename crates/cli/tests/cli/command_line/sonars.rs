//! Sonars of any name and place on a robot of one's own, and what its options say that is wrong.

use super::sketch::{bench, rumbo};
use crate::support::{stderr, stdout};

/// What a VNH5019 shield, four sonars and a servo that is mounted the other way round, ahead at 35, are wired to.
const PINS: &str = "--pins=left_enable=5,left_forward=2,left_backward=4,right_enable=6,right_forward=7,right_backward=8,\
                    left_fault=12,right_fault=13,servo=3,servo_ahead=35,servo_reversed=true,front_trigger=A0,front_echo=A1,\
                    rear_trigger=A2,rear_echo=A3,mast_trigger=10,mast_echo=11,front_left_trigger=A4,front_left_echo=A5";
const MAST: &str = "--sensors=mast=0.11:0:-90";

/// Prints what the sonars measure, that in front ahead and to the right, and backs to 30 cm from what is behind.
const SKETCH: &str = "#include <Servo.h>
Servo servo;
int mm(byte trigger, byte echo) {
  digitalWrite(trigger, HIGH); delayMicroseconds(12); digitalWrite(trigger, LOW);
  int mm = pulseIn(echo, HIGH, 30000) / 5.82;
  delay(60);
  return mm;
}
const byte pins[] = {2, 4, 5, 6, 7, 8, 10, A0, A2, A4};
void setup() {
  Serial.begin(115200);
  for (byte pin : pins) pinMode(pin, OUTPUT);
  servo.attach(3);
  for (byte angle = 35; angle < 130; angle += 90) {
    servo.write(angle);
    delay(600);
    Serial.println(mm(A0, A1));
  }
  Serial.println(mm(10, 11));
  Serial.println(mm(A2, A3));
  Serial.println(mm(A4, A5));
  digitalWrite(4, HIGH); digitalWrite(8, HIGH);
  bool fine = digitalRead(12) && digitalRead(13);
  while (fine && mm(A2, A3) > 300) { analogWrite(5, 150); analogWrite(6, 150); }
  analogWrite(5, 0); analogWrite(6, 0);
}
void loop() {}
";

#[test]
fn sonars_of_any_name_and_place_are_a_robot_s_and_in_its_log() {
    let Some(bench) = bench("sonars") else {
        return;
    };
    let new = [
        "new",
        "robot",
        "car",
        "--board=uno",
        "--driver=vnh5019",
        PINS,
    ];
    let unplaced = stderr(&rumbo(&bench, &new));
    assert!(unplaced.contains("say it, --sensors mast="), "{unplaced}");
    let made = rumbo(&bench, &[&new[..], &[MAST]].concat());
    assert!(made.status.success(), "{}", stderr(&made));
    std::fs::write(bench.join("car.ino"), SKETCH).unwrap();
    let run = [
        "run", "free", "--world", "room", "--robot", "car.toml", "--sketch", "car.ino", "--out",
        "out",
    ];
    let run = rumbo(&bench, &run);
    let said = std::fs::read_to_string(bench.join("out/free-1-usart0.txt")).unwrap();
    let printed: Vec<f64> = said.lines().map(|line| line.parse().unwrap()).collect();
    let csv = std::fs::read_to_string(bench.join("out/free-1.truth.csv")).unwrap();
    let mut rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let (names, rows) = (rows.next().unwrap(), rows.collect::<Vec<_>>());
    let at = |row: &[&str], name: &str| -> f64 {
        let column = names.iter().position(|each| *each == name).unwrap();
        row[column].parse().unwrap()
    };
    let true_mm = |name: &str| 1e3 * at(&rows[0], &format!("range_{name}_m"));
    let [mast, rear, front_left] = ["mast", "rear", "front_left"].map(true_mm);
    let told = format!(
        "{said}{mast} {rear} {front_left}{}{}",
        stdout(&run),
        stderr(&run)
    );
    for (printed, expected) in printed[1..].iter().zip([mast, mast, rear]) {
        assert!((printed - expected).abs() < 30.0, "{told}");
    }
    assert!(printed[4] == 0.0 && front_left.is_infinite(), "{told}");
    assert!((printed[0] - 1_290.0).abs() < 30.0, "{told}");
    let last = rows.last().unwrap();
    assert!(
        at(last, "x_m") < -0.1 && at(last, "range_rear_m") > 0.1,
        "{told}"
    );
    let export = rumbo(&bench, &["export", "out/free-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = std::fs::read_to_string(bench.join("free-1.instruments.csv")).unwrap();
    for name in ["true_range_rear_m", "pinged_rear_m", "pinged_front_left_m"] {
        assert!(csv.lines().next().unwrap().contains(name), "{csv:.400}");
    }
    let checked = |truth: &str| {
        let step = format!("{{ truth = \"{truth}\", within_s = 20, max = 0.32 }}");
        let test = format!("[[test]]\nname = \"backs\"\nstep = [{step}]\n");
        let program = "sketch = \"car.ino\"\nrobot = \"car.toml\"\n";
        std::fs::write(bench.join("tests.toml"), format!("{program}{test}")).unwrap();
        rumbo(&bench, &["check", "tests.toml"])
    };
    let backs = checked("range_rear_m");
    assert!(
        backs.status.success(),
        "{}{}",
        stdout(&backs),
        stderr(&backs)
    );
    let unknown = stderr(&checked("range_reer_m"));
    assert!(unknown.contains("did you mean `range_rear_m`"), "{unknown}");
}

#[test]
fn what_is_wrong_with_a_new_robot_is_said_of_its_option() {
    let Some(bench) = bench("by_option") else {
        return;
    };
    let wrong = |more: &[&str]| {
        let pins = "--pins=left_forward=5,left_backward=6,right_forward=9,right_backward=10,front_trigger=3,front_echo=4,line_a=99";
        let new = [
            "new",
            "robot",
            "b",
            "--board=uno",
            "--driver=l298n-jumpers",
            pins,
        ];
        stderr(&rumbo(&bench, &[&new[..], more].concat()))
    };
    let said = wrong(&[
        "--parts=start=button:77,go=infrared:2:on=0xzz",
        "--sensors=front=5:0",
    ]);
    assert!(
        said.contains("--parts go=infrared:2:on=0xzz: not valid TOML"),
        "{said}"
    );
    let said = wrong(&["--parts=start=button:77", "--sensors=front=5:0,line_a=9:0"]);
    for problem in [
        "--parts start=button:77: must be a whole number within 0..19",
        "--sensors front=5:0:0: must be within -1..1 m",
        "--sensors line_a=9:0:0: must be within",
        "--pins line_a=99: must be a whole number within 0..19",
    ] {
        assert!(said.contains(problem), "{said}");
    }
    assert!(!said.contains("b.toml"), "{said}");
}
