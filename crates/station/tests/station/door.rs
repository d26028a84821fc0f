//! Connections that ask for nothing: they end, and keep nobody out.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::page;
use futures_util::StreamExt;
use page::*;
use rumbo_station::Lab;
use serde_json::json;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::Instant;

/// More than the station keeps.
const CROWD: usize = 430;

/// Connections, each of which has said so much.
fn connections(lab: &Lab, count: usize, said: &str) -> Vec<TcpStream> {
    let connect = |_| {
        let mut stream = TcpStream::connect(host(lab)).unwrap();
        // It may have been turned away already.
        let _ = stream.write_all(said.as_bytes());
        stream
    };
    (0..count).map(connect).collect()
}

/// The station ends each of them.
fn all_end(streams: Vec<TcpStream>) {
    let until = Instant::now() + PATIENCE;
    for (number, mut stream) in streams.into_iter().enumerate() {
        let left = until.saturating_duration_since(Instant::now());
        stream
            .set_read_timeout(Some(left.max(PATIENCE / 100)))
            .unwrap();
        match stream.read_to_end(&mut Vec::new()) {
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::ConnectionReset => {}
            Err(error) => panic!("connection {number} stays: {error}"),
        }
    }
}

#[tokio::test]
async fn a_crowd_that_asks_for_nothing_keeps_nobody_out_and_goes() {
    let lab = start(4.0);
    let key = open(&lab);
    let mut driver = connect_own(&lab, &key).await;
    wait_for(&mut driver, |message| event(message, "connected")).await;
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| armed(message, true)).await;

    let crowd = connections(&lab, CROWD, "");
    // The page that has control stops the robot, and another one finds a place.
    say(&mut driver, json!({"type": "stop"})).await;
    wait_for(&mut driver, |message| armed(message, false)).await;
    let mut late = connect_own(&lab, &key).await;
    wait_for(&mut late, |message| event(message, "connected")).await;
    let gone = tokio::task::spawn_blocking(|| all_end(crowd));
    while !gone.is_finished() {
        // Who does not read is let go, too.
        driver.next().await.unwrap().unwrap();
    }
    gone.await.unwrap();
    say(&mut driver, json!({"type": "arm"})).await;
    wait_for(&mut driver, |message| armed(message, true)).await;
}

#[test]
fn a_request_that_comes_to_no_end_is_given_up() {
    let lab = start(0.0);
    all_end(connections(&lab, 3, "GET / HTTP/1.1\r\nHost: "));
    // Neither the next one on a connection that was of use.
    let served = format!("GET /icon.svg HTTP/1.1\r\nHost: {}\r\n\r\n", host(&lab));
    all_end(connections(&lab, 3, &served));
}
