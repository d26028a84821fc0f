//! The board between the session and the pages: the session writes, each page's connection reads on from where it was.
//!
//! Everything on it is bounded. Samples and events sit in rings with running numbers, so that a page that is slow, was away or is new
//! gets the recent past and never holds the session up; the rest is one current value each, with a version.
//! Nobody reads, nothing is made: rows become JSON in the connections.

mod ring;

use crate::console::ConsoleText;
use crate::echo::Echo;
use crate::log_file::Problem;
use crate::recorder::Recorder;
use ring::{Ring, Versioned};
use rumbo_log::{Burst, Entry, LoggedEvent, ParameterState, Row, Scene, State};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

/// Samples kept: ten minutes of telemetry at 25 Hz.
pub(crate) const SAMPLES_KEPT: usize = 15_000;
/// Events kept.
pub(crate) const EVENTS_KEPT: usize = 1_000;

/// Pieces of console text kept: of each slice of time in which a USART spoke, one.
pub(crate) const CONSOLES_KEPT: usize = 2_000;
/// Pieces of the link's raw bytes kept: some seconds of both directions.
pub(crate) const BURSTS_KEPT: usize = 600;

#[derive(Debug)]
struct Contents {
    run: u32,
    heard: Heard,
    samples: Ring<Row>,
    events: Ring<LoggedEvent>,
    consoles: Ring<ConsoleText>,
    bytes: Ring<Burst>,
    scene: Versioned<Option<Scene>>,
    parameters: Versioned<Vec<ParameterState>>,
    state: Versioned<State>,
}

/// When the newest samples were put here: the time of day \[ms since 1970\], and the target's \[ms\]. Says how old a picture is.
pub(crate) type Heard = (f64, i64);

/// What is to be shown.
#[derive(Debug)]
pub(crate) struct Board {
    contents: Mutex<Contents>,
    /// Records what is put on the board.
    recorder: Mutex<Option<Recorder>>,
    /// Shows what goes wrong on the terminal too.
    echo: Option<Echo>,
    /// Shows the same to viewers of another protocol.
    #[cfg(feature = "foxglove")]
    bridge: Option<crate::bridge::Bridge>,
    changed: watch::Sender<()>,
}

/// How far a page has read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cursor {
    run: u32,
    samples: u64,
    events: u64,
    consoles: u64,
    bytes: u64,
    scene: u64,
    parameters: u64,
    state: u64,
}

/// What is new to a page.
#[derive(Debug, Default)]
pub(crate) struct News {
    /// Number of the run, which changes with a reset: what the page has of earlier runs is over.
    pub(crate) run: u32,
    pub(crate) scene: Option<Option<Scene>>,
    pub(crate) parameters: Option<Vec<ParameterState>>,
    pub(crate) state: Option<State>,
    pub(crate) samples: Vec<Row>,
    pub(crate) heard: Heard,
    pub(crate) events: Vec<LoggedEvent>,
    pub(crate) consoles: Vec<ConsoleText>,
    pub(crate) bytes: Vec<Burst>,
    /// Events that left the ring before the page took them.
    pub(crate) events_gone: u64,
}

impl Board {
    pub(crate) fn new() -> Self {
        Self {
            contents: Mutex::new(Contents {
                run: 1,
                heard: (0.0, 0),
                samples: Ring::new(SAMPLES_KEPT),
                events: Ring::new(EVENTS_KEPT),
                consoles: Ring::new(CONSOLES_KEPT),
                bytes: Ring::new(BURSTS_KEPT),
                scene: Versioned::default(),
                parameters: Versioned::default(),
                state: Versioned::default(),
            }),
            recorder: Mutex::new(None),
            echo: None,
            #[cfg(feature = "foxglove")]
            bridge: None,
            changed: watch::Sender::new(()),
        }
    }

    /// A poisoned lock holds whole values all the same: each is written in one move.
    fn lock(&self) -> MutexGuard<'_, Contents> {
        self.contents.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn recorder(&self) -> MutexGuard<'_, Option<Recorder>> {
        self.recorder.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on everything put on the board is recorded. What was recorded before is complete.
    pub(crate) fn record(&self, recorder: Recorder) {
        *self.recorder() = Some(recorder);
    }

    /// Ends the recording and gives its recorder.
    pub(crate) fn end_recording(&self) -> Option<Recorder> {
        self.recorder().take()
    }

    /// What has gone wrong with the recording since it was last asked.
    pub(crate) fn recording_trouble(&self) -> Option<Problem> {
        self.recorder().as_ref().and_then(Recorder::trouble)
    }

    /// Records something that is not shown.
    pub(crate) fn take(&self, entry: Entry) {
        let entry = Arc::new(entry);
        #[cfg(feature = "foxglove")]
        if let Some(bridge) = &self.bridge {
            bridge.take(&entry);
        }
        if let Some(recorder) = &mut *self.recorder() {
            recorder.take(entry);
        }
    }

    /// What is recorded is also shown to viewers of another protocol.
    #[cfg(feature = "foxglove")]
    pub(crate) fn bridged(self, bridge: Option<crate::bridge::Bridge>) -> Self {
        Self { bridge, ..self }
    }

    /// What goes wrong is also shown on the terminal.
    pub(crate) fn echoed(self, echo: Option<Echo>) -> Self {
        Self { echo, ..self }
    }

    /// Records raw bytes of the link. Pages get them with the next news: nobody is woken for them.
    pub(crate) fn link(&self, burst: Burst) {
        self.lock().bytes.push(burst.clone());
        self.take(Entry::Burst(burst));
    }

    /// Wakes its holder when something new is on the board.
    pub(crate) fn subscribe(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    pub(crate) fn push_samples(&self, samples: &[Row]) {
        if samples.is_empty() {
            return;
        }
        self.take(Entry::Rows(samples.to_vec()));
        let mut contents = self.lock();
        samples
            .iter()
            .for_each(|sample| contents.samples.push(*sample));
        self.changed.send_replace(());
    }

    /// The samples that are put on the board next were heard now.
    pub(crate) fn heard(&self, now_ms: i64) {
        let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let wall_ms = since.map_or(0.0, |since| since.as_secs_f64() * 1e3);
        self.lock().heard = (wall_ms, now_ms);
    }

    pub(crate) fn push_event(&self, event: LoggedEvent) {
        self.take(Entry::Event(event.clone()));
        if let Some(echo) = &self.echo {
            echo.event(&event);
        }
        self.lock().events.push(event);
        self.changed.send_replace(());
    }

    pub(crate) fn push_console(&self, said: ConsoleText) {
        self.lock().consoles.push(said);
        self.changed.send_replace(());
    }

    pub(crate) fn set_scene(&self, scene: Option<Scene>) {
        self.take(Entry::Scene(scene.clone().map(Box::new)));
        if self.lock().scene.set(scene) {
            self.changed.send_replace(());
        }
    }

    pub(crate) fn set_parameters(&self, parameters: &[ParameterState]) {
        self.take(Entry::Parameters(parameters.to_vec()));
        if self.lock().parameters.set(parameters.to_vec()) {
            self.changed.send_replace(());
        }
    }

    pub(crate) fn set_state(&self, state: State) {
        self.take(Entry::State(Box::new(state.clone())));
        if self.lock().state.set(state) {
            self.changed.send_replace(());
        }
    }

    /// A new run begins: samples and consoles of the old one are over, its events stay.
    pub(crate) fn start_run(&self) {
        let mut contents = self.lock();
        contents.run += 1;
        contents.samples.clear();
        contents.consoles.clear();
        contents.bytes.clear();
    }

    /// What is new since `cursor`, which moves on.
    pub(crate) fn news(&self, cursor: &mut Cursor) -> News {
        let contents = self.lock();
        let (samples, _) = contents.samples.read(&mut cursor.samples);
        let (events, gone) = contents.events.read(&mut cursor.events);
        let (consoles, _) = contents.consoles.read(&mut cursor.consoles);
        let (bytes, _) = contents.bytes.read(&mut cursor.bytes);
        let first_time = cursor.run == 0;
        cursor.run = contents.run;
        News {
            run: contents.run,
            scene: contents.scene.newer(&mut cursor.scene),
            parameters: contents.parameters.newer(&mut cursor.parameters),
            state: contents.state.newer(&mut cursor.state),
            samples,
            heard: contents.heard,
            events,
            consoles,
            bytes,
            // What left the ring before the page came was not its to take.
            events_gone: if first_time { 0 } else { gone },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_log::Level;

    fn sample(t_ms: i64) -> Row {
        Row::unknown(t_ms)
    }

    fn event(number: usize) -> LoggedEvent {
        LoggedEvent {
            t_s: 0.0,
            level: Level::Info,
            text: number.to_string(),
        }
    }

    #[test]
    fn a_new_page_gets_the_recent_past_and_then_only_what_is_new() {
        let board = Board::new();
        board.push_samples(&[sample(0), sample(40)]);
        board.push_event(event(0));
        let mut cursor = Cursor::default();
        let news = board.news(&mut cursor);
        assert_eq!((news.samples.len(), news.events.len()), (2, 1));
        board.push_samples(&[sample(80)]);
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
        let board = Board::new();
        let mut cursor = Cursor::default();
        board.news(&mut cursor);
        (0..3 * SAMPLES_KEPT as i64).for_each(|t_ms| board.push_samples(&[sample(t_ms)]));
        (0..EVENTS_KEPT + 5).for_each(|number| board.push_event(event(number)));
        let news = board.news(&mut cursor);
        assert_eq!(news.samples.len(), SAMPLES_KEPT);
        assert_eq!(news.events.len(), EVENTS_KEPT);
        assert_eq!(news.events_gone, 5);
    }

    #[test]
    fn a_reset_ends_the_samples_of_the_old_run() {
        let board = Board::new();
        let mut cursor = Cursor::default();
        board.push_samples(&[sample(0), sample(40)]);
        let before = board.news(&mut cursor).run;
        board.start_run();
        board.push_samples(&[sample(0)]);
        let news = board.news(&mut cursor);
        assert_ne!(news.run, before);
        assert_eq!(news.samples.len(), 1);
    }

    #[test]
    fn a_value_that_did_not_change_is_not_news() {
        let board = Board::new();
        let mut cursor = Cursor::default();
        board.set_state(State::default());
        assert!(board.news(&mut cursor).state.is_some());
        board.set_state(State::default());
        assert!(board.news(&mut cursor).state.is_none());
    }
}
