//! The image's pin table is the final wiring of the robot file.

use rumbo_emulator::devices::ports::Pin;
use rumbo_sim::boards::MEGA;

#[allow(dead_code, reason = "the image uses the pins one by one")]
#[path = "../src/pins.rs"]
mod table;

#[test]
fn the_pin_table_is_the_final_wiring_of_the_robot_file() {
    let robot: toml::Table = include_str!("../../robots/memoria.toml").parse().unwrap();
    let wiring = robot["wiring"]["final"].as_table().unwrap();
    assert_eq!(wiring.len(), table::ALL.len());
    for pin in table::ALL {
        let number = wiring.get(pin.name).and_then(toml::Value::as_integer);
        assert_eq!(number, Some(pin.arduino.into()), "{}", pin.name);
        let on_chip = Pin::new(char::from(pin.port), pin.bit);
        assert_eq!(MEGA.pin(pin.arduino), on_chip, "{}", pin.name);
        assert_eq!(pin.mask(), 1 << pin.bit);
    }
}
