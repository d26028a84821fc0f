//! The lab as a browser, and as somebody else's page, meets it.
#![allow(clippy::unwrap_used, clippy::panic)]

mod support;

use futures_util::{SinkExt, StreamExt};
use rumbo_station::{Lab, LabConfig, ServeError, serve};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Duration;
use support::Toy;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::http::HeaderValue;
use tokio_tungstenite::tungstenite::{Error, Message};

/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(20);

fn start(speed: f64) -> Lab {
    serve(
        LabConfig {
            port: 0,
            speed,
            recording: None,
        },
        Box::new(Toy::default()),
    )
    .unwrap()
}

fn host(lab: &Lab) -> String {
    lab.url()
        .trim_start_matches("http://")
        .split('/')
        .next()
        .unwrap()
        .to_owned()
}

/// One request with these header lines; the whole answer.
fn request(lab: &Lab, target: &str, headers: &[(&str, &str)]) -> String {
    let mut stream = TcpStream::connect(host(lab)).unwrap();
    let mut text = format!("GET {target} HTTP/1.1\r\nConnection: close\r\n");
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    stream.write_all((text + "\r\n").as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

fn status(answer: &str) -> &str {
    answer.split(' ').nth(1).unwrap()
}

/// The cookie for the token in the lab's address.
fn open(lab: &Lab) -> String {
    let host = host(lab);
    let target = lab.url().split_once(&host).unwrap().1.to_owned();
    let answer = request(lab, &target, &[("Host", &host)]);
    assert_eq!(status(&answer), "303", "{answer}");
    let cookie = answer
        .lines()
        .find_map(|line| line.strip_prefix("set-cookie: "))
        .unwrap();
    cookie.split(';').next().unwrap().to_owned()
}

type Page =
    tokio_tungstenite::WebSocketStream<tokio_tungstenite::MaybeTlsStream<tokio::net::TcpStream>>;

async fn connect(lab: &Lab, cookie: &str, origin: Option<&str>) -> Result<Page, Error> {
    let mut request = format!("ws://{}/ws", host(lab))
        .into_client_request()
        .unwrap();
    request
        .headers_mut()
        .insert("Cookie", HeaderValue::from_str(cookie).unwrap());
    if let Some(origin) = origin {
        request
            .headers_mut()
            .insert("Origin", HeaderValue::from_str(origin).unwrap());
    }
    tokio_tungstenite::connect_async(request)
        .await
        .map(|(page, _)| page)
}

async fn connect_own(lab: &Lab, cookie: &str) -> Page {
    let origin = format!("http://{}", host(lab));
    connect(lab, cookie, Some(&origin)).await.unwrap()
}

async fn say(page: &mut Page, order: Value) {
    page.send(Message::text(order.to_string())).await.unwrap();
}

/// Reads on until `wanted` finds what it looks for.
async fn wait_for<T>(page: &mut Page, mut wanted: impl FnMut(&Value) -> Option<T>) -> T {
    let search = async {
        loop {
            let message = page.next().await.unwrap().unwrap();
            if let Message::Text(text) = message
                && let Some(found) = wanted(&serde_json::from_str(&text).unwrap())
            {
                return found;
            }
        }
    };
    tokio::time::timeout(PATIENCE, search).await.unwrap()
}

fn event(message: &Value, part: &str) -> Option<()> {
    let texts = message["events"].as_array()?;
    texts
        .iter()
        .any(|event| event["text"].as_str().unwrap().contains(part))
        .then_some(())
}

fn armed(message: &Value, wanted: bool) -> Option<()> {
    (message["state"]["robot"]["armed"] == wanted).then_some(())
}

#[test]
fn only_who_has_the_address_that_was_printed_sees_the_page() {
    let lab = start(0.0);
    let host = host(&lab);
    assert_eq!(status(&request(&lab, "/", &[("Host", &host)])), "403");
    assert_eq!(
        status(&request(&lab, "/src/main.js", &[("Host", &host)])),
        "403"
    );
    assert_eq!(
        status(&request(&lab, "/?token=00", &[("Host", &host)])),
        "403"
    );
    let cookie = open(&lab);
    let page = request(&lab, "/", &[("Host", &host), ("Cookie", &cookie)]);
    assert_eq!(status(&page), "200");
    for header in [
        "content-security-policy: default-src 'self'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
    ] {
        assert!(page.contains(header), "{header} is missing: {page}");
    }
    let again = lab.url().split_once(&host).unwrap().1;
    assert_eq!(
        status(&request(&lab, again, &[("Host", &host)])),
        "403",
        "the token opens once"
    );
    assert_eq!(
        status(&request(
            &lab,
            "/../Cargo.toml",
            &[("Host", &host), ("Cookie", &cookie)]
        )),
        "404"
    );
}

#[test]
fn another_host_or_origin_is_refused_even_with_the_cookie() {
    let lab = start(0.0);
    let host = host(&lab);
    let cookie = open(&lab);
    for target in ["/", "/ws", "/src/main.js"] {
        let rebound = request(
            &lab,
            target,
            &[("Host", "evil.example"), ("Cookie", &cookie)],
        );
        assert_eq!(status(&rebound), "403", "{target}");
        let foreign = [
            ("Host", host.as_str()),
            ("Cookie", &cookie),
            ("Origin", "http://evil.example"),
        ];
        assert_eq!(status(&request(&lab, target, &foreign)), "403", "{target}");
    }
}

#[test]
fn a_port_in_use_is_named_with_the_remedy() {
    let lab = start(0.0);
    let port = host(&lab).rsplit_once(':').unwrap().1.parse().unwrap();
    let error = serve(
        LabConfig {
            port,
            speed: 0.0,
            recording: None,
        },
        Box::new(Toy::default()),
    )
    .unwrap_err();
    assert!(matches!(error, ServeError::PortInUse(used) if used == port));
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
            port,
            speed: 0.0,
            recording: None,
        },
        Box::new(Toy::default()),
    )
    .unwrap();
}

#[tokio::test]
async fn the_websocket_of_another_page_is_refused() {
    let lab = start(1.0);
    let cookie = open(&lab);
    for (cookie, origin) in [
        (cookie.as_str(), Some("http://evil.example")),
        (cookie.as_str(), Some("null")),
        (cookie.as_str(), None),
        ("", Some(format!("http://{}", host(&lab)).as_str())),
    ] {
        match connect(&lab, cookie, origin).await {
            Err(Error::Http(answer)) => assert_eq!(answer.status(), 403),
            other => panic!("{origin:?}: {other:?}"),
        }
    }
}

#[tokio::test]
async fn garbage_is_told_why_and_closed_while_the_robot_goes_on() {
    let lab = start(4.0);
    let cookie = open(&lab);
    let mut driver = connect_own(&lab, &cookie).await;
    wait_for(&mut driver, |message| event(message, "connected")).await;
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| armed(message, true)).await;

    for garbage in [
        Message::text("\u{1}garbage"),
        Message::text(r#"{"type":"self_destruct"}"#),
        Message::binary(vec![0xFF; 9]),
    ] {
        let mut page = connect_own(&lab, &cookie).await;
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
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
    let last_s = |message: &Value| message["rows"].as_array()?.last()?[0].as_f64();
    wait_for(&mut page, |message| {
        last_s(message).filter(|t_s| *t_s > 3.0)
    })
    .await;
    drop(page);
    let mut page = connect_own(&lab, &cookie).await;
    let first_s = wait_for(&mut page, |message| {
        message["rows"].as_array()?.first()?[0].as_f64()
    })
    .await;
    assert!(first_s < 0.5, "{first_s}");
    wait_for(&mut page, |message| armed(message, false)).await;
}

#[tokio::test]
async fn commands_are_acknowledged_stop_disarms_and_a_reset_starts_anew() {
    let lab = start(4.0);
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(&mut page, json!({"type": "mode", "mode": 1})).await;
    say(&mut page, json!({"type": "reference", "value": 0.5})).await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for(&mut page, |message| {
        event(message, "reference 50.0 cm: done")
    })
    .await;
    wait_for(&mut page, |message| armed(message, true)).await;
    say(&mut page, json!({"type": "stop"})).await;
    wait_for(&mut page, |message| event(message, "STOP: done")).await;
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
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    let errand = |message: &Value| {
        let errand = &message["state"]["robot"]["errand"];
        errand.is_object().then(|| errand.clone())
    };
    say(&mut page, json!({"type": "mode", "mode": 8})).await;
    say(&mut page, json!({"type": "goal", "x_m": 1.5, "y_m": -0.5})).await;
    wait_for(&mut page, |message| {
        (errand(message)?["goal"] == json!([1.5, -0.5])).then_some(())
    })
    .await;
    say(&mut page, json!({"type": "lane"})).await;
    wait_for(&mut page, |message| {
        let errand = errand(message)?;
        (errand["lane"] == true && errand["goal"].is_null()).then_some(())
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
        let route = errand(message)?["route"].clone();
        (route["waypoints"] == shown).then_some(route)
    })
    .await;
    assert!(route["repeat"] == true && route["relative"] == true);
}

#[tokio::test]
async fn a_held_movement_ends_when_the_page_says_no_more() {
    let lab = start(1.0);
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(
        &mut page,
        json!({"type": "move_duty", "movement": 1, "duty": 0.4, "held": true}),
    )
    .await;
    wait_for(&mut page, |message| event(message, "Forward")).await;
    wait_for(&mut page, |message| event(message, "movement Stop")).await;
}

fn parameter<'a>(message: &'a Value, name: &str) -> Option<&'a Value> {
    let all = message["parameters"].as_array()?;
    all.iter().find(|parameter| parameter["name"] == name)
}

#[tokio::test]
async fn parameters_are_read_written_and_refused_with_the_reason() {
    let lab = start(8.0);
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
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
    let cookie = open(&lab);
    let mut page = connect_own(&lab, &cookie).await;
    let t_s = wait_for(&mut page, |message| message["state"]["t_s"].as_f64()).await;
    assert_eq!(t_s, 0.0);
    say(&mut page, json!({"type": "speed", "factor": 4})).await;
    wait_for(&mut page, |message| {
        message["state"]["t_s"].as_f64().filter(|t_s| *t_s > 0.2)
    })
    .await;
}
