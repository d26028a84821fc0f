//! The session at a station: the WebSocket that a page of the dashboard opens, what it brings, and orders.

use crate::address::{Address, SILENCE, StationError};
use crate::parameters::ParameterState;
use rumbo_log::{LoggedEvent, Row, Scene, State};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::{Error, Message, WebSocket};

/// A station may be starting for so long.
const STARTING: Duration = Duration::from_secs(10);
const AGAIN: Duration = Duration::from_millis(200);
/// Rows and events this much older than the state when the node joins are the past, which is not published [ms].
const PAST_MS: f64 = 500.0;

/// An order to the robot, as a page sends it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Order {
    Stop,
    Arm,
    Disarm,
    ClearFault,
    ResetPose,
    TakeControl,
    ReleaseControl,
    Mode {
        mode: u8,
    },
    Velocity {
        forward_m_s: f32,
        yaw_rad_s: f32,
    },
    Goal {
        x_m: f32,
        y_m: f32,
    },
    Route {
        repeat: bool,
        relative: bool,
        waypoints: [Waypoint; 1],
    },
    SetParam {
        id: u8,
        value: f32,
    },
}

/// A waypoint of a route.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Waypoint {
    pub(crate) x_m: f32,
    pub(crate) y_m: f32,
    pub(crate) heading_rad: Option<f32>,
}

/// A mode to choose.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Mode {
    pub(crate) id: u8,
    pub(crate) name: String,
}

/// The node's relation to control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Seat {
    /// It may watch and stop.
    Viewer,
    /// Nobody has control: the first order takes it.
    Free,
    /// It has control.
    Driver,
    /// Somebody else has control.
    Passenger,
}

impl Seat {
    /// Why an order would be refused; the station says the same.
    fn refuses(self, order: &Order) -> Option<&'static str> {
        match (self, order) {
            (_, Order::Stop | Order::ReleaseControl) => None,
            (Self::Viewer, _) => Some(WATCHING),
            (Self::Passenger, Order::TakeControl) => None,
            (Self::Passenger, _) => Some(NOT_DRIVING),
            (Self::Free | Self::Driver, _) => None,
        }
    }
}

const WATCHING: &str = "refused: this page may watch, and stop the robot";
const NOT_DRIVING: &str = "refused: another page has control; take it first";

/// What a station sends, as far as it is of use here.
#[derive(Deserialize)]
#[serde(tag = "type", rename_all = "snake_case")]
enum ToPage {
    Hello(Hello),
    Scene {
        run: u32,
        scene: Option<Box<Scene>>,
    },
    Parameters {
        parameters: Vec<ParameterState>,
    },
    State {
        run: u32,
        orders: u64,
        state: Box<State>,
    },
    Samples {
        run: u32,
        heard: (f64, i64),
        rows: Vec<Vec<Value>>,
    },
    Events {
        events: Vec<LoggedEvent>,
    },
    Control {
        seat: Seat,
    },
    Error {
        text: String,
    },
    #[serde(other)]
    Other,
}

/// The first message.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct Hello {
    version: String,
    columns: Vec<String>,
    pub(crate) modes: Vec<Mode>,
    /// The robots in the world, if there are several.
    #[serde(default)]
    robots: Vec<String>,
}

/// What is new.
#[derive(Debug, Default)]
pub(crate) struct News {
    /// Number of the run, which changes with a reset.
    pub(crate) run: u32,
    /// What surrounds the robot; `None` in it where that is not known.
    pub(crate) scene: Option<Option<Box<Scene>>>,
    pub(crate) parameters: Option<Vec<ParameterState>>,
    pub(crate) state: Option<Box<State>>,
    /// Signals from before the node came.
    pub(crate) past: Vec<Row>,
    pub(crate) samples: Vec<Row>,
    /// The target's time when the newest arrived [ms].
    pub(crate) heard_ms: i64,
    pub(crate) events: Vec<LoggedEvent>,
}

/// A session as one of its clients.
pub(crate) struct Station {
    /// What the robot is called, if there are several.
    pub(crate) robot: String,
    pub(crate) hello: Hello,
    socket: WebSocket<TcpStream>,
    heard: Instant,
    /// Not taken yet.
    news: News,
    /// The first state has come; what is older than this is the past [s].
    joined_s: Option<f64>,
    /// Orders given, and how many of them the last state has seen.
    given: u64,
    taken: u64,
    seat: Seat,
    /// As the station said it last.
    told: Seat,
    /// Control was asked for, and is not released by itself.
    keeps: bool,
    /// Why the station itself has refused an order.
    denied: Option<String>,
    /// What it said before it closed.
    why: Option<String>,
}

/// Joins the sessions of all robots of a station, which may be starting; `waits` is called if nobody is there yet.
///
/// # Errors
/// [`StationError`].
pub(crate) fn join(
    address: &Address,
    waits: impl FnOnce(&StationError),
) -> Result<Vec<Station>, StationError> {
    let began = Instant::now();
    let mut waits = Some(waits);
    let (key, first) = loop {
        let joined = address.key().and_then(|key| {
            let first = Station::open(address, &key, None)?;
            Ok((key, first))
        });
        let error = match joined {
            Ok(joined) => break joined,
            Err(error) => error,
        };
        // The file may be that of an earlier start, a token is not.
        let may_pass = match error {
            StationError::Nobody(..) => true,
            StationError::NoKey(..) | StationError::Refused(..) => address.query.is_empty(),
            _ => false,
        };
        if !may_pass || began.elapsed() > STARTING {
            return Err(error);
        }
        if let Some(waits) = waits.take() {
            waits(&error);
        }
        std::thread::sleep(AGAIN);
    };
    let names = first.hello.robots.clone();
    let mut all = vec![first];
    for name in names.iter().skip(1) {
        all.push(Station::open(address, &key, Some(name))?);
    }
    for (station, name) in all.iter_mut().zip(names) {
        station.robot = name;
    }
    Ok(all)
}

impl Station {
    fn open(address: &Address, key: &str, robot: Option<&str>) -> Result<Self, StationError> {
        let foreign = |why: String| StationError::Foreign(address.host.clone(), why);
        let mut socket = address.socket(key, robot)?;
        let first = socket.read().map_err(|error| foreign(error.to_string()))?;
        let first = first
            .into_text()
            .map_err(|error| foreign(error.to_string()))?;
        let hello = match serde_json::from_str(&first) {
            Ok(ToPage::Hello(hello)) => hello,
            Ok(ToPage::Error { text }) => {
                return Err(StationError::Refused(address.host.clone(), text));
            }
            Ok(_) => return Err(foreign("it says no hello".to_owned())),
            Err(error) => return Err(foreign(error.to_string())),
        };
        if hello.version != env!("CARGO_PKG_VERSION") {
            return Err(foreign(format!("it is rumbo {}", hello.version)));
        }
        let nonblocking = socket.get_ref().set_nonblocking(true);
        nonblocking.map_err(|error| foreign(error.to_string()))?;
        Ok(Self {
            robot: String::new(),
            hello,
            socket,
            heard: Instant::now(),
            news: News::default(),
            joined_s: None,
            given: 0,
            taken: 0,
            seat: Seat::Free,
            told: Seat::Free,
            keeps: false,
            denied: None,
            why: None,
        })
    }

    /// What is new since the last call, without waiting; nothing before the first state. `None` when the session is over.
    ///
    /// # Errors
    /// [`StationError`], if it did not end as it should.
    pub(crate) fn news(&mut self) -> Result<Option<News>, StationError> {
        // Pongs, and what could not be sent at once.
        if let Err(error) = self.socket.flush()
            && !is_busy(&error)
        {
            return self.over(error);
        }
        loop {
            match self.socket.read() {
                Ok(message) => {
                    self.heard = Instant::now();
                    if let Message::Text(text) = message {
                        self.take(&text)?;
                    }
                }
                Err(error) if is_busy(&error) => break,
                Err(error) => return self.over(error),
            }
        }
        if self.heard.elapsed() > SILENCE {
            return Err(StationError::Silent);
        }
        if self.joined_s.is_none() {
            return Ok(Some(News::default()));
        }
        let run = self.news.run;
        let mut news = std::mem::take(&mut self.news);
        // The board does not know of it.
        if let (Some(state), Some(why)) = (&mut news.state, &self.denied) {
            state.refused.get_or_insert_with(|| why.clone());
        }
        self.news.run = run;
        self.news.heard_ms = news.heard_ms;
        Ok(Some(news))
    }

    /// The end of the connection.
    fn over(&mut self, error: Error) -> Result<Option<News>, StationError> {
        match (self.why.take(), error) {
            (Some(why), _) => Err(StationError::Closed(why)),
            (None, Error::ConnectionClosed | Error::AlreadyClosed | Error::Protocol(_)) => Ok(None),
            // Its program has ended.
            (None, Error::Io(_)) => Ok(None),
            (None, error) => Err(StationError::Closed(error.to_string())),
        }
    }

    fn take(&mut self, text: &str) -> Result<(), StationError> {
        let message = serde_json::from_str(text)
            .map_err(|error| StationError::Foreign("the station".to_owned(), error.to_string()))?;
        match message {
            ToPage::Scene { run, scene } => {
                self.begin(run);
                self.news.scene = Some(scene);
            }
            ToPage::Parameters { parameters } => self.news.parameters = Some(parameters),
            ToPage::State { run, orders, state } => {
                if state.replay.is_some() {
                    return Err(StationError::Log);
                }
                self.begin(run);
                self.joined_s.get_or_insert(state.t_s - PAST_MS / 1e3);
                self.taken = orders;
                self.news.state = Some(state);
            }
            ToPage::Samples { run, heard, rows } => {
                self.begin(run);
                if run == self.news.run {
                    self.news.heard_ms = heard.1;
                    rows.iter().for_each(|cells| self.row(cells));
                }
            }
            ToPage::Events { events } => events.into_iter().for_each(|event| self.event(event)),
            ToPage::Control { seat } => {
                // Somebody has taken it.
                self.keeps &= (self.told, seat) != (Seat::Driver, Seat::Passenger);
                (self.seat, self.told) = (seat, seat);
            }
            ToPage::Error { text } => self.why = Some(text),
            ToPage::Hello(_) | ToPage::Other => {}
        }
        Ok(())
    }

    /// A run of this number goes on; a new one has no past.
    fn begin(&mut self, run: u32) {
        if run > self.news.run {
            if self.news.run > 0 {
                self.joined_s = self.joined_s.map(|_| f64::NEG_INFINITY);
            }
            self.news.run = run;
            self.news.past.clear();
            self.news.samples.clear();
        }
    }

    fn row(&mut self, cells: &[Value]) {
        let t_s = cells.first().and_then(Value::as_f64).unwrap_or(0.0);
        let mut row = Row::unknown((t_s * 1e3).round() as i64);
        for (name, cell) in self.hello.columns.iter().zip(cells) {
            match (cell.as_f64(), cell.is_string()) {
                (Some(value), _) => row.set(name, value),
                // A range with nothing in it.
                (None, true) => row.set(name, f64::INFINITY),
                (None, false) => {}
            }
        }
        match self.joined_s {
            Some(joined_s) if t_s < joined_s => self.news.past.push(row),
            _ => self.news.samples.push(row),
        }
    }

    fn event(&mut self, event: LoggedEvent) {
        if [WATCHING, NOT_DRIVING].contains(&event.text.as_str()) {
            self.denied = Some(event.text.clone());
        }
        if self.joined_s.is_some_and(|joined_s| event.t_s >= joined_s) {
            self.news.events.push(event);
        }
    }

    /// Gives an order, as a page does: STOP always, anything else if it has control or nobody else has. Returns its
    /// number.
    ///
    /// # Errors
    /// Why it was not passed on, for a person.
    pub(crate) fn order(&mut self, order: Order) -> Result<u64, String> {
        if let Some(why) = self.seat.refuses(&order) {
            return Err(why.to_owned());
        }
        let text = serde_json::to_string(&order).map_err(|error| error.to_string())?;
        match self.socket.send(Message::text(text)) {
            Err(error) if !is_busy(&error) => return Err("refused: the session is over".to_owned()),
            _ => {}
        }
        match order {
            Order::Stop => {}
            Order::ReleaseControl => (self.seat, self.keeps) = (Seat::Free, false),
            Order::TakeControl => (self.seat, self.keeps) = (Seat::Driver, true),
            _ => self.seat = Seat::Driver,
        }
        self.given += 1;
        Ok(self.given)
    }

    /// Whether the last state is from after the session has taken the order of this number.
    pub(crate) fn has_taken(&self, order: u64) -> bool {
        self.taken >= order
    }

    /// Releases the control that an order has taken, when nothing `needs` it.
    pub(crate) fn release(&mut self, needs: bool) {
        if needs {
            return;
        }
        self.denied = None;
        if self.seat == Seat::Driver && !self.keeps {
            // Releasing is never refused.
            let _ = self.order(Order::ReleaseControl);
        }
    }

    /// The node's relation to control.
    pub(crate) fn seat(&self) -> Seat {
        self.seat
    }

    /// Says good-bye, and waits a moment for what is on its way.
    pub(crate) fn leave(mut self) {
        let _ = self.socket.get_ref().set_nonblocking(false);
        let _ = self.socket.close(None);
        while self.socket.read().is_ok() {}
    }
}

/// Nothing has gone wrong: there is nothing to read, or no room to write.
fn is_busy(error: &Error) -> bool {
    matches!(error, Error::Io(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut))
}
