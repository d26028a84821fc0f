//! Who may see and drive: somebody else's page, a viewer, a second controller.
#![allow(clippy::unwrap_used, clippy::panic)]

#[path = "support/page.rs"]
mod page;
mod support;

use page::*;
use rumbo_station::{Lab, LabConfig, ServeAt, serve};
use serde_json::{Value, json};
use support::Toy;
use tokio_tungstenite::tungstenite::Error;

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

fn seat<'a>(message: &'a Value, wanted: &str) -> Option<&'a Value> {
    (message["type"] == "control" && message["seat"] == wanted).then_some(message)
}

/// Pages of a controller, of the same browser's second tab, and of a viewer.
async fn three_pages(lab: &Lab) -> [Page; 3] {
    let cookie = open(lab);
    let watching = redeem(lab, lab.viewers_url());
    let mut pages = [
        connect_own(lab, &cookie).await,
        connect_own(lab, &cookie).await,
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
    wait_for(&mut driver, |message| event(message, "STOP: done")).await;
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
    wait_for(&mut second, |message| event(message, "STOP: done")).await;
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
fn the_viewers_address_opens_for_many_and_a_made_up_cookie_for_nobody() {
    let lab = start(0.0);
    let host = host(&lab);
    for _ in 0..3 {
        let cookie = redeem(&lab, lab.viewers_url());
        let page = request(&lab, "/", &[("Host", &host), ("Cookie", &cookie)]);
        assert_eq!(status(&page), "200");
    }
    let port = host.rsplit_once(':').unwrap().1;
    for cookie in [
        format!("rumbo_{port}="),
        format!("rumbo_watch_{port}={}", "0".repeat(64)),
    ] {
        let answer = request(&lab, "/", &[("Host", &host), ("Cookie", &cookie)]);
        assert_eq!(status(&answer), "403", "{cookie}");
    }
    // A token in any other place than the address of the page is none.
    let token = lab.viewers_url().split_once('?').unwrap().1;
    let file = format!("/src/main.js?{token}");
    assert_eq!(status(&request(&lab, &file, &[("Host", &host)])), "403");
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
