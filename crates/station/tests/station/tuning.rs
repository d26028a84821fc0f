//! A search for the page in control: beside the session, one at a time, and gone with its page.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::{page, support};
use futures_util::StreamExt;
use page::*;
use rumbo_station::{Lab, LabConfig, NotTuned, ServeAt, Tuner, serve};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use support::Toy;

/// Searches until it is told to end, or finds and refuses what it is asked to.
#[derive(Debug, Default)]
struct Seeker {
    ended: Arc<AtomicUsize>,
}

impl Tuner for Seeker {
    fn offers(&self) -> Value {
        json!({ "scenarios": ["toy"] })
    }

    fn tune(
        &self,
        request: &str,
        progress: &(dyn Fn(f64) + Sync),
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Value, NotTuned> {
        progress(0.5);
        match request {
            "\"find\"" => return Ok(json!({ "kv": 0.02 })),
            "\"refuse\"" => return Err(NotTuned("no such thing".into())),
            "\"panic\"" => panic!("a fault of the tuner"),
            _ => {}
        }
        while goes_on() {
            std::thread::yield_now();
        }
        self.ended.fetch_add(1, Ordering::Relaxed);
        Err(NotTuned("it was told to end".into()))
    }
}

fn lab(seeker: Seeker) -> Lab {
    let config = LabConfig {
        at: ServeAt::here(0),
        speed: 4.0,
        tuner: Some(Box::new(seeker)),
        ..LabConfig::default()
    };
    serve(config, Box::new(Toy::default())).unwrap()
}

/// A page of the lab, and its number.
async fn open_page(lab: &Lab, key: &str) -> (Page, u64) {
    let mut page = connect_own(lab, key).await;
    let number = wait_for(&mut page, |message| message["page"].as_u64()).await;
    (page, number)
}

/// A search that the page of this number asks for.
async fn ask_for(lab: &Lab, key: &str, page: u64, request: &str) -> Page {
    let origin = format!("http://{}", host(lab));
    let at = format!("/tune/search?page={page}");
    let mut search = connect_at(&at, lab, key, Some(&origin)).await.unwrap();
    say(&mut search, json!(request)).await;
    search
}

async fn found(search: &mut Page) -> Value {
    wait_for(search, |message| message.get("found").cloned()).await
}

async fn refused(search: &mut Page) -> String {
    wait_for(search, |message| {
        message["error"].as_str().map(str::to_owned)
    })
    .await
}

#[tokio::test]
async fn a_search_says_how_far_it_is_and_stop_does_not_wait_for_it() {
    let lab = lab(Seeker::default());
    let key = open(&lab);
    let (mut page, number) = open_page(&lab, &key).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    let mut search = ask_for(&lab, &key, number, "for ever").await;
    wait_for(&mut search, |message| {
        (message["share"] == 0.5).then_some(())
    })
    .await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for(&mut page, |message| armed(message, true)).await;
    say(&mut page, json!({"type": "stop"})).await;
    wait_for(&mut page, |message| armed(message, false)).await;
    wait_for(&mut search, |message| {
        (message["share"] == 0.5).then_some(())
    })
    .await;
}

#[tokio::test]
async fn there_is_one_search_at_a_time_and_it_ends_with_its_connection() {
    let seeker = Seeker::default();
    let ended = Arc::clone(&seeker.ended);
    let lab = lab(seeker);
    let key = open(&lab);
    let (_page, number) = open_page(&lab, &key).await;
    let mut first = ask_for(&lab, &key, number, "for ever").await;
    wait_for(&mut first, |message| message["share"].as_f64()).await;
    let mut second = ask_for(&lab, &key, number, "find").await;
    let why = refused(&mut second).await;
    assert!(why.contains("another page's search is running"), "{why}");
    assert_eq!(ended.load(Ordering::Relaxed), 0);
    drop(first);
    let mut third = ask_for(&lab, &key, number, "find").await;
    assert_eq!(found(&mut third).await, json!({ "kv": 0.02 }));
    assert_eq!(ended.load(Ordering::Relaxed), 1);
}

#[tokio::test]
async fn why_a_search_failed_is_said_and_the_next_one_begins() {
    let lab = lab(Seeker::default());
    let key = open(&lab);
    let (_page, number) = open_page(&lab, &key).await;
    for (request, why) in [
        ("refuse", "no such thing"),
        ("panic", "a fault of the program; please report it"),
    ] {
        let mut search = ask_for(&lab, &key, number, request).await;
        assert_eq!(refused(&mut search).await, why);
    }
    let mut search = ask_for(&lab, &key, number, "find").await;
    found(&mut search).await;
}

#[tokio::test]
async fn only_the_page_in_control_searches_and_a_viewer_learns_nothing() {
    let lab = lab(Seeker::default());
    let (key, watching) = (open(&lab), redeem(&lab, lab.viewers_url()));
    let (mut driver, driving) = open_page(&lab, &key).await;
    let (_other, number) = open_page(&lab, &key).await;
    say(&mut driver, json!({"type": "take_control"})).await;
    wait_for(&mut driver, |message| {
        (message["seat"] == "driver").then_some(())
    })
    .await;
    for page in [number, 99] {
        let mut search = ask_for(&lab, &key, page, "find").await;
        let why = refused(&mut search).await;
        assert_eq!(why, "another page has control; take it first");
    }
    found(&mut ask_for(&lab, &key, driving, "find").await).await;
    let (own, at) = (format!("http://{}", host(&lab)), host(&lab));
    for (key, origin, expected) in [
        (key.as_str(), own.as_str(), "200"),
        (&watching, &own, "403"),
        ("", &own, "403"),
        (&key, "http://evil.example", "403"),
    ] {
        let has = format!("Bearer {key}");
        let headers = [
            ("Host", at.as_str()),
            ("Origin", origin),
            ("Authorization", &has),
        ];
        assert_eq!(status(&ask(&at, "GET", "/tune", &headers)), expected);
        let search = format!("/tune/search?page={driving}");
        let search = connect_at(&search, &lab, key, Some(origin)).await;
        assert_eq!(search.is_ok(), expected == "200");
    }
}

#[tokio::test]
async fn a_request_without_end_is_not_taken() {
    let lab = lab(Seeker::default());
    let key = open(&lab);
    let (_page, number) = open_page(&lab, &key).await;
    let mut search = ask_for(&lab, &key, number, &"x".repeat(5_000)).await;
    let ends = async { while let Some(Ok(_)) = search.next().await {} };
    tokio::time::timeout(PATIENCE, ends).await.unwrap();
    found(&mut ask_for(&lab, &key, number, "find").await).await;
}

#[tokio::test]
async fn where_nothing_is_simulated_nothing_is_tuned() {
    let lab = start(1.0);
    let (key, at) = (open(&lab), host(&lab));
    let has = format!("Bearer {key}");
    let headers = [("Host", at.as_str()), ("Authorization", &has)];
    let answer = ask(&at, "GET", "/tune", &headers);
    assert_eq!(status(&answer), "404");
    assert!(answer.contains("the lab of a simulated robot"), "{answer}");
}
