//! A session and the one page that it has: orders in, messages out, and the recording of the run.

use crate::drive::Change;
use crate::recording::{ROOM, Recording};
use rumbo_log::{Level, LoggedEvent, Manifest};
use rumbo_session::explain::{Cause, explain_news};
use rumbo_session::{
    Board, ControlView, Cursor, Event, Extras, Host, Lease, Order, PageId, SessionDriver, Target,
    ToPage,
};
use rumbo_wire::Command;
use std::rc::Rc;

/// Longest time spent on one round of slices, so that orders do not wait \[us\].
pub(crate) const ROUND_US: u64 = 20_000;
/// Orders that wait for a round; a page that gives more at once has gone wrong.
const WAITING: usize = 1_000;

/// What the driver passes events to.
pub(crate) struct Page {
    board: Board,
    /// Time of day \[ms since 1970\].
    pub(crate) day_ms: f64,
    pub(crate) recording: Option<Recording>,
    /// The commands given by hand in this run, and why a link cannot repeat it.
    pub(crate) changes: Vec<Change>,
    pub(crate) unlike: Option<&'static str>,
    /// The recording has just run out of room.
    pub(crate) full: bool,
    /// Room for a recording \[bytes\].
    room: usize,
    /// Numbers of sessions.
    ids: fn() -> u8,
}

impl Host for Page {
    fn random_id(&mut self) -> u8 {
        (self.ids)()
    }

    fn publish(&mut self, event: Event) {
        self.board.take(&event, self.day_ms);
        match event {
            Event::Entry(entry) => {
                if let Some(recording) = &mut self.recording {
                    self.full |= !recording.keep(&entry);
                }
            }
            Event::Commanded(t_us, commands) => self.changes.push(Change { t_us, commands }),
            _ => {}
        }
    }

    /// The recording of the run before is gone.
    fn begin_run(&mut self, manifest: Manifest) -> Option<(Level, String)> {
        self.changes.clear();
        self.unlike = match (&manifest.image, &manifest.eeprom) {
            (Some(_), _) => Some("a program of your own is not in a link"),
            (_, Some(_)) => Some("the robot began with parameters that are saved on it"),
            _ => None,
        };
        self.recording = Some(Recording::new(manifest, self.day_ms, self.room));
        None
    }
}

/// The first message to a session's page: the robots in its world, if there are several, and which one is its own.
#[derive(Clone, Debug, Default)]
pub(crate) struct Place {
    pub(crate) robots: Rc<[String]>,
    pub(crate) own: usize,
}

/// A session with its page.
pub(crate) struct Desk<T: Target + ?Sized> {
    pub(crate) driver: SessionDriver<Page, T>,
    place: Place,
    /// Orders since the last round.
    waiting: Vec<Order>,
    lease: Lease,
    page: PageId,
    cursor: Cursor,
    /// The page has had its first message.
    greeted: bool,
    seat: Option<ControlView>,
    /// Warnings for the page.
    warnings: Vec<String>,
}

impl<T: Target + ?Sized> Desk<T> {
    /// A session in real time that has begun; `day_ms` is the time of day \[ms since 1970\], `wall_us` the wall clock,
    /// and `ids` gives the numbers of its sessions with the robot.
    pub(crate) fn new(
        target: Box<T>,
        place: Place,
        extras: Extras,
        ids: fn() -> u8,
        wall_us: u64,
        day_ms: f64,
    ) -> Self {
        let page = Page {
            board: Board::default(),
            day_ms,
            recording: None,
            changes: Vec::new(),
            unlike: None,
            full: false,
            room: ROOM / place.robots.len().max(1),
            ids,
        };
        let mut driver = SessionDriver::new(target, page, 1.0, extras);
        driver.begin(wall_us);
        let mut lease = Lease::default();
        Self {
            driver,
            place,
            waiting: Vec::new(),
            // The first page is always admitted.
            page: lease.join(true).unwrap_or_default(),
            lease,
            cursor: Cursor::default(),
            greeted: false,
            seat: None,
            warnings: Vec::new(),
        }
    }

    /// Takes an order of the page, to be executed in the next round; what is refused is reported with the next news.
    pub(crate) fn order(&mut self, json: &str) {
        let admitted = json.parse::<Order>().map_err(|error| error.to_string());
        let admitted = admitted.and_then(|order| {
            self.lease.admit(&order, self.page)?;
            match self.waiting.len() < WAITING || order == Order::Robot(Command::Stop) {
                true => Ok(order),
                false => Err("too many orders at once".into()),
            }
        });
        match admitted {
            Ok(order) => self.waiting.push(order),
            Err(why) => self.warn(why),
        }
    }

    /// The orders since the last round.
    pub(crate) fn take_orders(&mut self) -> Vec<Order> {
        std::mem::take(&mut self.waiting)
    }

    /// To the page it is a new connection; its orders so far are dropped.
    pub(crate) fn begin_again(&mut self) {
        self.waiting.clear();
        self.cursor = Cursor::default();
        self.greeted = false;
        self.seat = None;
    }

    /// Warns the page, with the next news.
    pub(crate) fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    /// The recording of the run.
    pub(crate) fn recording(&mut self) -> Option<&Recording> {
        self.driver.host().recording.as_ref()
    }

    /// What explains a stretch \[s\] of what the page sees.
    pub(crate) fn explain(&mut self, shown: Option<&Board>, from_s: f64, to_s: f64) -> Vec<Cause> {
        let board = shown.unwrap_or(&self.driver.host().board);
        explain_news(&board.news(&mut Cursor::default()), from_s, to_s)
    }

    /// What is new to the page, as JSON; `shown` is a recording's board that it reads of instead.
    pub(crate) fn news(&mut self, shown: Option<&Board>) -> Vec<String> {
        let mut messages = Vec::new();
        if !std::mem::replace(&mut self.greeted, true) {
            messages.extend(ToPage::hello(&self.place.robots, self.place.own).json());
        }
        let view = self.lease.view(self.page);
        if self.seat.replace(view) != Some(view) {
            messages.extend(ToPage::Control(view).json());
        }
        let board = shown.unwrap_or(&self.driver.host().board);
        let mut news = board.news(&mut self.cursor);
        let t_s = news.state.as_ref().map_or(0.0, |state| state.t_s);
        let refused = self.warnings.drain(..).map(|text| LoggedEvent {
            t_s,
            level: Level::Warning,
            text,
        });
        news.events.extend(refused);
        messages.extend(news.messages().filter_map(|message| message.json()));
        messages
    }
}
