//! A robot whose cable is pulled out in the middle of a session, as the page meets it.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::{page, support};
use page::*;
use rumbo_session::{LinkNews, Target, TargetError};
use rumbo_station::{Lab, LabConfig, ServeAt, serve};
use rumbo_wire::Command;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use support::Toy;

/// A toy behind a cable.
struct Cable {
    toy: Toy,
    /// It is pulled out; and the session knows that.
    out: Arc<AtomicBool>,
    known: bool,
    /// The link carries nothing, and nobody says so.
    deaf: Arc<AtomicBool>,
    applied: Arc<Mutex<Vec<Command>>>,
}

impl Cable {
    fn carries(&self) -> bool {
        !self.out.load(Ordering::SeqCst) && !self.deaf.load(Ordering::SeqCst)
    }
}

impl Target for Cable {
    fn now_us(&self) -> u64 {
        self.toy.now_us()
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        self.toy.advance(dt_us)?;
        self.applied.lock().unwrap().append(&mut self.toy.applied);
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        if self.carries() {
            self.toy.send(bytes)?;
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        let mut arrived = Vec::new();
        self.toy.receive(&mut arrived);
        if self.carries() {
            into.append(&mut arrived);
        }
    }

    fn baud(&self) -> u32 {
        9_600
    }

    fn news(&mut self) -> Option<LinkNews> {
        let out = self.out.load(Ordering::SeqCst);
        let changed = out != std::mem::replace(&mut self.known, out);
        changed.then(|| match out {
            true => LinkNews::Lost("port toy is gone (pulled out); waiting for it".into()),
            false => LinkNews::Back("port toy is back".into()),
        })
    }
}

struct Bench {
    lab: Lab,
    out: Arc<AtomicBool>,
    deaf: Arc<AtomicBool>,
    applied: Arc<Mutex<Vec<Command>>>,
}

impl Bench {
    fn new() -> Self {
        let (out, deaf) = <(Arc<AtomicBool>, Arc<AtomicBool>)>::default();
        let applied = Arc::<Mutex<Vec<Command>>>::default();
        let cable = Cable {
            toy: Toy::default(),
            out: Arc::clone(&out),
            known: false,
            deaf: Arc::clone(&deaf),
            applied: Arc::clone(&applied),
        };
        let config = LabConfig {
            at: ServeAt::here(0),
            ..LabConfig::default()
        };
        Self {
            lab: serve(config, Box::new(cable)).unwrap(),
            out,
            deaf,
            applied,
        }
    }

    fn has(&self, command: Command) -> bool {
        self.applied.lock().unwrap().contains(&command)
    }
}

fn refused(message: &Value) -> Option<String> {
    let refused = &message["state"]["refused"];
    refused.as_str().map(str::to_owned)
}

#[tokio::test]
async fn on_while_the_port_is_gone_is_refused_beside_the_button_and_not_obeyed_when_it_is_back() {
    let bench = Bench::new();
    let cookie = open(&bench.lab);
    let mut page = connect_own(&bench.lab, &cookie).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    bench.out.store(true, Ordering::SeqCst);
    wait_for(&mut page, |message| event(message, "port toy is gone")).await;
    say(&mut page, json!({"type": "reference", "value": 0.5})).await;
    say(&mut page, json!({"type": "arm"})).await;
    let why = wait_for(&mut page, |message| {
        refused(message).filter(|text| text.starts_with("ON"))
    })
    .await;
    assert!(why.starts_with("ON: refused, the port is gone"), "{why}");
    bench.out.store(false, Ordering::SeqCst);
    wait_for(&mut page, |message| event(message, "connected")).await;
    // What the robot gets after anything old is an order of now.
    say(&mut page, json!({"type": "clear_fault"})).await;
    wait_for(&mut page, |message| {
        event(message, "clear the fault: acknowledged")
    })
    .await;
    assert!(!bench.has(Command::Arm) && !bench.has(Command::Reference(0.5)));
    wait_for(&mut page, |message| {
        let state = message["state"].as_object()?;
        (!state.contains_key("refused")).then_some(())
    })
    .await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for(&mut page, |message| armed(message, true)).await;
}

#[tokio::test]
async fn a_stop_that_nobody_acknowledges_is_an_alarm_until_somebody_does() {
    let bench = Bench::new();
    let cookie = open(&bench.lab);
    let mut page = connect_own(&bench.lab, &cookie).await;
    wait_for(&mut page, |message| event(message, "connected")).await;
    say(&mut page, json!({"type": "arm"})).await;
    wait_for(&mut page, |message| armed(message, true)).await;
    bench.deaf.store(true, Ordering::SeqCst);
    // On the way or not, it is dropped, and said to be.
    say(&mut page, json!({"type": "reference", "value": 0.5})).await;
    wait_for(&mut page, |message| {
        event(message, "setpoint 50.0 cm: given up, the link was lost")
    })
    .await;
    say(&mut page, json!({"type": "stop"})).await;
    let alarm = |message: &Value| Some(message["state"]["alarms"].as_array()?.first()?.to_string());
    let alarm = wait_for(&mut page, alarm).await;
    assert!(
        alarm.contains("STOP") && alarm.contains("battery"),
        "{alarm}"
    );
    bench.deaf.store(false, Ordering::SeqCst);
    wait_for(&mut page, |message| event(message, "STOP: acknowledged")).await;
    wait_for(&mut page, |message| {
        let state = message["state"].as_object()?;
        (!state.contains_key("alarms")).then_some(())
    })
    .await;
    assert!(bench.has(Command::Stop) && !bench.has(Command::Reference(0.5)));
}
