//! The table of parameters and its types.

use super::*;

#[test]
fn every_default_is_within_its_limits_and_every_number_finds_its_parameter() {
    for id in ParamId::ALL {
        let ParamLimits { min, max, default } = id.limits();
        assert!(min <= default && default <= max && min < max, "{id:?}");
        assert_eq!(ParamId::from_number(id as u8), Some(id));
        assert_eq!(Params::default().get(id), default);
    }
    assert_eq!(ParamId::from_number(COUNT as u8), None);
}

#[test]
fn a_value_out_of_range_or_not_finite_is_refused_and_changes_nothing() {
    let mut params = Params::default();
    for id in ParamId::ALL {
        let ParamLimits { min, max, .. } = id.limits();
        assert_eq!(params.set(id, max + 1.0), Err(ParamError::OutOfRange));
        assert_eq!(params.set(id, min - 1.0), Err(ParamError::OutOfRange));
        assert_eq!(params.set(id, f32::NAN), Err(ParamError::NotFinite));
    }
    assert_eq!(params, Params::default());
    assert_eq!(params.set(ParamId::Base, 0.2), Ok(0.2));
    assert_eq!(params.geometry().base_m(), 0.2);
}

#[test]
fn copies_in_the_eeprom_of_robots_stay_valid() {
    assert_eq!(SCHEMA, 0x3D2D_32B4);
}

#[cfg(feature = "names")]
#[test]
fn a_switch_or_a_choice_has_a_name_for_each_whole_value_within_its_limits() {
    for id in ParamId::ALL {
        let ParamLimits { min, max, default } = id.limits();
        let kind = id.kind();
        if kind == ParamKind::Number {
            assert_eq!(kind.name_of(default), None);
            continue;
        }
        assert_eq!((min, max), (0.0, kind.names().len() as f32 - 1.0), "{id:?}");
        for (value, name) in kind.names().iter().enumerate() {
            assert_eq!(kind.value_of(name), Some(value as f32));
            assert_eq!(kind.name_of(value as f32), Some(*name));
        }
        assert_eq!(kind.name_of(max + 1.0), None);
        assert_eq!(kind.name_of(-1.0), None);
        assert_eq!(kind.value_of("front"), None);
    }
}

#[cfg(feature = "names")]
#[test]
fn names_are_unique_and_carry_their_unit() {
    extern crate std;
    let mut names: std::vec::Vec<_> = ParamId::ALL.iter().map(|id| id.name()).collect();
    for id in ParamId::ALL {
        assert_eq!(ParamId::from_name(id.name()), Some(id));
        assert!(!id.help().is_empty() && !id.unit().is_empty());
    }
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), COUNT);
}
