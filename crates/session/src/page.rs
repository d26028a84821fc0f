//! Messages to a page, in JSON, over a WebSocket or to a page that runs beside the session.

use crate::board::{Arrival, News};
use crate::catalogue::{self, ModeEntry};
use crate::console::ConsoleText;
use crate::lease::ControlView;
use crate::program::ShownSketch;
use crate::world::EditedWorld;
use rumbo_log::{
    Burst, LoggedEvent, ParameterState, Reading, ReadingSource, Row, RowValue, Scene, State,
};
use serde::Serialize;
use serde_json::Value;

/// Rows of samples in one message.
const ROWS_PER_MESSAGE: usize = 250;

/// To a page.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ToPage<'a> {
    /// The first message: what the others refer to.
    Hello {
        /// Of Rumbo.
        version: &'static str,
        /// The names of the signals in a row.
        columns: Vec<&'static str>,
        /// The modes to choose from.
        modes: Vec<ModeEntry>,
        /// The robots in the world, if there are several.
        #[serde(skip_serializing_if = "<[String]>::is_empty")]
        robots: &'a [String],
        /// The one of them that the page is of.
        robot: usize,
    },
    /// What surrounds the robot.
    Scene {
        /// Number of the run.
        run: u32,
        /// `None` where that is not known.
        scene: &'a Option<Scene>,
    },
    /// The parameter table with its values.
    Parameters {
        /// In the order of their numbers.
        parameters: &'a [ParameterState],
    },
    /// What changes slowly.
    State {
        /// Number of the run.
        run: u32,
        /// Orders of this page that the session had taken by then.
        orders: u64,
        /// All of it.
        state: &'a State,
    },
    /// What a page asked of a world that it edits.
    World(&'a EditedWorld),
    /// The source of a program that a page asked for.
    Sketch(&'a ShownSketch),
    /// What the debugger of the program says.
    Debug {
        /// Messages of the Debug Adapter Protocol, in order.
        messages: &'a [Value],
    },
    /// Rows of signals; the page discards those of another run.
    Samples {
        /// Number of the run.
        run: u32,
        /// When the newest arrived.
        heard: Arrival,
        /// In order of time.
        rows: Vec<Vec<RowValue>>,
    },
    /// Signals beside the telemetry; the page discards those of another run.
    Readings {
        /// Number of the run.
        run: u32,
        /// Each of the same signals, in order of time.
        groups: Vec<ReadingGroup<'a>>,
    },
    /// What happened.
    Events {
        /// In order of time.
        events: &'a [LoggedEvent],
    },
    /// What the USARTs of an emulated chip said.
    Consoles {
        /// Number of the run.
        run: u32,
        /// In order of time.
        said: &'a [ConsoleText],
    },
    /// Raw bytes of the link.
    Bytes {
        /// In order of time.
        bytes: Vec<LinkBytes>,
    },
    /// Who has control.
    Control(ControlView),
    /// Why the connection is closed now.
    Error {
        /// For a person.
        text: &'a str,
    },
}

impl<'a> ToPage<'a> {
    /// The first message to a page of one of these robots, which are named if there are several.
    #[must_use]
    pub fn hello(robots: &'a [String], robot: usize) -> Self {
        Self::Hello {
            version: env!("CARGO_PKG_VERSION"),
            columns: Row::names().collect(),
            modes: catalogue::modes(),
            robots,
            robot,
        }
    }

    /// As it is sent; `None` never happens, since all of it can be written as JSON.
    #[must_use]
    pub fn json(&self) -> Option<String> {
        serde_json::to_string(self).ok()
    }
}

/// Readings of the same signals, as the page gets them.
#[derive(Debug, Serialize)]
pub struct ReadingGroup<'a> {
    source: ReadingSource,
    names: &'a [String],
    /// Time \[s\] and values of each.
    rows: Vec<(f64, Vec<RowValue>)>,
}

impl<'a> ReadingGroup<'a> {
    fn of(readings: &'a [Reading]) -> Option<Self> {
        let first = readings.first()?;
        Some(Self {
            source: first.source,
            names: &first.names,
            rows: readings
                .iter()
                .map(|each| (each.t_ms as f64 / 1e3, each.cells()))
                .collect(),
        })
    }
}

/// Bytes that crossed the link together, as the page gets them.
#[derive(Debug, Serialize)]
pub struct LinkBytes {
    t_s: f64,
    to_robot: bool,
    hex: String,
}

impl From<&Burst> for LinkBytes {
    fn from(burst: &Burst) -> Self {
        let digits = burst.bytes.iter().map(|byte| format!("{byte:02x}"));
        Self {
            t_s: burst.t_us as f64 / 1e6,
            to_robot: burst.to_robot,
            hex: digits.collect(),
        }
    }
}

impl News {
    /// The messages of these news, each made when it is asked for.
    pub fn messages(&self) -> impl Iterator<Item = ToPage<'_>> {
        let run = self.run;
        let scene = self.scene.iter();
        let scene = scene.map(move |scene| ToPage::Scene { run, scene });
        let state = self.state.iter();
        let state = state.map(move |state| ToPage::State {
            run,
            orders: self.orders,
            state,
        });
        let world = self.world.iter().map(ToPage::World);
        let sketch = self.sketch.iter().map(ToPage::Sketch);
        let debug = some(&self.debug).map(|messages| ToPage::Debug { messages });
        let parameters = self.parameters.iter();
        let parameters = parameters.map(|parameters| ToPage::Parameters { parameters });
        let events = some(&self.events).map(|events| ToPage::Events { events });
        let said = some(&self.consoles).map(move |said| ToPage::Consoles { run, said });
        let bytes = some(&self.bytes).map(|bytes| ToPage::Bytes {
            bytes: bytes.iter().map(LinkBytes::from).collect(),
        });
        let rows = self.samples.chunks(ROWS_PER_MESSAGE);
        let samples = rows.map(move |rows| ToPage::Samples {
            run,
            heard: self.received,
            rows: rows.iter().map(Row::cells).collect(),
        });
        let readings = self.readings.chunks(ROWS_PER_MESSAGE);
        let readings = readings.map(move |readings| {
            let alike = |one: &Reading, other: &Reading| {
                one.source == other.source && one.names == other.names
            };
            let groups = readings.chunk_by(alike).filter_map(ReadingGroup::of);
            ToPage::Readings {
                run,
                groups: groups.collect(),
            }
        });
        scene
            .chain(state)
            .chain(world)
            .chain(sketch)
            .chain(debug)
            .chain(parameters)
            .chain(events)
            .chain(said)
            .chain(bytes)
            .chain(samples)
            .chain(readings)
    }
}

/// All of them at once, if there are any.
fn some<T>(items: &[T]) -> impl Iterator<Item = &[T]> {
    (!items.is_empty()).then_some(items).into_iter()
}
