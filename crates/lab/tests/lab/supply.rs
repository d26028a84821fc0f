//! STOP, OFF and ON where a foreign program has the robot, one that reads nothing and drives for ever.

use crate::bench::Bench;
use rumbo_experiment::files::{Library, Overrides};
use rumbo_experiment::run;
use rumbo_log::Choice;
use rumbo_session::{GivenProgram, Order};
use rumbo_wire::Command;

/// Pins 6 and 7, 5 and 4 of a Mega high: both wheels at full speed, and nothing else, for ever.
const BOLT: [u16; 10] = [
    0xe108, // ldi r16, 0x18
    0x9300, 0x0101, // sts DDRH, r16
    0x9300, 0x0102, // sts PORTH, r16
    0x9a6b, 0x9a73, // sbi DDRE, 3; sbi PORTE, 3
    0x9a9d, 0x9aa5, // sbi DDRG, 5; sbi PORTG, 5
    0xcfff, // rjmp .-2
];

/// The program as Intel HEX.
fn bolting() -> Vec<u8> {
    let data = BOLT.iter().flat_map(|word| word.to_le_bytes());
    let mut line = vec![2 * BOLT.len() as u8, 0, 0, 0];
    line.extend(data);
    let sum = line.iter().fold(0_u8, |sum, byte| sum.wrapping_add(*byte));
    line.push(sum.wrapping_neg());
    let line: String = line.iter().map(|byte| format!("{byte:02X}")).collect();
    format!(":{line}\n:00000001FF\n").into_bytes()
}

#[test]
fn stop_and_off_stop_a_program_that_ignores_them_and_on_lets_it_drive_again() {
    let mut bench = Bench::new(Choice {
        scenario: "mode1".into(),
        world: Some("open".into()),
        rig: None,
        seed: 1,
    });
    bench.order(Order::Program(GivenProgram::file("bolt.hex", &bolting())));
    bench.pass(1.0);
    assert!(bench.wheel_rad_s() > 5.0, "{}", bench.wheel_rad_s());
    for order in [Command::Stop, Command::Disarm] {
        bench.order(Order::Robot(order));
        // Released wheels roll out.
        bench.pass(4.0);
        assert!(bench.wheel_rad_s().abs() < 0.01, "{order:?}");
        assert!(bench.state().motors_cut, "{order:?}");
        bench.order(Order::Robot(Command::Arm));
        bench.pass(1.0);
        assert!(bench.wheel_rad_s() > 5.0, "{order:?}");
        assert!(!bench.state().motors_cut, "{order:?}");
    }
    assert!(bench.told("STOP: the motors have no supply, whatever the program does"));
}

#[test]
fn a_scenario_s_off_stops_a_program_that_ignores_it() {
    let folder = std::env::temp_dir().join(format!("rumbo-supply-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let image = folder.join("bolt.hex");
    std::fs::write(&image, bolting()).unwrap();
    let end_rpm = |commands: &str| {
        let text = format!(
            "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = \"front_distance\"\nduration_s = 5\n{commands}"
        );
        let path = folder.join("bolt.toml");
        std::fs::write(&path, text).unwrap();
        let overrides = Overrides {
            firmware: Some(image.clone()),
            ..Overrides::default()
        };
        let setup = Library::new()
            .setup(path.to_str().unwrap(), &overrides)
            .unwrap();
        let result = run::run(&setup, 1).unwrap();
        result.trace.samples.last().unwrap().wheel_rad_s[0]
    };
    assert!(end_rpm("") > 5.0);
    assert!(end_rpm("[[command]]\nat_s = 1\nstop = true\n").abs() < 0.01);
    std::fs::remove_dir_all(&folder).unwrap();
}
