//! The board: what is known of the robot, for pages that read on from their cursors.
//!
//! Everything on it is bounded. Samples and events sit in rings with running numbers, so that a slow, returning or new
//! page gets the recent past; the rest is one current value each, with a version. Rows become JSON only when a page
//! takes them.

mod ring;

use crate::console::{ConsoleText, PARTS_CONSOLE, readable};
use crate::event::Event;
use crate::program::ShownSketch;
use crate::world::EditedWorld;
use ring::{Ring, Versioned};
use rumbo_log::{
    Burst, Entry, LoggedEvent, ParameterState, Reading, ReadingSource, Row, Scene, State,
};
use serde_json::Value;
use std::collections::BTreeMap;

/// Samples kept: ten minutes of telemetry at 25 Hz.
pub const SAMPLES_KEPT: usize = 15_000;
/// Readings kept: ten minutes of what is shown at 33 Hz, and as much of what programs print.
const READINGS_KEPT: usize = 20_000;
/// Events kept.
pub const EVENTS_KEPT: usize = 1_000;
/// Pieces of console text kept: one for each time slice in which a USART sent.
const CONSOLES_KEPT: usize = 2_000;
/// Pieces of the link's raw bytes kept: some seconds of both directions.
const BURSTS_KEPT: usize = 600;
/// Messages of the debugger kept: a page asks for the next ones when it has these.
const MESSAGES_KEPT: usize = 100;

/// Arrival of the newest samples: time of day \[ms since 1970\] and the target's time \[ms\]. Gives the age of what a
/// page shows.
pub type Arrival = (f64, i64);

/// What is to be shown.
#[derive(Debug)]
pub struct Board {
    run: u32,
    received: Arrival,
    samples: Ring<Row>,
    /// What is shown of the robot, and apart from it what may be a flood: numbers that a program prints.
    shown: Ring<Reading>,
    printed: Ring<Reading>,
    events: Ring<LoggedEvent>,
    consoles: Ring<ConsoleText>,
    /// What each display shows.
    displays: Versioned<BTreeMap<String, String>>,
    bytes: Ring<Burst>,
    scene: Versioned<Option<Scene>>,
    parameters: Versioned<Vec<ParameterState>>,
    state: Versioned<State>,
    world: Versioned<EditedWorld>,
    sketch: Versioned<ShownSketch>,
    debug: Ring<Value>,
}

/// How far a page has read.
#[derive(Clone, Debug, Default)]
pub struct Cursor {
    run: u32,
    samples: u64,
    shown: u64,
    printed: u64,
    events: u64,
    consoles: u64,
    displays: u64,
    bytes: u64,
    scene: u64,
    parameters: u64,
    state: u64,
    world: u64,
    sketch: u64,
    debug: u64,
}

/// What is new to a page.
#[derive(Debug, Default)]
pub struct News {
    /// Number of the run, which changes with a reset: the page discards earlier runs.
    pub run: u32,
    /// What surrounds the robot.
    pub scene: Option<Option<Scene>>,
    /// The parameters.
    pub parameters: Option<Vec<ParameterState>>,
    /// What changes slowly.
    pub state: Option<State>,
    /// A world that a page edits.
    pub world: Option<EditedWorld>,
    /// The source of a program.
    pub sketch: Option<ShownSketch>,
    /// What the debugger of the program says.
    pub debug: Vec<Value>,
    /// Signals.
    pub samples: Vec<Row>,
    /// Signals beside the telemetry.
    pub readings: Vec<Reading>,
    /// When the newest samples arrived.
    pub received: Arrival,
    /// What happened.
    pub events: Vec<LoggedEvent>,
    /// What was said in text.
    pub consoles: Vec<ConsoleText>,
    /// Raw bytes of the link.
    pub bytes: Vec<Burst>,
    /// Events that left the ring before the page took them.
    pub events_gone: u64,
    /// Orders of the page that the session had taken when the state was so; 0 where nobody counts them.
    pub orders: u64,
}

impl Default for Board {
    fn default() -> Self {
        Self {
            run: 1,
            received: (0.0, 0),
            samples: Ring::new(SAMPLES_KEPT),
            shown: Ring::new(READINGS_KEPT),
            printed: Ring::new(READINGS_KEPT),
            events: Ring::new(EVENTS_KEPT),
            consoles: Ring::new(CONSOLES_KEPT),
            displays: Versioned::default(),
            bytes: Ring::new(BURSTS_KEPT),
            scene: Versioned::default(),
            parameters: Versioned::default(),
            state: Versioned::default(),
            world: Versioned::default(),
            sketch: Versioned::default(),
            debug: Ring::new(MESSAGES_KEPT),
        }
    }
}

impl Board {
    /// Takes an event at this time of day \[ms since 1970\]; returns whether to wake the pages.
    pub fn take(&mut self, event: &Event, wall_ms: f64) -> bool {
        match event {
            Event::Run => {
                self.run += 1;
                self.samples.clear();
                self.shown.clear();
                self.printed.clear();
                self.consoles.clear();
                // Of a robot without displays there is no news.
                if !self.displays.value().is_empty() {
                    self.displays.set(BTreeMap::new());
                }
                self.bytes.clear();
                self.debug.clear();
                false
            }
            Event::Commanded(..) => false,
            Event::Received(now_ms) => {
                self.received = (wall_ms, *now_ms);
                false
            }
            Event::Console(said) => self.hear(said.clone()),
            Event::World(world) => self.world.set(world.clone()),
            Event::Sketch(sketch) => self.sketch.set(sketch.clone()),
            Event::Debug(message) => {
                self.debug.push(message.clone());
                true
            }
            Event::Entry(entry) => self.show(entry),
        }
    }

    fn show(&mut self, entry: &Entry) -> bool {
        match entry {
            // Pages get them with the next news: no page is woken for them.
            Entry::Burst(burst) => {
                self.bytes.push(burst.clone());
                false
            }
            Entry::Said(said) if said.to_chip => false,
            Entry::Said(said) => {
                let (usart, text) = (said.usart, readable(&said.bytes));
                self.hear(ConsoleText { usart, text })
            }
            Entry::Rows(rows) => {
                rows.iter().for_each(|row| self.samples.push(*row));
                true
            }
            Entry::Readings(readings) => {
                for reading in readings {
                    match reading.source {
                        ReadingSource::Truth | ReadingSource::Loops | ReadingSource::Others => {
                            self.shown.push(reading.clone())
                        }
                        ReadingSource::Usart(_) => self.printed.push(reading.clone()),
                    }
                }
                true
            }
            Entry::Event(event) => {
                self.events.push(event.clone());
                true
            }
            Entry::Scene(scene) => self.scene.set(scene.as_deref().cloned()),
            Entry::State(state) => self.state.set((**state).clone()),
            Entry::Parameters(parameters) => self.parameters.set(parameters.clone()),
            Entry::Outcome(_) => false,
        }
    }

    /// Text is kept as it comes; of the displays only what they show now.
    fn hear(&mut self, said: ConsoleText) -> bool {
        if said.usart != PARTS_CONSOLE {
            self.consoles.push(said);
            return true;
        }
        let mut displays = self.displays.value().clone();
        let lines = said.text.lines().filter_map(|line| line.split_once('='));
        displays.extend(lines.map(|(name, content)| (name.to_owned(), content.to_owned())));
        self.displays.set(displays)
    }

    /// What is new since `cursor`, which moves on.
    pub fn news(&self, cursor: &mut Cursor) -> News {
        let (samples, _) = self.samples.read(&mut cursor.samples);
        let (mut readings, _) = self.shown.read(&mut cursor.shown);
        readings.extend(self.printed.read(&mut cursor.printed).0);
        let (events, gone) = self.events.read(&mut cursor.events);
        let (mut consoles, _) = self.consoles.read(&mut cursor.consoles);
        if let Some(displays) = self.displays.newer(&mut cursor.displays) {
            let lines = displays
                .iter()
                .map(|(name, content)| format!("{name}={content}\n"));
            consoles.push(ConsoleText {
                usart: PARTS_CONSOLE,
                text: lines.collect(),
            });
        }
        let (bytes, _) = self.bytes.read(&mut cursor.bytes);
        let (debug, _) = self.debug.read(&mut cursor.debug);
        let first_time = cursor.run == 0;
        cursor.run = self.run;
        News {
            run: self.run,
            scene: self.scene.newer(&mut cursor.scene),
            parameters: self.parameters.newer(&mut cursor.parameters),
            state: self.state.newer(&mut cursor.state),
            world: self.world.newer(&mut cursor.world),
            sketch: self.sketch.newer(&mut cursor.sketch),
            debug,
            samples,
            readings,
            received: self.received,
            events,
            consoles,
            bytes,
            // A new page has not missed what left the ring before it came.
            events_gone: if first_time { 0 } else { gone },
            orders: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_log::Level;

    fn push(board: &mut Board, entry: Entry) {
        board.take(&entry.into(), 0.0);
    }

    fn samples(times_ms: &[i64]) -> Entry {
        Entry::Rows(times_ms.iter().map(|t_ms| Row::unknown(*t_ms)).collect())
    }

    fn event(number: usize) -> Entry {
        Entry::Event(LoggedEvent {
            t_s: 0.0,
            level: Level::Info,
            text: number.to_string(),
        })
    }

    #[test]
    fn a_new_page_gets_the_recent_past_and_then_only_what_is_new() {
        let mut board = Board::default();
        push(&mut board, samples(&[0, 40]));
        push(&mut board, event(0));
        let mut cursor = Cursor::default();
        let news = board.news(&mut cursor);
        assert_eq!((news.samples.len(), news.events.len()), (2, 1));
        push(&mut board, samples(&[80]));
        let news = board.news(&mut cursor);
        assert_eq!(
            news.samples
                .iter()
                .map(|sample| sample.t_ms)
                .collect::<Vec<_>>(),
            [80]
        );
        assert!(news.events.is_empty());
    }

    #[test]
    fn what_is_kept_is_bounded_and_a_slow_page_knows_what_it_missed() {
        let mut board = Board::default();
        let mut cursor = Cursor::default();
        board.news(&mut cursor);
        (0..3 * SAMPLES_KEPT as i64).for_each(|t_ms| push(&mut board, samples(&[t_ms])));
        (0..EVENTS_KEPT + 5).for_each(|number| push(&mut board, event(number)));
        let news = board.news(&mut cursor);
        assert_eq!(news.samples.len(), SAMPLES_KEPT);
        assert_eq!(news.events.len(), EVENTS_KEPT);
        assert_eq!(news.events_gone, 5);
    }

    #[test]
    fn of_a_display_a_page_gets_what_it_shows_now_and_text_is_not_pushed_out_by_it() {
        let mut board = Board::default();
        let said = |usart: u8, text: &str| {
            let text = text.to_owned();
            Event::Console(ConsoleText { usart, text })
        };
        board.take(&said(0, "Ready\n"), 0.0);
        board.take(&said(PARTS_CONSOLE, "eye=1\n"), 0.0);
        for frame in 0..2 * CONSOLES_KEPT {
            board.take(&said(PARTS_CONSOLE, &format!("screen={frame}\n")), 0.0);
        }
        let mut cursor = Cursor::default();
        let shown = board.news(&mut cursor).consoles;
        let last = 2 * CONSOLES_KEPT - 1;
        assert_eq!(shown[0].text, "Ready\n");
        assert_eq!(shown[1].text, format!("eye=1\nscreen={last}\n"));
        assert!(board.news(&mut cursor).consoles.is_empty());
        board.take(&Event::Run, 0.0);
        assert_eq!(board.news(&mut cursor).consoles[0].text, "");
        board.take(&Event::Run, 0.0);
        assert!(board.news(&mut cursor).consoles.is_empty());
    }

    #[test]
    fn a_reset_ends_the_samples_of_the_old_run() {
        let mut board = Board::default();
        let mut cursor = Cursor::default();
        push(&mut board, samples(&[0, 40]));
        let before = board.news(&mut cursor).run;
        board.take(&Event::Run, 0.0);
        push(&mut board, samples(&[0]));
        let news = board.news(&mut cursor);
        assert_ne!(news.run, before);
        assert_eq!(news.samples.len(), 1);
    }

    #[test]
    fn a_value_that_did_not_change_is_not_news() {
        let mut board = Board::default();
        let mut cursor = Cursor::default();
        let state = || Entry::State(Box::default());
        push(&mut board, state());
        assert!(board.news(&mut cursor).state.is_some());
        push(&mut board, state());
        assert!(board.news(&mut cursor).state.is_none());
    }
}
