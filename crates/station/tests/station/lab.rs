//! The lab as a browser meets it.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::{page, support};
use futures_util::{SinkExt, StreamExt};
use page::*;
use rumbo_station::{LabConfig, ServeAt, ServeError, serve};
use serde_json::{Value, json};
use support::Toy;
use tokio_tungstenite::tungstenite::Message;

#[test]
fn a_port_in_use_is_named_with_the_remedy() {
    let lab = start(0.0);
    let port = host(&lab).rsplit_once(':').unwrap().1.parse().unwrap();
    let error = serve(
        LabConfig {
            at: ServeAt::here(port),
            speed: 0.0,
            ..LabConfig::default()
        },
        Box::new(Toy::default()),
    )
    .unwrap_err();
    assert!(matches!(error, ServeError::PortInUse(used) if used.port() == port));
    let text = error.to_string();
    assert!(
        text.contains(&port.to_string()) && text.contains("--port"),
        "{text}"
    );
}

#[test]
fn ending_the_lab_frees_its_port() {
    let lab = start(1.0);
    let port = host(&lab).rsplit_once(':').unwrap().1.parse().unwrap();
    drop(lab);
    serve(
        LabConfig {
            at: ServeAt::here(port),
            speed: 0.0,
            ..LabConfig::default()
        },
        Box::new(Toy::default()),
    )
    .unwrap();
}

#[tokio::test]
async fn garbage_gets_a_reason_and_is_closed_while_the_robot_goes_on() {
    let lab = start(4.0);
    let key = open(&lab);
    let mut driver = connect_own(&lab, &key).await;
    wait_for(&mut driver, |message| event(message, "connected")).await;
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| armed(message, true)).await;

    for garbage in [
        Message::text("\u{1}garbage"),
        Message::text(r#"{"type":"self_destruct"}"#),
        Message::binary(vec![0xFF; 9]),
    ] {
        let mut page = connect_own(&lab, &key).await;
        page.send(garbage).await.unwrap();
        let why = wait_for(&mut page, |message| {
            (message["type"] == "error").then(|| message["text"].to_string())
        })
        .await;
        assert!(why.contains("not understood"), "{why}");
        let close = loop {
            match page.next().await {
                Some(Ok(Message::Close(frame))) => break frame,
                Some(Ok(_)) => {}
                other => panic!("{other:?}"),
            }
        };
        let code = u16::from(close.unwrap().code);
        assert!([1003, 1008].contains(&code), "{code}");
    }

    let now_s = wait_for(&mut driver, |message| message["state"]["t_s"].as_f64()).await;
    let robot = wait_for(&mut driver, |message| {
        let later = message["state"]["t_s"].as_f64()? > now_s + 1.0;
        later.then(|| message["state"]["robot"].clone())
    })
    .await;
    assert_eq!(robot["armed"], true);
}

#[tokio::test]
async fn a_page_that_comes_back_gets_the_recent_past_and_does_not_arm() {
    let lab = start(8.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    let last_s = |message: &Value| message["rows"].as_array()?.last()?[0].as_f64();
    wait_for(&mut page, |message| {
        last_s(message).filter(|t_s| *t_s > 3.0)
    })
    .await;
    drop(page);
    let mut page = connect_own(&lab, &key).await;
    let first_s = wait_for(&mut page, |message| {
        message["rows"].as_array()?.first()?[0].as_f64()
    })
    .await;
    assert!(first_s < 0.5, "{first_s}");
    wait_for(&mut page, |message| armed(message, false)).await;
}

#[tokio::test]
async fn commands_are_acknowledged_stop_disarms_and_a_reset_starts_a_new_run() {
    let lab = start(4.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(&mut page, json!({"type": "mode", "mode": 1})).await;
    say(&mut page, json!({"type": "reference", "value": 0.5})).await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for(&mut page, |message| {
        event(message, "setpoint 50.0 cm: acknowledged")
    })
    .await;
    wait_for(&mut page, |message| armed(message, true)).await;
    say(&mut page, json!({"type": "stop"})).await;
    wait_for(&mut page, |message| event(message, "STOP: acknowledged")).await;
    wait_for(&mut page, |message| armed(message, false)).await;

    say(
        &mut page,
        json!({"type": "reset", "scenario": "nowhere", "world": null, "seed": 1}),
    )
    .await;
    wait_for(&mut page, |message| {
        event(message, "refused, there is no scenario nowhere")
    })
    .await;
    say(
        &mut page,
        json!({"type": "reset", "scenario": "toy", "world": null, "seed": 7}),
    )
    .await;
    let seed = wait_for(&mut page, |message| {
        message["scene"]["choice"]["seed"].as_u64()
    })
    .await;
    assert_eq!(seed, 7);
    wait_for(&mut page, |message| {
        message["rows"].as_array()?.first()?[0]
            .as_f64()
            .filter(|t_s| *t_s < 0.5)
    })
    .await;
}

#[tokio::test]
async fn a_goal_and_a_route_are_passed_on_and_shown_once_the_robot_took_them() {
    let lab = start(8.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    let task = |message: &Value| {
        let task = &message["state"]["robot"]["task"];
        task.is_object().then(|| task.clone())
    };
    say(&mut page, json!({"type": "mode", "mode": 8})).await;
    say(&mut page, json!({"type": "goal", "x_m": 1.5, "y_m": -0.5})).await;
    wait_for(&mut page, |message| {
        (task(message)?["goal"] == json!([1.5, -0.5])).then_some(())
    })
    .await;
    say(&mut page, json!({"type": "lane"})).await;
    wait_for(&mut page, |message| {
        let task = task(message)?;
        (task["lane"] == true && task["goal"].is_null()).then_some(())
    })
    .await;

    say(&mut page, json!({"type": "mode", "mode": 7})).await;
    let places = json!([{"x_m": 1.0, "y_m": 0.5}, {"x_m": 0.0, "y_m": 0.0, "heading_rad": 1.5}]);
    say(
        &mut page,
        json!({"type": "route", "repeat": true, "relative": true, "waypoints": places}),
    )
    .await;
    let shown = json!([{"x_m": 1.0, "y_m": 0.5, "heading_rad": null},
                       {"x_m": 0.0, "y_m": 0.0, "heading_rad": 1.5}]);
    let route = wait_for(&mut page, |message| {
        let route = task(message)?["route"].clone();
        (route["waypoints"] == shown).then_some(route)
    })
    .await;
    assert!(route["repeat"] == true && route["relative"] == true);
}

#[tokio::test]
async fn a_held_movement_ends_when_the_page_says_no_more() {
    let lab = start(1.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(
        &mut page,
        json!({"type": "move_duty", "movement": 1, "duty": 0.4, "held": true}),
    )
    .await;
    wait_for(&mut page, |message| event(message, "movement forward")).await;
    wait_for(&mut page, |message| {
        event(message, "movement release both wheels")
    })
    .await;
}

fn parameter<'a>(message: &'a Value, name: &str) -> Option<&'a Value> {
    let all = message["parameters"].as_array()?;
    all.iter().find(|parameter| parameter["name"] == name)
}

#[tokio::test]
async fn parameters_are_read_written_and_refused_with_the_reason() {
    let lab = start(8.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    let read = |message: &Value| {
        let base = parameter(message, "base_m")?;
        base["value"].as_f64().map(|_| base.clone())
    };
    let base = wait_for(&mut page, read).await;
    assert_eq!(base["value"], base["default"]);
    say(
        &mut page,
        json!({"type": "set_param", "id": base["id"], "value": 0.125}),
    )
    .await;
    wait_for(&mut page, |message| {
        (parameter(message, "base_m")?["value"] == 0.125).then_some(())
    })
    .await;
    say(
        &mut page,
        json!({"type": "set_param", "id": base["id"], "value": 100}),
    )
    .await;
    let refused = |message: &Value| {
        parameter(message, "base_m")?["refused"]
            .as_str()
            .map(str::to_owned)
    };
    let why = wait_for(&mut page, refused).await;
    assert!(why.contains("0.03 to 1 m"), "{why}");
    say(&mut page, json!({"type": "reset_params"})).await;
    wait_for(&mut page, |message| {
        (parameter(message, "base_m")?["value"] == base["default"]).then_some(())
    })
    .await;
}

#[tokio::test]
async fn a_paused_simulation_stands_still() {
    let lab = start(0.0);
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    let t_s = wait_for(&mut page, |message| message["state"]["t_s"].as_f64()).await;
    assert_eq!(t_s, 0.0);
    say(&mut page, json!({"type": "speed", "factor": 4})).await;
    wait_for(&mut page, |message| {
        message["state"]["t_s"].as_f64().filter(|t_s| *t_s > 0.2)
    })
    .await;
}
