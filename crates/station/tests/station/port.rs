//! A robot behind a serial port that is unplugged and plugged in again.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use rumbo_session::client::{KnownTable, LinkEvent, NotTaken, RobotClient};
use rumbo_session::{LinkNews, Target};
use rumbo_station::port::{DEFAULT_BAUD, Port, Pty};
use rumbo_wire::Command;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use support::Toy;

/// Long enough for any machine; no result depends on it.
const PATIENCE: Duration = Duration::from_secs(20);

/// A toy robot behind a pseudo terminal, plugged in under a name.
struct Plugged {
    out: Arc<AtomicBool>,
    thread: JoinHandle<Vec<Command>>,
}

impl Plugged {
    fn new(name: &Path) -> Self {
        let mut pty = Pty::new(Duration::from_millis(5)).unwrap();
        let _ = std::fs::remove_file(name);
        std::os::unix::fs::symlink(pty.path(), name).unwrap();
        let out = Arc::new(AtomicBool::new(false));
        let pulled = Arc::clone(&out);
        let thread = std::thread::spawn(move || {
            let (mut toy, began, mut bytes) = (Toy::default(), Instant::now(), Vec::new());
            while !pulled.load(Ordering::SeqCst) {
                bytes.clear();
                pty.read(&mut bytes);
                toy.send(&bytes).unwrap();
                let due_us = began.elapsed().as_micros() as u64;
                toy.advance(due_us.saturating_sub(toy.now_us())).unwrap();
                bytes.clear();
                toy.receive(&mut bytes);
                pty.write(&bytes);
            }
            toy.applied
        });
        Self { out, thread }
    }

    /// Unplugs it; returns the commands it has applied.
    fn pull(self, name: &Path) -> Vec<Command> {
        std::fs::remove_file(name).unwrap();
        self.out.store(true, Ordering::SeqCst);
        self.thread.join().unwrap()
    }
}

/// The station's side.
struct Station {
    port: Port,
    client: RobotClient,
    events: Vec<LinkEvent>,
    news: Vec<LinkNews>,
}

impl Station {
    fn run_until(&mut self, wanted: impl Fn(&Self) -> bool) {
        let until = Instant::now() + PATIENCE;
        let mut bytes = Vec::new();
        while !wanted(self) {
            assert!(
                Instant::now() < until,
                "timed out, last event {:?}",
                self.events.last()
            );
            bytes.clear();
            self.port.receive(&mut bytes);
            let now_us = self.port.now_us();
            self.client.receive(&bytes, now_us, &mut self.events);
            bytes.clear();
            self.client.poll(now_us, &mut bytes, &mut self.events);
            self.port.send(&bytes).unwrap();
            self.news.extend(self.port.news());
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn count(&self, wanted: impl Fn(&LinkEvent) -> bool) -> usize {
        self.events.iter().filter(|event| wanted(event)).count()
    }
}

#[test]
fn a_port_that_is_unplugged_and_plugged_in_again_is_reopened_and_arms_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("port");
    let robot = Plugged::new(&name);
    let mut station = Station {
        port: Port::open(name.to_str().unwrap(), DEFAULT_BAUD).unwrap(),
        client: RobotClient::new(7, false, KnownTable::OURS),
        events: Vec::new(),
        news: Vec::new(),
    };
    station
        .run_until(|station| station.count(|event| matches!(event, LinkEvent::Telemetry(..))) > 3);
    let now_us = station.port.now_us();
    station.client.submit(Command::Arm, now_us).unwrap();
    station.run_until(|station| {
        station
            .count(|event| matches!(event, LinkEvent::Telemetry(_, telemetry) if telemetry.armed))
            > 0
    });
    assert!(robot.pull(&name).contains(&Command::Arm));
    station.run_until(|station| !station.client.connected());
    station.run_until(|station| matches!(station.news[..], [LinkNews::Lost(_)]));
    // A command for a robot that is not connected.
    let now_us = station.port.now_us();
    let refused = station.client.submit(Command::Arm, now_us);
    assert_eq!(refused, Err(NotTaken::NotConnected));

    let robot = Plugged::new(&name);
    let before = station.count(|event| matches!(event, LinkEvent::Telemetry(..)));
    station.run_until(|station| {
        station.client.connected()
            && station.count(|event| matches!(event, LinkEvent::Telemetry(..))) > before + 3
    });
    station.run_until(|station| matches!(station.news[..], [LinkNews::Lost(_), LinkNews::Back(_)]));
    let applied = robot.pull(&name);
    assert!(!applied.contains(&Command::Arm), "{applied:?}");
}

#[test]
fn a_port_that_cannot_be_opened_says_what_there_is_and_what_to_do() {
    let error = Port::open("/dev/no_such_port", DEFAULT_BAUD)
        .unwrap_err()
        .to_string();
    assert!(
        error.starts_with("port /dev/no_such_port cannot be opened") && !error.contains('\n'),
        "{error}"
    );
    let folder = tempfile::tempdir().unwrap();
    let name = folder.path().join("port");
    let robot = Plugged::new(&name);
    let _held = Port::open(name.to_str().unwrap(), DEFAULT_BAUD).unwrap();
    let error = Port::open(name.to_str().unwrap(), DEFAULT_BAUD)
        .unwrap_err()
        .to_string();
    assert!(error.contains("another program has it open"), "{error}");
    robot.pull(&name);
    let error = Port::open("tcp:127.0.0.1:1", DEFAULT_BAUD)
        .unwrap_err()
        .to_string();
    assert!(error.contains("tcp:host:port"), "{error}");
}

#[test]
fn a_robot_behind_tcp_is_used_like_one_behind_a_wire() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let mut port = Port::open(&address, DEFAULT_BAUD).unwrap();
    let (mut robot, _) = listener.accept().unwrap();
    port.send(b"to it").unwrap();
    let mut bytes = [0; 5];
    std::io::Read::read_exact(&mut robot, &mut bytes).unwrap();
    assert_eq!(&bytes, b"to it");
    std::io::Write::write_all(&mut robot, b"from it").unwrap();
    let (mut received, until) = (Vec::new(), Instant::now() + PATIENCE);
    while received.len() < 7 && Instant::now() < until {
        port.receive(&mut received);
    }
    assert_eq!(received, b"from it");
}

#[test]
fn a_port_that_closes_as_soon_as_it_is_open_is_reported_once_and_tried_ever_more_rarely() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    let began = Instant::now();
    let mut port = Port::open(&address, DEFAULT_BAUD).unwrap();
    (0..4).for_each(|_| drop(listener.accept().unwrap()));
    // Half a second, a second, two seconds.
    assert!(began.elapsed() > Duration::from_secs(3));
    let Some(LinkNews::Lost(said)) = port.news() else {
        panic!("nothing said");
    };
    assert!(
        said.contains("closes as soon as it is open") && said.contains("no other program"),
        "{said}"
    );
    assert_eq!(port.news(), None);
    // One that stays open is back.
    let _robot = listener.accept().unwrap();
    let until = Instant::now() + PATIENCE;
    let back = std::iter::repeat_with(|| port.news())
        .take_while(|_| Instant::now() < until)
        .flatten()
        .next();
    assert!(matches!(back, Some(LinkNews::Back(_))), "{back:?}");
}

#[test]
fn a_port_that_is_flooded_is_left_all_the_same() {
    use std::io::Write;
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("tcp:{}", listener.local_addr().unwrap());
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        while stream.write_all(&[0x55; 65_536]).is_ok() {}
    });
    let mut port = Port::open(&address, DEFAULT_BAUD).unwrap();
    let until = Instant::now() + PATIENCE;
    let mut received = Vec::new();
    // As much as it holds at once, so that its reader has to wait.
    while received.len() < 16 << 20 && Instant::now() < until {
        port.receive(&mut received);
    }
    std::thread::sleep(Duration::from_millis(200));
    let (left, has_left) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        drop(port);
        left.send(()).unwrap();
    });
    assert_eq!(has_left.recv_timeout(PATIENCE), Ok(()));
}
