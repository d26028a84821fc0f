//! Reads a log, whole or cut off.
//!
//! A log without an end, of a writer that was killed, is read as far as it goes, and says so ([`Log::cut`]). One that is damaged within, and has its
//! index, is read but for what is damaged. Logs that `rumbo import`
//! made of the original program's CSV are read too, as far as their signals have a place in a [`Row`].

use super::pieces::Pieces;
use super::row_json::Signals;
use super::schema::Topic;
use super::{Burst, LogError, Manifest, Outcome, Said, Sent};
use crate::board::{Level, LoggedEvent, State};
use crate::origin::compose;
use crate::row::Row;
use crate::target::{MapPose, Scene};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mcap::MAGIC;
use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use serde::Deserialize;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// Longest record of a log that is shorter itself: what its compressed chunks may hold \[bytes\].
const LONGEST: usize = 64 << 20;
/// A log that is shorter has no whole manifest \[bytes\].
const SHORTEST: u64 = 256;
/// What a log is that its writer had no time to begin.
const NOTHING_YET: &str = "ends before anything in it: whoever wrote it was stopped in the first moment, or it was cut off when it was copied; nothing of it can be had";
/// Why a log ends of which nothing says that it does.
pub(super) const NO_END: &str = "the log has no end: its writer was stopped";
/// The topic of a log made by `rumbo import`.
const IMPORTED: &str = "telemetry";

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
    order: Vec<Place>,
    /// Why the log ends early, where it does; or why something within is missing.
    pub cut: Option<String>,
    /// Something within is missing, and what comes after it is there.
    pub has_holes: bool,
}

/// Where something sent is.
#[derive(Clone, Copy, Debug)]
enum Place {
    Link(usize),
    Said(usize),
}

/// What messages of a channel are.
#[derive(Clone, Copy)]
pub(super) enum Channel {
    Ours(Topic),
    Imported,
}

impl Channel {
    /// Of a topic; `None`: nothing of it is taken.
    pub(super) fn of(topic: &str, with_link: bool) -> Option<Self> {
        match Topic::find(topic) {
            Some(Topic::FromRobot | Topic::ToRobot) if !with_link => None,
            Some(topic) => Some(Self::Ours(topic)),
            None => (topic == IMPORTED).then_some(Self::Imported),
        }
    }
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
        let mut log = Self::default();
        if let Err(error) = log.take_all(file, length, &mut HashMap::new(), with_link) {
            let pieces = (error != NO_END).then(|| Pieces::find(path)).flatten();
            log = match pieces {
                Some(pieces) => pieces.take(&error, with_link),
                None => Self {
                    cut: Some(error),
                    ..log
                },
            };
        }
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
        Ok(log)
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

    pub(super) fn take_all(
        &mut self,
        mut file: impl Read,
        length: u64,
        channels: &mut HashMap<u16, Option<Channel>>,
        with_link: bool,
    ) -> Result<(), String> {
        // What a damaged length asks for is not there to be read.
        let longest = usize::try_from(length).map_or(LONGEST, |length| length.max(LONGEST));
        let options = LinearReaderOptions::default()
            .with_skip_end_magic(true)
            // Nothing of a damaged chunk is taken, its lengths least of all.
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(longest);
        let mut reader = LinearReader::new_with_options(options);
        while let Some(event) = reader.next_event() {
            match event.map_err(|error| error.to_string())? {
                LinearReadEvent::ReadRequest(count) => {
                    let into = reader.insert(count);
                    let read = file.read(into).map_err(|error| error.to_string())?;
                    reader.notify_read(read);
                }
                LinearReadEvent::Record { opcode, data } => {
                    let record = mcap::parse_record(opcode, data);
                    let record = record.map_err(|error| error.to_string())?;
                    if self.take_record(record, channels, with_link)? {
                        return Ok(());
                    }
                }
            }
        }
        Err(NO_END.into())
    }

    /// Whether it was the last one.
    fn take_record(
        &mut self,
        record: Record<'_>,
        channels: &mut HashMap<u16, Option<Channel>>,
        with_link: bool,
    ) -> Result<bool, String> {
        match record {
            Record::Channel(channel) => {
                channels.insert(channel.id, Channel::of(&channel.topic, with_link));
            }
            Record::Message { header, data } => {
                if let Some(Some(channel)) = channels.get(&header.channel_id) {
                    self.take(*channel, header.log_time, &data)
                        .map_err(|error| {
                            format!(
                                "a message at {:.3} s is damaged ({error})",
                                header.log_time as f64 / 1e9
                            )
                        })?;
                }
            }
            Record::Metadata(metadata) => match metadata.name.as_str() {
                "manifest" => self.manifest = Manifest::from_metadata(&metadata.metadata),
                "outcome" => self.outcome = Some(Outcome::from_metadata(&metadata.metadata)),
                _ => {}
            },
            Record::Attachment { header, data, .. } => {
                if let (Some(manifest), Some(name)) =
                    (&mut self.manifest, header.name.strip_suffix(".toml"))
                {
                    manifest
                        .files
                        .insert(name.into(), String::from_utf8_lossy(&data).into_owned());
                }
            }
            Record::DataEnd(_) => return Ok(true),
            _ => {}
        }
        Ok(false)
    }

    fn take(&mut self, channel: Channel, time_ns: u64, data: &[u8]) -> serde_json::Result<()> {
        let t_us = time_ns / 1_000;
        let t_ms = (t_us / 1_000) as i64;
        let topic = match channel {
            Channel::Ours(topic) => topic,
            Channel::Imported => Topic::Telemetry,
        };
        match topic {
            Topic::Telemetry => {
                let Signals(mut row) = serde_json::from_slice(data)?;
                row.t_ms = t_ms;
                self.rows.push(row);
            }
            Topic::State => self.states.push(serde_json::from_slice(data)?),
            Topic::Parameters => self.parameters.push((t_ms, serde_json::from_slice(data)?)),
            Topic::Events => self.events.push(event(t_ms, serde_json::from_slice(data)?)),
            Topic::Scene => {
                let Around { scene } = serde_json::from_slice(data)?;
                self.scene = scene;
            }
            Topic::FromRobot | Topic::ToRobot => {
                let Bytes { data } = serde_json::from_slice(data)?;
                let to_robot = topic == Topic::ToRobot;
                if to_robot {
                    self.order.push(Place::Link(self.link.len()));
                }
                self.link.push(Burst {
                    t_us,
                    to_robot,
                    bytes: decoded(&data)?,
                });
            }
            Topic::Console => {
                let Console {
                    usart,
                    to_chip,
                    data,
                } = serde_json::from_slice(data)?;
                if to_chip {
                    self.order.push(Place::Said(self.said.len()));
                }
                self.said.push(Said {
                    t_us,
                    usart,
                    to_chip,
                    bytes: decoded(&data)?,
                });
            }
            // Made of what the others hold.
            Topic::Estimated | Topic::True | Topic::World => {}
        }
        Ok(())
    }
}

#[derive(Deserialize)]
struct Around {
    scene: Option<Scene>,
}

#[derive(Deserialize)]
struct Bytes<'a> {
    #[serde(borrow)]
    data: Cow<'a, str>,
}

#[derive(Deserialize)]
struct Console<'a> {
    usart: u8,
    to_chip: bool,
    #[serde(borrow)]
    data: Cow<'a, str>,
}

fn decoded(data: &str) -> serde_json::Result<Vec<u8>> {
    STANDARD
        .decode(data.as_bytes())
        .map_err(serde::de::Error::custom)
}

#[derive(Deserialize)]
struct Happened {
    level: u8,
    message: String,
    name: String,
}

fn event(t_ms: i64, said: Happened) -> LoggedEvent {
    let level = match (said.level, said.name.as_str()) {
        (_, "good") => Level::Good,
        (3, _) => Level::Warning,
        (4.., _) => Level::Fault,
        _ => Level::Info,
    };
    LoggedEvent {
        t_s: t_ms as f64 / 1e3,
        level,
        text: said.message,
    }
}
