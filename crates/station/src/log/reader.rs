//! Reads a log, whole or cut off.
//!
//! A log without an end, of a writer that was killed, is read as far as it goes, and says so ([`Log::cut`]). One that is damaged within, and has its
//! index, is read but for what is damaged. Logs that `rumbo import`
//! made of the original program's CSV are read too, as far as their signals have a place in a [`Row`].

use super::earlier;
use super::intake::{Intake, Stop};
use super::pieces::Pieces;
use super::{Burst, LogError, Manifest, Outcome, Said, Sent};
use crate::event::LoggedEvent;
use crate::origin::compose;
use crate::scene::{MapPose, Scene};
use crate::signals::Row;
use crate::state::State;
use mcap::MAGIC;
use rumbo_wire::Hello;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

/// A log that is shorter has no whole manifest \[bytes\].
const SHORTEST: u64 = 256;
/// What a log is that its writer had no time to begin.
const NOTHING_YET: &str = "ends before its first record: its writer was stopped at once, or it was cut off when it was copied; nothing of it can be read";

/// A log in memory.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// What ran, where the log says so.
    pub manifest: Option<Manifest>,
    /// How it ended, where somebody judged.
    pub outcome: Option<Outcome>,
    /// The signals, in order of time.
    pub rows: Vec<Row>,
    /// What happened, with its time \[s\].
    pub(crate) events: Vec<LoggedEvent>,
    /// The slow state, in order of time.
    pub(crate) states: Vec<State>,
    /// What surrounded the robot.
    pub(crate) scene: Option<Scene>,
    /// The parameters' values, each with its time \[ms\].
    pub(crate) parameters: Vec<(i64, BTreeMap<String, f32>)>,
    /// What crossed the link, in order.
    pub link: Vec<Burst>,
    /// What crossed the USARTs of an emulated chip, in order.
    pub said: Vec<Said>,
    /// What went to the robot, in the order in which it went, which times alone do not tell: places in `link` and `said`.
    pub(super) order: Vec<Place>,
    /// Why the log ends early, where it does; or why something within is missing.
    pub cut: Option<String>,
    /// Something within is missing, and what comes after it is there.
    pub has_holes: bool,
    /// What else a reader should know, a line each; nothing is missing for these.
    pub notes: Vec<String>,
}

/// Where something sent is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Link(usize),
    Said(usize),
}

impl Log {
    /// Puts a ghost beside the robot: where it is at each row, by its time \[us\], in the world of `scene`. A robot of which no world is known
    /// is put there too, its origin where the ghost begins.
    ///
    /// # Errors
    /// What the ghost has to say.
    pub fn haunt(
        &mut self,
        scene: Scene,
        mut ghost: impl FnMut(u64) -> Result<MapPose, String>,
    ) -> Result<(), String> {
        let start = self.scene.is_none().then_some(scene.start);
        for row in &mut self.rows {
            let pose = ghost(u64::try_from(row.t_ms).unwrap_or(0) * 1_000)?;
            row.set_pose("ghost_", pose);
            if let Some(start) = start {
                let at = row.pose("origin_").unwrap_or_default();
                row.set_pose("origin_", compose(start, at));
            }
        }
        self.scene.get_or_insert(scene);
        Ok(())
    }

    /// What went to the robot, in the order in which it went.
    pub fn sent(&self) -> impl Iterator<Item = Sent<'_>> {
        self.order.iter().filter_map(|place| match *place {
            Place::Link(at) => self.link.get(at).map(Sent::Link),
            Place::Said(at) => self.said.get(at).map(Sent::Typed),
        })
    }

    /// Reads a log.
    ///
    /// # Errors
    /// A file that cannot be read, is no log, or holds nothing known.
    pub fn read(path: &Path) -> Result<Self, LogError> {
        Self::read_parts(path, true)
    }

    /// Reads a log without the raw bytes of its link, for showing.
    ///
    /// # Errors
    /// As [`Log::read`].
    pub fn read_signals(path: &Path) -> Result<Self, LogError> {
        Self::read_parts(path, false)
    }

    fn read_parts(path: &Path, with_link: bool) -> Result<Self, LogError> {
        let wrong = |what: String| LogError::new(path, what);
        let unreadable = |error: io::Error| {
            wrong(format!(
                "cannot be read ({error}); `rumbo list logs` shows what there is"
            ))
        };
        let file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let mut file = BufReader::new(file);
        // A file of another kind may be too long for the memory.
        let start = file.fill_buf().map_err(unreadable)?;
        if !start.starts_with(MAGIC) {
            return Err(wrong(match MAGIC.starts_with(start) {
                true => NOTHING_YET.into(),
                false => {
                    "is no MCAP log; give a log of rumbo, or convert a CSV with `rumbo import`"
                        .into()
                }
            }));
        }
        let mut log = Intake::new(with_link).read(file, length);
        if let Some(stop @ (Stop::NoEnd | Stop::Damaged(_))) = &log.stop
            && let Some(pieces) = Pieces::find(path)
        {
            log = pieces.take(stop.text(), with_link);
        }
        let mut log = log.into_log();
        if log.manifest.is_none() && log.rows.is_empty() {
            let what = match log.cut {
                Some(_) if length < SHORTEST => NOTHING_YET,
                Some(_) => {
                    "ends before anything of rumbo in it; was it cut off when it was copied, or is it another program's log?"
                }
                None => {
                    "holds neither a manifest nor signals of rumbo; is it another program's log?"
                }
            };
            return Err(wrong(what.into()));
        }
        log.rows.sort_by_key(|row| row.t_ms);
        earlier::renew(&mut log.link);
        Ok(log)
    }

    /// How the robot first named itself in frames.
    #[must_use]
    pub fn hello(&self) -> Option<Hello> {
        earlier::hello(&self.link)
    }

    /// Nothing of what happened is in it: it ends within its manifest and the files that ran.
    #[must_use]
    pub fn holds_nothing(&self) -> bool {
        let heard = self.rows.is_empty() && self.states.is_empty() && self.events.is_empty();
        heard && self.link.is_empty() && self.said.is_empty()
    }

    /// The robot spoke the original's text: what it said is for people, too.
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

    /// The parameters' values by name, as they were known at the end; empty where the robot told none.
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
        row_s.max(state_s).max(link_s)
    }

    /// Something of it is missing.
    pub(super) fn lose(&mut self, what: &str) {
        self.has_holes = true;
        self.cut = Some(match self.cut.take() {
            Some(why) => format!("{why}; {what}"),
            None => what.to_owned(),
        });
    }
}
