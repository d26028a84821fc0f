//! A robot's parameters in the terms of ROS 2.

use crate::parameters::{ParameterState, Question, Value, answer, changes, number, question};
use rumbo_ros::messages::Time;
use rumbo_ros::service_messages::ParameterValue;
use rumbo_ros::types::{decode, encode};

fn entry(name: &str) -> ParameterState {
    table()
        .into_iter()
        .find(|known| known.name == name)
        .unwrap()
}

/// The whole table with the values of a new robot, as the station sends it.
fn table() -> Vec<ParameterState> {
    let state = |entry: rumbo_log::Parameter| {
        let sent = serde_json::to_string(&rumbo_log::ParameterState {
            value: Some(entry.default),
            pending: false,
            refused: None,
            entry,
        });
        serde_json::from_str(&sent.unwrap()).unwrap()
    };
    rumbo_log::parameters().map(state).collect()
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// Types, and values as bool, double and string.
fn values(names: &[String], table: &[ParameterState]) -> Vec<(u8, bool, f64, String)> {
    type Raw = (
        u8,
        bool,
        i64,
        f64,
        String,
        Vec<u8>,
        Vec<bool>,
        Vec<i64>,
        Vec<f64>,
        Vec<String>,
    );
    let bytes = answer(&Question::Get(names.to_vec()), table).unwrap();
    let (values,) = decode::<(Vec<Raw>,)>(&bytes.unwrap()).unwrap();
    let values = values.into_iter();
    values
        .map(|(kind, bool, _, double, string, ..)| (kind, bool, double, string))
        .collect()
}

#[test]
fn numbers_are_doubles_switches_bools_and_choices_strings() {
    let asked = names(&["radius_left_m", "mission_reset_origin", "rig", "no_such"]);
    let got = values(&asked, &table());
    // 0.0325 of 32 bits, not 0.03249999880790711.
    assert_eq!(got[0], (3, false, 0.0325, String::new()));
    assert_eq!(got[1], (1, true, 0.0, String::new()));
    assert_eq!(got[2], (4, false, 0.0, "final".to_owned()));
    assert_eq!(got[3].0, 0);
    let unread: Vec<ParameterState> = table()
        .into_iter()
        .map(|mut known| {
            known.value = None;
            known
        })
        .collect();
    assert_eq!(values(&asked[..1], &unread)[0].0, 0);
}

#[test]
fn a_description_has_the_unit_and_the_range() {
    type Range = (f64, f64, f64);
    type Integers = (i64, i64, u64);
    type Raw = (
        String,
        u8,
        String,
        String,
        bool,
        bool,
        Vec<Range>,
        Vec<Integers>,
    );
    let asked = names(&["radius_left_m", "rig", "no_such"]);
    let bytes = answer(&Question::Describe(asked), &table()).unwrap();
    let (all,) = decode::<(Vec<Raw>,)>(&bytes.unwrap()).unwrap();
    assert_eq!(all[0].2, "Radius of the left wheel. [m]");
    assert_eq!(all[0].6, [(0.01, 0.2, 0.0)]);
    assert!(
        all[1].3.starts_with("one of front_single, "),
        "{}",
        all[1].3
    );
    assert!(all[1].6.is_empty() && all[1].7.is_empty());
    assert_eq!((all[2].0.as_str(), all[2].1), ("no_such", 0));
}

#[test]
fn what_is_set_is_a_number_in_its_range_or_says_why_not() {
    let radius = entry("radius_left_m");
    assert_eq!(number(&radius, &Value::Double(0.04)), Ok(0.04));
    assert_eq!(number(&entry("front_kp"), &Value::Integer(2)), Ok(2.0));
    assert_eq!(number(&entry("rig"), &Value::Text("final".into())), Ok(4.0));
    let switch = entry("mission_reset_origin");
    assert_eq!(number(&switch, &Value::Bool(false)), Ok(0.0));
    for (entry, value, why) in [
        (
            &radius,
            Value::Double(0.5),
            "0.5 is not within 0.01 to 0.2 m",
        ),
        (
            &radius,
            Value::Double(f64::NAN),
            "NaN is not within 0.01 to 0.2 m",
        ),
        (&radius, Value::Double(1e300), "is not within"),
        (&radius, Value::Text("0.04".into()), "it is a number"),
        (&radius, Value::Other, "it is a number"),
        (&switch, Value::Double(1.0), "it is a bool"),
        (&entry("rig"), Value::Integer(4), "it is a string"),
        (
            &entry("rig"),
            Value::Text("none".into()),
            "`none` is none of front_single",
        ),
    ] {
        let said = number(entry, &value).unwrap_err();
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn a_request_is_read_and_one_that_is_cut_is_none() {
    let value = |kind, double_value| ParameterValue {
        kind,
        double_value,
        ..ParameterValue::default()
    };
    // As a request to set: names and values.
    let event = rumbo_ros::service_messages::ParameterEvent {
        node: "ab".into(),
        new_parameters: vec![rumbo_ros::service_messages::Parameter {
            name: "front_kp".into(),
            value: value(3, 1.5),
        }],
        ..Default::default()
    };
    let bytes = encode(&event).unwrap();
    // Behind the stamp and the node: what lies 16 bytes further on lies at a multiple of 8 too.
    let mut request = vec![0, 1, 0, 0];
    request.extend(&bytes[4 + 16..bytes.len() - 8]);
    let set = vec![("front_kp".to_owned(), Value::Double(1.5))];
    assert_eq!(question(4, &request), Some(Question::Set(set.clone())));
    assert_eq!(question(5, &request), Some(Question::SetAtomically(set)));
    assert_eq!(question(6, &request), None);
    for short in 0..request.len() - 4 {
        assert_eq!(question(4, &request[..short]), None, "{short}");
    }
}

#[test]
fn an_event_has_what_is_new_and_what_has_changed() {
    let (at, before) = (Time::default(), table());
    let mut now = before.clone();
    assert_eq!(changes("/rumbo", at.clone(), &before, &now), None);
    now[0].value = Some(0.04);
    now[1].value = None;
    let event = changes("/rumbo", at.clone(), &before, &now).unwrap();
    assert_eq!(event.changed_parameters[0].name, "radius_left_m");
    assert_eq!(event.changed_parameters[0].value.double_value, 0.04);
    assert_eq!(event.deleted_parameters[0].name, "radius_right_m");
    let event = changes("/rumbo", at, &[], &before).unwrap();
    assert_eq!(event.new_parameters.len(), before.len());
}

#[test]
fn use_sim_time_tells_whether_the_robot_is_simulated_and_nobody_sets_it() {
    for simulated in [true, false] {
        let mut table = table();
        table.push(ParameterState::use_sim_time(simulated, 99));
        let asked = names(&["use_sim_time"]);
        let expected = (1, simulated, 0.0, String::new());
        assert_eq!(values(&asked, &table), [expected]);
        let known = table.last().unwrap();
        for wanted in [true, false] {
            let refused = number(known, &Value::Bool(wanted)).unwrap_err();
            assert!(refused.contains("cannot be set"), "{refused}");
        }
    }
}
