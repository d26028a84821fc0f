//! Sonars of any name and place on a robot of one's own.

use super::sketch::{bench, ino, rumbo};
use crate::support::{stderr, stdout};

/// What a VNH5019 shield, four sonars and a servo that is mounted the other way round, ahead at 35, are wired to.
const PINS: &str = "--pins=left_enable=5,left_forward=2,left_backward=4,right_enable=6,right_forward=7,right_backward=8,\
                    left_fault=12,right_fault=13,servo=3,servo_ahead=35,servo_reversed=true,front_trigger=A0,front_echo=A1,\
                    rear_trigger=A2,rear_echo=A3,mast_trigger=10,mast_echo=11,front_left_trigger=A4,front_left_echo=A5";
const MAST: &str = "--sensors=mast=0.11:0:-90";

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
    let made = rumbo(&bench, &[&new[..], &[MAST]].concat());
    assert!(made.status.success(), "{}", stderr(&made));
    std::fs::write(bench.join("car.ino"), ino("sonars")).unwrap();
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
