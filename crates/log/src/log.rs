//! A log in memory.

use crate::entry::{Burst, Said};
use crate::event::LoggedEvent;
use crate::manifest::{Manifest, Outcome};
use crate::reading::Reading;
use crate::scene::{Scene, Truth, compose};
use crate::signals::Row;
use crate::state::State;
use std::collections::BTreeMap;

/// A log in memory.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// What ran, where recorded.
    pub manifest: Option<Manifest>,
    /// The outcome, where it was judged.
    pub outcome: Option<Outcome>,
    /// The signals, in order of time.
    pub rows: Vec<Row>,
    /// Signals beside the telemetry, in order of time.
    pub readings: Vec<Reading>,
    /// What happened, with its time \[s\].
    pub events: Vec<LoggedEvent>,
    /// The slow state, in order of time.
    pub states: Vec<State>,
    /// What surrounded the robot.
    pub scene: Option<Scene>,
    /// The parameters' values, each with its time \[ms\].
    pub parameters: Vec<(i64, BTreeMap<String, f32>)>,
    /// What crossed the link, in order.
    pub link: Vec<Burst>,
    /// What crossed the USARTs of an emulated chip, in order.
    pub said: Vec<Said>,
    /// What was sent to the robot, in order, which times alone do not give: indices in `link` and `said`.
    pub(crate) order: Vec<SentIndex>,
    /// Why the log ends early, where it does; or why something within is missing.
    pub cut: Option<String>,
    /// Something within is missing, while what follows is present.
    pub has_holes: bool,
    /// Other notes for the reader, a line each; they do not mean that anything is missing.
    pub notes: Vec<String>,
}

/// Index of something sent.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SentIndex {
    Link(usize),
    Said(usize),
}

impl Log {
    /// Adds a ghost: its ground truth at the time of each row \[us\], in the world of `scene`. A robot without a known world is
    /// placed there too, with its origin at the ghost's start.
    ///
    /// # Errors
    /// Those of the ghost.
    pub fn add_ghost<E>(
        &mut self,
        scene: Scene,
        mut ghost: impl FnMut(u64) -> Result<Truth, E>,
    ) -> Result<(), E> {
        let start = self.scene.is_none().then_some(scene.start);
        for row in &mut self.rows {
            let truth = ghost(u64::try_from(row.t_ms).unwrap_or(0) * 1_000)?;
            row.set_ghost(Some(&truth));
            if let Some(start) = start {
                let at = row.pose("origin_").unwrap_or_default();
                row.set_pose("origin_", compose(start, at));
            }
        }
        self.scene.get_or_insert(scene);
        Ok(())
    }

    /// What was sent to the robot, in order.
    pub fn sent(&self) -> impl Iterator<Item = Sent<'_>> {
        self.order.iter().filter_map(|place| match *place {
            SentIndex::Link(at) => self.link.get(at).map(Sent::Link),
            SentIndex::Said(at) => self.said.get(at).map(Sent::Typed),
        })
    }

    /// Whether it holds no data: it ends within its manifest and attached files.
    #[must_use]
    pub fn holds_nothing(&self) -> bool {
        let silent = self.rows.is_empty() && self.states.is_empty() && self.events.is_empty();
        silent && self.readings.is_empty() && self.link.is_empty() && self.said.is_empty()
    }

    /// Why nothing of what happened can be had from it, if so.
    #[must_use]
    pub fn why_empty(&self) -> Option<String> {
        let why = self.cut.as_ref().filter(|_| self.holds_nothing())?;
        Some(format!(
            "nothing of what happened can be had from it: {why}"
        ))
    }

    /// The robot spoke the original's text, which people can read, too.
    #[must_use]
    pub fn speaks_text(&self) -> bool {
        self.states.iter().any(|state| state.robot.text)
    }

    /// Events as lines: time \[s\], level, text.
    pub fn events(&self) -> impl Iterator<Item = (f64, &'static str, &str)> {
        self.events
            .iter()
            .map(|event| (event.t_s, event.level.name(), event.text.as_str()))
    }

    /// The parameters' values by name, as known at the end; empty where the robot reported none.
    #[must_use]
    pub fn parameters(&self) -> BTreeMap<String, f32> {
        let last = self.parameters.last();
        last.map(|(_, values)| values.clone()).unwrap_or_default()
    }

    /// What surrounded the robot, if it was simulated.
    #[must_use]
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// Length of the log \[s\].
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        let row_s = self.rows.last().map_or(0.0, |row| row.t_ms as f64 / 1e3);
        let state_s = self.states.last().map_or(0.0, |state| state.t_s);
        let link_s = self
            .link
            .last()
            .map_or(0.0, |burst| burst.t_us as f64 / 1e6);
        let reading_s = self
            .readings
            .last()
            .map_or(0.0, |each| each.t_ms as f64 / 1e3);
        row_s.max(state_s).max(link_s).max(reading_s)
    }

    /// Whether part of it is missing.
    pub(crate) fn lose(&mut self, what: &str) {
        self.has_holes = true;
        self.cut = Some(match self.cut.take() {
            Some(why) => format!("{why}; {what}"),
            None => what.to_owned(),
        });
    }
}

/// Something sent to the robot.
#[derive(Clone, Copy, Debug)]
pub enum Sent<'a> {
    /// Bytes over the link.
    Link(&'a Burst),
    /// A line typed to a USART.
    Typed(&'a Said),
}

impl Sent<'_> {
    /// When, in the target's time \[us\].
    #[must_use]
    pub fn t_us(&self) -> u64 {
        match self {
            Self::Link(burst) => burst.t_us,
            Self::Typed(said) => said.t_us,
        }
    }
}
