//! Values that are none, and memory that has decayed.

use super::drive::{Drive, setup};
use rumbo_control::params::ParamId;
use rumbo_wire::{Command, EventKind, Recalled, Refusal};

#[test]
fn no_parameter_takes_a_value_that_is_not_a_number() {
    let Some(setup) = setup("mode5", |_| {}) else {
        return;
    };
    let mut drive = Drive::under_way(&setup, 1.0);
    for id in ParamId::ALL {
        let id = id as u8;
        let answer = drive.command(Command::SetParam {
            id,
            value: f32::NAN,
        });
        let refused = [Err(Refusal::NotFinite), Err(Refusal::Armed)];
        assert!(refused.contains(&answer), "{id} {answer:?}");
    }
    assert_eq!(
        drive.command(Command::Reference(f32::NAN)),
        Err(Refusal::NotFinite)
    );
    assert!(drive.status().armed && drive.speed_rad_s() > 1.0);
    for id in [ParamId::Base, ParamId::WallKp, ParamId::LinkTimeout] {
        assert_eq!(drive.param(id), id.limits().default);
    }
    drive.touched_nothing();
}

#[test]
fn with_both_saved_copies_corrupt_it_says_so_and_drives_by_the_defaults() {
    let Some(setup) = setup("mode1-final", |_| {}) else {
        return;
    };
    let mut drive = Drive::with_eeprom(&setup, &[0x5A; 4_096]);
    drive.wait_s(0.3);
    let told = EventKind::Recalled(Recalled::Neither);
    assert!(drive.told(told).is_some());
    drive.command(Command::Mode(setup.scenario.mode)).unwrap();
    drive.follow(&setup, 5.0);
    let distance_m = drive.sim.truth().range_m[2].unwrap();
    assert!((0.28..0.32).contains(&distance_m), "{distance_m}");
    drive.touched_nothing();
}
