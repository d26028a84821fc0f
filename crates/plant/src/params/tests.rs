use super::*;

#[test]
fn the_nominal_values_are_within_their_limits() {
    assert_eq!(Params::default().check(), Ok(()));
}

#[test]
fn a_key_reaches_the_number_it_names() {
    let mut params = Params::default();
    params.set("wheels.left.viscous_n_m_s", 0.01).unwrap();
    assert_eq!(params.wheels.left.viscous_n_m_s, 0.01);
    assert_eq!(params.get("wheels.left.viscous_n_m_s"), Some(0.01));
    assert_eq!(params.wheels.right, Wheel::default());
    assert_eq!(params.get("wheels.viscous"), None);
}

#[test]
fn a_value_out_of_range_is_refused_with_the_range_and_changes_nothing() {
    let mut params = Params::default();
    let error = params.set("battery.open_circuit_v", 14.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`battery.open_circuit_v` = 14: allowed 5 to 13 V"
    );
    assert!(params.set("encoder.edges_per_motor_turn", 7.5).is_err());
    assert!(params.set("body.mass_kg", f64::NAN).is_err());
    assert_eq!(params, Params::default());
}

#[test]
fn a_misspelt_key_names_its_neighbour() {
    let error = Params::default()
        .set("battery.open_circut_v", 7.0)
        .unwrap_err();
    assert!(
        error.to_string().contains("`battery.open_circuit_v`"),
        "{error}"
    );
}
