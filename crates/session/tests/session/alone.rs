//! A session without threads, clocks and sockets: time and bytes in, events and bytes out.
#![allow(clippy::unwrap_used, clippy::panic)]

use crate::support;
use proptest::prelude::*;
use rumbo_control::Velocity;
use rumbo_control::mode::ModeId;
use rumbo_log::{
    CalibrationPhase, Choice, Entry, Findings, Log, LogWriter, Manifest, ReadingSource, Row,
};
use rumbo_session::{
    About, Ask, Board, CalibrationError, Cursor, Event, Going, Guest, LinkNews, Now, Order,
    SLICE_US, Session, Target, TargetView,
};
use rumbo_wire::Command;
use std::io::Cursor as Bytes;
use support::Toy;

const ON: Order = Order::Robot(Command::Arm);
const STOP: Order = Order::Robot(Command::Stop);

struct Bench {
    toy: Toy,
    session: Session,
    wall_us: u64,
    /// Nothing gets through to the robot, from it.
    cut: [bool; 2],
    sent: Vec<u8>,
    events: Vec<Event>,
}

impl Bench {
    fn new() -> Self {
        let toy = Toy::default();
        Self {
            session: Session::new(About::of(&toy), 7, false),
            toy,
            wall_us: 0,
            cut: [false; 2],
            sent: Vec::new(),
            events: Vec::new(),
        }
    }

    fn now(&self) -> Now {
        Now {
            target_us: self.toy.now_us(),
            wall_us: self.wall_us,
        }
    }

    fn send(&mut self) {
        let bytes = self.session.take_bytes();
        if !self.cut[0] {
            self.toy.send(&bytes).unwrap();
        }
        self.sent.extend(bytes);
    }

    fn order(&mut self, order: Order) -> Option<Ask> {
        let ask = self.session.order(order, self.now());
        self.send();
        ask
    }

    fn pass(&mut self, ms: u64) {
        for _ in 0..ms * 1_000 / SLICE_US {
            self.toy.advance(SLICE_US).unwrap();
            self.wall_us += SLICE_US;
            let now = self.now();
            let sight = TargetView {
                truth: self.toy.truth(),
                ..TargetView::default()
            };
            self.session.expire_hold(now);
            self.session.observe(sight, now);
            let mut bytes = Vec::new();
            self.toy.receive(&mut bytes);
            if self.cut[1] {
                bytes.clear();
            }
            self.session.receive(&bytes, now);
            self.session.advance(now);
            self.send();
            self.session.update(Going::default(), now);
            self.events.extend(self.session.take_events());
        }
    }

    /// Number and reason of the failed calibration that the page shows.
    fn failed_calibration(&self) -> (u32, String) {
        let mut board = Board::default();
        for event in &self.events {
            board.take(event, 0.0);
        }
        let state = board.news(&mut Cursor::default()).state.unwrap();
        let calibration = state.calibration.clone().unwrap();
        let CalibrationPhase::Failed { why } = calibration.phase else {
            panic!("{calibration:?}");
        };
        (calibration.number, why)
    }

    fn armed(&self) -> usize {
        let applied = self.toy.applied.iter();
        applied.filter(|each| **each == Command::Arm).count()
    }
}

#[test]
fn page_and_log_take_from_the_same_events_what_each_needs() {
    let mut bench = Bench::new();
    bench.pass(2_000);
    assert!(bench.order(ON).is_none());
    bench.pass(2_000);
    assert_eq!(bench.armed(), 1);

    let (mut board, mut cursor) = (Board::default(), Cursor::default());
    let mut log = LogWriter::new(Bytes::new(Vec::new()), &Manifest::default()).unwrap();
    for event in &bench.events {
        board.take(event, 0.0);
        if let Event::Entry(entry) = event {
            log.record(entry).unwrap();
        }
    }
    let log = Log::read(Bytes::new(log.finish().unwrap().into_inner())).unwrap();
    let news = board.news(&mut cursor);
    let kinds = news.messages().map(|message| {
        let message: serde_json::Value = serde_json::from_str(&message.json().unwrap()).unwrap();
        message["type"].as_str().unwrap().to_owned()
    });
    let kinds: Vec<_> = kinds.collect();
    for kind in ["scene", "state", "parameters", "events", "bytes", "samples"] {
        assert!(kinds.iter().any(|each| each == kind), "{kind}: {kinds:?}");
    }
    assert_eq!(news.samples.len(), log.rows.len());
    let last = |rows: &[Row]| rows.last().map(Row::cells);
    assert_eq!(last(&news.samples), last(&log.rows));
    assert!(news.samples.len() > 80 && news.state.unwrap().robot.armed);
    // The page has the newest bytes, the log all.
    assert!(log.link.ends_with(&news.bytes));
    assert_eq!(log.events, news.events);
}

#[test]
fn stop_leaves_with_the_call_that_orders_it_whatever_waits() {
    let mut bench = Bench::new();
    bench.pass(2_000);
    bench.cut = [true; 2];
    (0..20).for_each(|_| drop(bench.order(ON)));
    bench.sent.clear();
    bench.order(STOP);
    let is_stop = |event: &Event| matches!(event, Event::Entry(entry) if matches!(&**entry, Entry::Burst(burst) if burst.to_robot));
    assert!(!bench.sent.is_empty());
    assert!(bench.session.take_events().iter().any(is_stop));
    bench.pass(500);
    bench.cut = [false; 2];
    bench.pass(3_000);
    assert_eq!(bench.armed(), 0);
    assert!(bench.toy.applied.contains(&Command::Stop));
}

#[test]
fn what_a_target_cannot_do_is_refused_and_what_it_can_is_asked_of_it() {
    let mut bench = Bench::new();
    assert_eq!(bench.order(Order::Speed(2.0)), Some(Ask::Pace(2.0)));
    let mut real = Session::new(About::default(), 7, false);
    assert_eq!(real.order(Order::Speed(2.0), Now::default()), None);
    let refused = real
        .take_events()
        .into_iter()
        .filter_map(|event| match event {
            Event::Entry(entry) => match &*entry {
                Entry::Event(event) => Some(event.text.clone()),
                _ => None,
            },
            _ => None,
        });
    let refused: Vec<_> = refused.collect();
    assert!(refused[0].contains("refused"), "{refused:?}");
}

#[derive(Clone, Debug)]
enum Action {
    Pass(u64),
    Cut([bool; 2]),
    On,
    Lost,
    Back,
    Restart,
}

fn action() -> impl Strategy<Value = Action> {
    let cuts = vec![[true, false], [false, false], [true, true]];
    prop_oneof![
        5 => (0u64..4_000).prop_map(Action::Pass),
        4 => prop::sample::select(cuts).prop_map(Action::Cut),
        2 => Just(Action::On),
        1 => Just(Action::Lost),
        1 => Just(Action::Back),
        1 => Just(Action::Restart),
    ]
}

fn obey(bench: &mut Bench, action: &Action) {
    let now = bench.now();
    match action {
        Action::Pass(ms) => bench.pass(*ms),
        Action::Cut(cut) => bench.cut = *cut,
        Action::On => drop(bench.order(ON)),
        Action::Lost => bench.session.news(LinkNews::Lost("gone".into()), now),
        Action::Back => bench.session.news(LinkNews::Back("back".into()), now),
        Action::Restart => bench.toy.restart(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    /// The toy takes what arrives, however old: this is the session's part alone.
    #[test]
    fn no_on_is_sent_later_than_two_seconds_after_it_was_ordered_nor_after_a_loss(
        script in prop::collection::vec(action(), 1..30),
    ) {
        let mut bench = Bench::new();
        bench.pass(1_000);
        let (mut ordered_us, mut armed) = (None, 0);
        for action in &script {
            let steps = match action {
                Action::Pass(ms) => vec![Action::Pass(10); (*ms / 10) as usize],
                // What was on its way arrives.
                Action::Lost => [vec![Action::Lost], vec![Action::Pass(10); 10]].concat(),
                other => vec![other.clone()],
            };
            if matches!(action, Action::On) {
                ordered_us = Some(bench.toy.now_us());
            }
            for step in &steps {
                obey(&mut bench, step);
                if bench.armed() > armed {
                    armed = bench.armed();
                    let age_us = ordered_us.map(|at_us| bench.toy.now_us() - at_us);
                    // The link's queue and the frame's own way are at most 0.1 s.
                    prop_assert!(age_us.is_some_and(|age_us| age_us <= 2_100_000), "{:?}", age_us);
                }
            }
            if matches!(action, Action::Lost) {
                ordered_us = None;
            }
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20))]

    #[test]
    fn the_same_times_and_bytes_give_the_same_events_and_bytes(
        script in prop::collection::vec(action(), 1..15),
    ) {
        let run = || {
            let mut bench = Bench::new();
            script.iter().for_each(|action| obey(&mut bench, action));
            (bench.sent, format!("{:?}", bench.events))
        };
        prop_assert!(run() == run());
    }
}

#[test]
fn a_program_that_sends_nothing_is_seen_by_instruments_and_what_it_prints_and_touches() {
    let mut bench = Bench::new();
    let mut events = Vec::new();
    for slice in 0..800_u64 {
        let now = Now {
            target_us: slice * SLICE_US,
            wall_us: slice * SLICE_US,
        };
        // Touching for a moment, again and again, as a body does that pushes.
        let contact = (1_000_000..2_000_000).contains(&now.target_us) && slice % 3 == 0;
        let truth = rumbo_log::Truth {
            contact,
            ..bench.toy.truth().unwrap()
        };
        let sight = TargetView {
            truth: Some(truth),
            shown: vec![(
                ReadingSource::Truth,
                vec![("true_x_m".into(), now.target_us as f64)],
            )],
            consoles: vec![(0, b"cm:3.5\n".to_vec())],
            ..TargetView::default()
        };
        bench.session.observe(sight, now);
        bench.session.update(Going::default(), now);
        events.extend(bench.session.take_events());
    }
    let entries = events.iter().filter_map(|event| match event {
        Event::Entry(entry) => Some(entry.as_ref()),
        _ => None,
    });
    let (mut truth, mut printed, mut collisions) = (0, 0, 0);
    for entry in entries {
        match entry {
            Entry::Readings(readings) => {
                for reading in readings {
                    truth += usize::from(reading.signal("true_x_m").is_some());
                    printed += usize::from(reading.signal("cm") == Some(3.5));
                }
            }
            Entry::Event(event) => collisions += usize::from(event.text.starts_with("collision")),
            _ => {}
        }
    }
    assert_eq!((truth, printed, collisions), (800, 400, 1));
    // A page that comes now gets the readings of both.
    let mut board = Board::default();
    for event in &events {
        board.take(event, 0.0);
    }
    let news = board.news(&mut Cursor::default());
    let messages: Vec<_> = news
        .messages()
        .filter_map(|message| message.json())
        .collect();
    let readings = messages
        .iter()
        .filter(|text| text.contains(r#""type":"readings""#));
    let (names, port) = (
        r#""source":"truth","names":["true_x_m"]"#,
        r#""source":{"usart":0},"names":["cm"]"#,
    );
    let readings: String = readings.map(String::as_str).collect();
    assert!(
        readings.contains(names) && readings.contains(port),
        "{readings}"
    );
}

/// Sends back each byte that arrives, until there were three of them.
#[derive(Debug, Default)]
struct Echo(usize);

impl Guest for Echo {
    fn advance(
        &mut self,
        _now_us: u64,
        received: &[u8],
        to_robot: &mut Vec<u8>,
    ) -> Option<Result<Findings, CalibrationError>> {
        to_robot.extend_from_slice(received);
        self.0 += received.len();
        (self.0 >= 3).then(|| Ok(Findings::default()))
    }
}

/// A session with a guest, without a robot: what it has sent is the guest's.
fn with_guest() -> Session {
    let mut session = Session::new(About::of(&Toy::default()), 7, false);
    session.calibration_begun(Ok(Box::new(Echo::default())), Now::default());
    session
}

#[test]
fn a_guest_gets_the_bytes_received_and_its_own_are_sent_until_it_ends() {
    let mut session = with_guest();
    let mut sent = Vec::new();
    for byte in 1..=5 {
        session.receive(&[byte], Now::default());
        sent.extend(session.take_bytes());
    }
    assert_eq!(sent, [1, 2, 3]);
}

#[test]
fn a_calibration_that_is_refused_is_shown_with_the_reason() {
    let mut bench = Bench::new();
    bench.pass(2_000);
    bench.order(ON);
    bench.pass(2_000);
    assert!(bench.order(Order::Calibrate).is_none());
    bench.pass(1_000);
    let (number, why) = bench.failed_calibration();
    assert_eq!(why, "it was refused: the robot is armed: switch OFF first");
    assert_eq!(number, 1);
}

#[test]
fn a_calibration_that_is_refused_after_a_reset_is_another_one() {
    let mut bench = Bench::new();
    bench.order(Order::Calibrate);
    bench.pass(400);
    let (before, _) = bench.failed_calibration();
    let choice = Choice::default();
    let again = Ok(About::of(&bench.toy));
    bench.session.restart(&choice, again, 8, bench.now());
    bench.order(Order::Calibrate);
    bench.pass(400);
    let (number, why) = bench.failed_calibration();
    assert_eq!(why, "it was refused: no robot answers");
    assert_eq!((before, number), (1, 2));
}

#[test]
fn stop_takes_the_link_back_from_a_guest_and_another_order_does_not() {
    let mut session = with_guest();
    session.order(ON, Now::default());
    session.receive(&[1], Now::default());
    assert_eq!(session.take_bytes(), [1], "refused, and the guest goes on");
    session.order(STOP, Now::default());
    session.take_bytes();
    session.receive(&[2], Now::default());
    assert!(session.take_bytes().is_empty());
}

fn velocity(forward_m_s: f32) -> Order {
    Order::Velocity(Velocity {
        forward_m_s,
        yaw_rad_s: 0.0,
    })
}

/// What was refused, in words.
fn refusals(bench: &Bench) -> Vec<String> {
    let said = bench.events.iter().filter_map(|event| match event {
        Event::Entry(entry) => match &**entry {
            Entry::Event(event) if event.text.contains("refused") => Some(event.text.clone()),
            _ => None,
        },
        _ => None,
    });
    said.collect()
}

#[test]
fn of_many_velocities_the_newest_leaves_25_times_a_second_and_stop_drops_what_waits() {
    let mut bench = Bench::new();
    bench.pass(2_000);
    bench.order(Order::Robot(Command::Mode(ModeId::Twist)));
    bench.pass(300);
    for step in 1..=200_u8 {
        bench.order(velocity(f32::from(step) / 1_000.0));
        bench.pass(5);
    }
    let sent = std::mem::take(&mut bench.toy.velocities);
    assert!((24..=26).contains(&sent.len()), "{}", sent.len());
    assert!(sent.is_sorted_by(|a, b| a.forward_m_s < b.forward_m_s));
    bench.order(velocity(0.3));
    bench.order(STOP);
    bench.pass(500);
    let newer = |velocity: &Velocity| velocity.forward_m_s > 0.25;
    assert!(!bench.toy.velocities.iter().any(newer));
}

#[test]
fn a_velocity_is_refused_without_a_robot_in_another_mode_and_when_absurd_and_that_is_said_once_in_two_seconds()
 {
    let mut bench = Bench::new();
    bench.order(velocity(0.1));
    bench.pass(2_000);
    for _ in 0..100 {
        bench.order(velocity(0.1));
        bench.pass(20);
    }
    bench.order(Order::Robot(Command::Mode(ModeId::Twist)));
    bench.pass(2_300);
    bench.order(velocity(1.5));
    bench.pass(20);
    assert_eq!(bench.toy.velocities, []);
    let said = refusals(&bench);
    let of = |what: &str| said.iter().filter(|text| text.contains(what)).count();
    assert_eq!(of("no robot answers"), 1, "{said:?}");
    assert_eq!(of("select mode 10"), 1, "{said:?}");
    assert_eq!(of("out of range"), 1, "{said:?}");
}
