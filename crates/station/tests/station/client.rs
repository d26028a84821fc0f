//! A program beside the pages: it reads what they read and gives orders by the same rules.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::page;
use crate::support::Toy;
use page::*;
use rumbo_log::State;
use rumbo_session::{Order, Seat};
use rumbo_station::{Client, Extras, Lab, LabConfig, ServeAt, serve_fleet};
use rumbo_wire::Command;
use serde_json::json;
use std::time::{Duration, Instant};

/// Long enough for any machine; nothing is judged by it.
const PATIENCE: Duration = Duration::from_secs(20);
const ARM: Order = Order::Robot(Command::Arm);

/// The one of a lab with one robot.
fn client(lab: &Lab) -> Client {
    let mut clients = lab.clients().unwrap();
    assert_eq!((clients.len(), clients[0].0.as_str()), (1, ""));
    clients.remove(0).1
}

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
    let mut client = client(&lab);
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
    let mut client = client(&lab);
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
    let mut client = client(&lab);
    assert!(client.news().is_some());
    // It waits for the session's thread.
    tokio::task::spawn_blocking(|| drop(lab)).await.unwrap();
    assert!(client.news().is_none());
    assert!(client.order(ARM).is_err());
}

/// The lab of two robots.
fn two_robots() -> Lab {
    let config = LabConfig {
        at: ServeAt::here(0),
        ..LabConfig::default()
    };
    let robot = |name: &str| (name.to_owned(), Box::<Toy>::default() as _);
    let others = vec![robot("second")];
    serve_fleet(config, robot("first"), others, Extras::default()).unwrap()
}

#[tokio::test]
async fn each_of_several_robots_has_a_client_and_stop_for_one_stops_all() {
    let lab = two_robots();
    let (names, mut clients): (Vec<_>, Vec<_>) = lab.clients().unwrap().into_iter().unzip();
    assert_eq!(names, ["first", "second"]);
    for client in &mut clients {
        wait_for_state(client, |state| state.link.connected).await;
    }
    clients[1].order(ARM).unwrap();
    wait_for_state(&mut clients[1], |state| state.robot.armed).await;
    assert_eq!(clients[0].view().seat, Seat::Free);
    clients[0].order(ARM).unwrap();
    wait_for_state(&mut clients[0], |state| state.robot.armed).await;
    clients[0].order(Order::Robot(Command::Stop)).unwrap();
    for client in &mut clients {
        wait_for_state(client, |state| !state.robot.armed).await;
    }
}

#[tokio::test]
async fn two_people_have_control_of_a_robot_each_and_stop_of_either_stops_both() {
    let lab = two_robots();
    let key = open(&lab);
    let mut pages = Vec::new();
    for robot in ["first", "second"] {
        let mut page = connect_to(robot, &lab, &key).await;
        wait_for(&mut page, |message| event(message, "connected")).await;
        pages.push(page);
    }
    for stops in 0..2 {
        for page in &mut pages {
            say(page, json!({"type": "arm"})).await;
            wait_for(page, |message| armed(message, true)).await;
        }
        // A third one has control of neither.
        let mut guest = connect_to("second", &lab, &key).await;
        say(&mut guest, json!({"type": "disarm"})).await;
        wait_for(&mut guest, |message| {
            event(message, "another page has control")
        })
        .await;
        say(&mut pages[stops], json!({"type": "stop"})).await;
        for page in &mut pages {
            wait_for(page, |message| armed(message, false)).await;
        }
    }
}
