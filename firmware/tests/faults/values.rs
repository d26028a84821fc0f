//! Non-finite values, and corrupted memory.

use super::drive::{Drive, setup, under_way_in_each};
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_wire::{Command, EventKind, Recalled, Refusal};

#[test]
fn no_parameter_takes_a_value_that_is_not_a_number() {
    for mut drive in under_way_in_each() {
        let ids = [ParamId::Base, ParamId::WallKp, ParamId::LinkTimeout];
        let before = ids.map(|id| drive.param(id));
        for id in ParamId::ALL {
            let id = id as u8;
            let answer = drive.command(Command::SetParam {
                id,
                value: f32::NAN,
            });
            let refused = [Err(Refusal::NotFinite), Err(Refusal::Armed)];
            assert!(refused.contains(&answer), "{id} {answer:?}");
        }
        let command = match drive.status().mode {
            ModeId::Mission => Command::Goal {
                x_m: f32::NAN,
                y_m: 0.0,
            },
            _ => Command::Reference(f32::NAN),
        };
        assert_eq!(drive.command(command), Err(Refusal::NotFinite));
        let status = drive.status();
        assert!(status.armed && status.fault.is_none(), "{status:?}");
        assert_eq!(ids.map(|id| drive.param(id)), before);
        drive.touched_nothing();
    }
}

#[test]
fn with_both_saved_copies_corrupt_it_reports_it_and_uses_the_defaults() {
    let Some(setup) = setup("mode1-final", |_| {}) else {
        return;
    };
    let mut drive = Drive::with_eeprom(&setup, &[0x5A; 4_096]);
    drive.wait_s(0.3);
    let neither = EventKind::Recalled(Recalled::Neither);
    assert!(drive.event_s(neither).is_some());
    drive.command(Command::Mode(setup.scenario.mode)).unwrap();
    drive.follow(&setup, 5.0);
    let distance_m = drive.sim.truth().range_m[2].unwrap();
    assert!((0.28..0.32).contains(&distance_m), "{distance_m}");
    drive.touched_nothing();
}
