//! The station's side: addresses, and orders as a page writes them.

use crate::address::Address;
use crate::station::{Order, Waypoint};

#[test]
fn an_address_is_as_rumbo_prints_it_or_shorter() {
    let address = |text: &str| text.parse::<Address>();
    let whole = address("http://127.0.0.1:8360/").unwrap();
    for text in ["127.0.0.1", "127.0.0.1:8360", "http://127.0.0.1:8360"] {
        assert_eq!(address(text).as_ref(), Ok(&whole), "{text}");
    }
    assert_eq!(address("[::1]"), address("http://[::1]:8360/"));
    assert_ne!(address("http://127.0.0.1:8360/?token=12").unwrap(), whole);
    for text in [
        "",
        "https://127.0.0.1:8360/",
        "http://:8360",
        "127.0.0.1:99999",
        "127.0.0.1\r\nX: y",
        "127.0.0.1/?token=1\r\nX: y",
    ] {
        assert!(address(text).is_err(), "{text:?}");
    }
}

#[test]
fn orders_are_those_of_a_page() {
    let waypoint = Waypoint {
        x_m: 0.1,
        y_m: -2.0,
        heading_rad: None,
    };
    let route = Order::Route {
        repeat: false,
        relative: false,
        waypoints: [waypoint],
    };
    for (order, text) in [
        (Order::Stop, r#"{"type":"stop"}"#),
        (Order::Arm, r#"{"type":"arm"}"#),
        (Order::Disarm, r#"{"type":"disarm"}"#),
        (Order::ClearFault, r#"{"type":"clear_fault"}"#),
        (Order::ResetPose, r#"{"type":"reset_pose"}"#),
        (Order::TakeControl, r#"{"type":"take_control"}"#),
        (Order::ReleaseControl, r#"{"type":"release_control"}"#),
        (Order::Mode { mode: 10 }, r#"{"type":"mode","mode":10}"#),
        (
            Order::SetParam {
                id: 3,
                value: 0.0325,
            },
            r#"{"type":"set_param","id":3,"value":0.0325}"#,
        ),
        (
            route,
            r#"{"type":"route","repeat":false,"relative":false,"waypoints":[{"x_m":0.1,"y_m":-2.0,"heading_rad":null}]}"#,
        ),
    ] {
        assert_eq!(serde_json::to_string(&order).unwrap(), text);
    }
}
