//! Those beside the first page: programs of the user, and people with a robot each.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::page;
use crate::support::Toy;
use page::*;
use rumbo_station::{Extras, Lab, LabConfig, ServeAt, serve_all};
use serde_json::{Value, json};

#[tokio::test]
async fn a_program_with_the_key_arms_before_any_page_is_open_and_a_page_stops() {
    let lab = start(4.0);
    let mut program = connect_own(&lab, lab.key()).await;
    wait_for(&mut program, |message| event(message, "connected")).await;
    say(&mut program, json!({"type": "arm"})).await;
    wait_for(&mut program, |message| armed(message, true)).await;
    // The address is still there for the page.
    let key = open(&lab);
    let mut page = connect_own(&lab, &key).await;
    wait_for(&mut page, |message| armed(message, true)).await;
    say(&mut page, json!({"type": "stop"})).await;
    wait_for(&mut program, |message| armed(message, false)).await;
}

#[tokio::test]
async fn a_state_says_how_many_orders_of_its_page_were_taken_before_it() {
    let lab = start(4.0);
    let mut driver = connect_own(&lab, lab.key()).await;
    wait_for(&mut driver, |message| event(message, "connected")).await;
    let mut other = connect_own(&lab, lab.key()).await;
    let seen = |message: &Value, orders: u64, is_armed: bool| {
        armed(message, is_armed)?;
        (message["orders"] == orders).then_some(())
    };
    wait_for(&mut other, |message| seen(message, 0, false)).await;
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| seen(message, 1, true)).await;
    // Of another page none; what is refused counts, since nothing will come of it.
    wait_for(&mut other, |message| seen(message, 0, true)).await;
    say(&mut other, json!({"type": "disarm"})).await;
    wait_for(&mut other, |message| seen(message, 1, true)).await;
    say(&mut driver, json!({"type": "disarm"})).await;
    wait_for(&mut driver, |message| seen(message, 2, false)).await;
}

/// The lab of two robots.
fn two_robots() -> Lab {
    let config = LabConfig {
        at: ServeAt::here(0),
        ..LabConfig::default()
    };
    let robot = |name: &str| (name.to_owned(), Box::<Toy>::default() as _);
    let robots = vec![robot("first"), robot("second")];
    serve_all(config, robots, Extras::default()).unwrap()
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
