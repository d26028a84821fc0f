//! Who may see and drive: somebody else's page, a viewer, a second controller.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::{page, support};
use page::*;
use rumbo_station::{Lab, LabConfig, RecordingSetting, ServeAt, serve};
use serde_json::{Value, json};
use support::Toy;
use tokio_tungstenite::tungstenite::Error;

#[test]
fn only_who_has_the_address_that_was_printed_gets_a_key_and_once() {
    let lab = start(0.0);
    for url in ["", "?token=00", "?token=", "?watch=00", "?"] {
        assert_eq!(status(&ask_for_key(&lab, url, &[])), "403", "{url}");
    }
    let key = open(&lab);
    let again = ask_for_key(&lab, lab.url(), &[]);
    assert_eq!(status(&again), "403", "the token opens once");
    assert!(again.contains("was used already"), "{again}");
    // In the browser that has the key the address opens again, and without one the page goes on.
    let has = format!("Bearer {key}");
    for url in [lab.url(), ""] {
        let answer = ask_for_key(&lab, url, &[("Authorization", &has)]);
        assert!(
            status(&answer) == "200" && answer.ends_with(&key),
            "{answer}"
        );
    }
}

#[test]
fn the_page_itself_is_no_secret_and_is_served_with_care() {
    let lab = start(0.0);
    let host = host(&lab);
    let page = ask(&host, "GET", "/", &[("Host", &host)]);
    assert_eq!(status(&page), "200");
    for header in [
        "content-security-policy: default-src 'self'",
        "x-content-type-options: nosniff",
        "x-frame-options: DENY",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
    ] {
        assert!(page.contains(header), "{header} is missing: {page}");
    }
    assert!(!page.contains("set-cookie"), "{page}");
    let script = ask(&host, "GET", "/src/dom.js", &[("Host", &host)]);
    assert!(
        script.contains("cache-control: private, max-age=10"),
        "{script}"
    );
    let outside = ask(&host, "GET", "/../Cargo.toml", &[("Host", &host)]);
    assert_eq!(status(&outside), "404");
}

#[test]
fn what_fetches_the_printed_address_without_being_the_page_does_not_use_it_up() {
    let lab = start(0.0);
    let host = host(&lab);
    let query = lab.url().split_once('?').unwrap().1;
    let origin = format!("http://{host}");
    for (method, target) in [
        ("HEAD", format!("/?{query}")),
        ("GET", format!("/?{query}")),
        ("HEAD", format!("/key?{query}")),
        ("GET", format!("/key?{query}")),
    ] {
        ask(
            &host,
            method,
            &target,
            &[("Host", &host), ("Origin", &origin)],
        );
    }
    // A page of another origin, and what is no page.
    for headers in [
        &[("Host", host.as_str()), ("Origin", "null")][..],
        &[("Host", &host), ("Origin", "http://evil.example")],
        &[("Host", &host)],
    ] {
        let answer = ask(&host, "POST", &format!("/key?{query}"), headers);
        assert_eq!(status(&answer), "403", "{headers:?}");
    }
    open(&lab);
}

#[test]
fn another_host_or_origin_is_refused_even_with_the_key() {
    let lab = start(0.0);
    let host = host(&lab);
    let has = format!("Bearer {}", open(&lab));
    let origin = format!("http://{host}");
    for (method, target) in [("GET", "/"), ("POST", "/key"), ("GET", "/src/main.js")] {
        for (host, origin) in [
            ("evil.example", origin.as_str()),
            (&host, "http://evil.example"),
        ] {
            let headers = [("Host", host), ("Origin", origin), ("Authorization", &has)];
            let answer = ask(&self::host(&lab), method, target, &headers);
            assert_eq!(status(&answer), "403", "{target}: {host}, {origin}");
        }
    }
}

#[tokio::test]
async fn the_websocket_of_another_page_is_refused() {
    let lab = start(1.0);
    let (key, made_up) = (open(&lab), "0".repeat(64));
    let own = format!("http://{}", host(&lab));
    for (key, origin) in [
        (&key, Some("http://evil.example")),
        (&key, Some("null")),
        (&key, None),
        (&made_up, Some(own.as_str())),
    ] {
        match connect(&lab, key, origin).await {
            Err(Error::Http(answer)) => assert_eq!(answer.status(), 403),
            other => panic!("{origin:?}: {other:?}"),
        }
    }
}

/// A browser sends its cookies to every port of a host: two labs must not share any, and neither must know the other's
/// keys.
#[tokio::test]
async fn two_labs_at_once_in_one_browser_do_not_get_into_each_others_way() {
    let labs = [start(1.0), start(1.0)];
    let keys = labs.each_ref().map(open);
    for (lab, key) in labs.iter().zip(&keys) {
        let mut page = connect_own(lab, key).await;
        wait_for(&mut page, |message| event(message, "connected")).await;
    }
    let [first, second] = &labs;
    for (lab, key) in [(first, &keys[1]), (second, &keys[0])] {
        let answer = ask_for_key(lab, "", &[("Authorization", &format!("Bearer {key}"))]);
        assert_eq!(status(&answer), "403");
    }
}

fn seat<'a>(message: &'a Value, wanted: &str) -> Option<&'a Value> {
    (message["type"] == "control" && message["seat"] == wanted).then_some(message)
}

/// Pages of a controller, of the same browser's second tab, and of a viewer.
async fn three_pages(lab: &Lab) -> [Page; 3] {
    let key = open(lab);
    let watching = redeem(lab, lab.viewers_url());
    let mut pages = [
        connect_own(lab, &key).await,
        connect_own(lab, &key).await,
        connect_own(lab, &watching).await,
    ];
    for page in &mut pages {
        wait_for(page, |message| event(message, "connected")).await;
    }
    pages
}

#[tokio::test]
async fn a_viewer_cannot_drive_and_can_stop() {
    let lab = start(4.0);
    let [mut driver, _, mut viewer] = three_pages(&lab).await;
    for order in [
        json!({"type": "arm"}),
        json!({"type": "take_control"}),
        json!({"type": "reset", "scenario": "toy", "world": null, "seed": 7}),
        json!({"type": "speed", "factor": 0}),
        json!({"type": "set_param", "id": 0, "value": 1}),
    ] {
        say(&mut viewer, order).await;
        wait_for(&mut viewer, |message| {
            event(message, "refused: this page may watch")
        })
        .await;
    }
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| armed(message, true)).await;
    wait_for(&mut viewer, |message| armed(message, true)).await;
    say(&mut viewer, json!({"type": "stop"})).await;
    wait_for(&mut driver, |message| event(message, "STOP: acknowledged")).await;
    wait_for(&mut driver, |message| armed(message, false)).await;
}

#[tokio::test]
async fn of_two_controllers_one_has_control_until_it_leaves_or_the_other_takes_it() {
    let lab = start(4.0);
    let [mut first, mut second, _viewer] = three_pages(&lab).await;
    say(&mut first, json!({"type": "mode", "mode": 1})).await;
    wait_for(&mut first, |message| seat(message, "driver").map(|_| ())).await;
    wait_for(&mut second, |message| {
        seat(message, "passenger").map(|_| ())
    })
    .await;
    say(&mut second, json!({"type": "arm"})).await;
    wait_for(&mut second, |message| {
        event(message, "refused: another page has control")
    })
    .await;
    // It may stop all the same, and that takes no control.
    say(&mut second, json!({"type": "stop"})).await;
    wait_for(&mut second, |message| event(message, "STOP: acknowledged")).await;
    say(&mut first, json!({"type": "arm"})).await;
    wait_for(&mut first, |message| armed(message, true)).await;

    say(&mut second, json!({"type": "take_control"})).await;
    wait_for(&mut first, |message| seat(message, "passenger").map(|_| ())).await;
    say(&mut first, json!({"type": "disarm"})).await;
    wait_for(&mut first, |message| {
        event(message, "refused: another page has control")
    })
    .await;
    // With the page goes control.
    drop(second);
    wait_for(&mut first, |message| seat(message, "free").map(|_| ())).await;
    say(&mut first, json!({"type": "disarm"})).await;
    wait_for(&mut first, |message| armed(message, false)).await;
}

#[test]
fn the_viewers_address_opens_for_many() {
    let lab = start(0.0);
    for _ in 0..3 {
        redeem(&lab, lab.viewers_url());
    }
}

#[test]
fn an_address_that_is_everybodys_is_not_served() {
    let everywhere = ServeAt {
        address: "0.0.0.0".parse().unwrap(),
        port: 0,
    };
    let config = LabConfig {
        at: everywhere,
        ..LabConfig::default()
    };
    let error = serve(config, Box::new(Toy::default())).unwrap_err();
    let said = error.to_string();
    assert!(said.contains("--listen") && !said.contains('\n'), "{said}");
    let foreign = ServeAt {
        // Of the block kept for documentation: no machine has it.
        address: "192.0.2.1".parse().unwrap(),
        port: 0,
    };
    let config = LabConfig {
        at: foreign,
        ..LabConfig::default()
    };
    let error = serve(config, Box::new(Toy::default())).unwrap_err();
    let said = error.to_string();
    assert!(said.contains("no such address"), "{said}");
}

#[test]
fn recordings_are_for_a_page_that_may_drive_on_this_computer() {
    let folder = tempfile::tempdir().unwrap();
    let config = LabConfig {
        at: ServeAt::here(0),
        recording: Some(RecordingSetting {
            folder: folder.path().to_owned(),
        }),
        ..LabConfig::default()
    };
    let lab = serve(config, Box::new(Toy::default())).unwrap();
    let (host, watching, driving) = (host(&lab), redeem(&lab, lab.viewers_url()), open(&lab));
    let status_of = |method: &str, target: &str, key: &str, origin: &str| {
        let has = format!("Bearer {key}");
        let headers = [
            ("Host", host.as_str()),
            ("Origin", origin),
            ("Authorization", &has),
        ];
        status(&ask(&host, method, target, &headers)).to_owned()
    };
    let own = format!("http://{host}");
    assert_eq!(status_of("GET", "/recordings", &driving, &own), "200");
    for (key, origin) in [
        (watching.as_str(), own.as_str()),
        ("", &own),
        (&driving, "http://evil.example"),
    ] {
        for (method, target) in [
            ("GET", "/recordings"),
            ("GET", "/recordings/a"),
            ("POST", "/recordings/a/replay"),
            ("DELETE", "/recordings/a?page=1"),
        ] {
            let status = status_of(method, target, key, origin);
            assert_eq!(status, "403", "{method} {target} {origin}");
        }
    }
    // No page is open, so none has control.
    assert_eq!(
        status_of("DELETE", "/recordings/a?page=1", &driving, &own),
        "403"
    );
}
