//! A program beside the pages: it reads what they read and gives orders by the same rules.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::page;
use page::*;
use rumbo_log::State;
use rumbo_session::{Order, Seat};
use rumbo_station::Client;
use rumbo_wire::Command;
use serde_json::json;
use std::time::{Duration, Instant};

/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(20);
const ARM: Order = Order::Robot(Command::Arm);

/// Reads on until a state is as wanted.
async fn wait_for_state(client: &mut Client, wanted: impl Fn(&State) -> bool) {
    let until = Instant::now() + PATIENCE;
    while Instant::now() < until {
        let news = client.news().unwrap();
        if news.state.is_some_and(|state| wanted(&state)) {
            return;
        }
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    panic!("no such state");
}

#[tokio::test]
async fn a_client_arms_and_any_page_stops() {
    let lab = start(4.0);
    let key = open(&lab);
    let mut client = lab.client().unwrap();
    wait_for_state(&mut client, |state| state.link.connected).await;
    client.order(ARM).unwrap();
    wait_for_state(&mut client, |state| state.robot.armed).await;
    assert_eq!(client.view().seat, Seat::Driver);
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| armed(message, true)).await;
    say(&mut page, json!({"type": "stop"})).await;
    wait_for_state(&mut client, |state| !state.robot.armed).await;
}

#[tokio::test]
async fn a_page_with_control_keeps_a_client_from_all_but_stop() {
    let lab = start(4.0);
    let key = open(&lab);
    let mut client = lab.client().unwrap();
    wait_for_state(&mut client, |state| state.link.connected).await;
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for_state(&mut client, |state| state.robot.armed).await;
    let why = client.order(ARM).unwrap_err();
    assert!(why.contains("another page has control"), "{why}");
    client.order(Order::Robot(Command::Stop)).unwrap();
    wait_for(&mut page, |message| armed(message, false)).await;
}

#[tokio::test]
async fn a_client_does_not_keep_a_session_going() {
    let lab = start(4.0);
    let mut client = lab.client().unwrap();
    assert!(client.news().is_some());
    // It waits for the session's thread.
    tokio::task::spawn_blocking(|| drop(lab)).await.unwrap();
    assert!(client.news().is_none());
    assert!(client.order(ARM).is_err());
}
