//! What JavaScript sees of it.

use crate::lab::Lab as Inner;
use crate::robot::Robot as Real;
use crate::showing::Showing;
use crate::start::Start;
use rumbo_flash::{PortAction, Programmer};
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn now_ms() -> f64;

    #[wasm_bindgen(js_namespace = Date, js_name = now)]
    fn day_ms() -> f64;

    #[wasm_bindgen(js_namespace = console)]
    fn error(text: &str);

    #[wasm_bindgen(js_namespace = crypto, js_name = getRandomValues)]
    fn fill_randomly(bytes: &mut [u8]);
}

fn wall_us() -> u64 {
    (now_ms() * 1e3) as u64
}

fn random_id() -> u8 {
    let mut id = [0];
    fill_randomly(&mut id);
    id[0]
}

/// A panic says why on the console before it ends the worker.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| error(&panic.to_string())));
}

/// The lab of one page.
#[wasm_bindgen]
pub struct Lab(Inner);

#[wasm_bindgen]
impl Lab {
    /// The robot at its start, in real time; `start` is a [`Start`] as JSON.
    #[wasm_bindgen(constructor)]
    pub fn new(start: &str) -> Result<Lab, String> {
        let start: Start = serde_json::from_str(start).map_err(|error| error.to_string())?;
        let lab = Inner::new(start, day_ms());
        lab.map(Lab).map_err(|error| error.to_string())
    }

    /// The version of Rumbo.
    #[wasm_bindgen(getter)]
    pub fn version(&self) -> String {
        env!("CARGO_PKG_VERSION").into()
    }

    /// When the run began \[ms since 1970\].
    #[wasm_bindgen(getter)]
    pub fn began_ms(&mut self) -> f64 {
        self.0.began_ms()
    }

    /// The run so far as a log, which began at `started`, the time in UTC as `2026-11-23T22:40:03Z`.
    pub fn log(&mut self, started: String) -> Result<LogFile, String> {
        let (name, bytes) = self.0.log(started).map_err(|error| error.to_string())?;
        Ok(LogFile { name, bytes })
    }

    /// The run so far for a link: a [`Shared`](crate::Shared) as JSON.
    pub fn share(&mut self) -> Result<String, String> {
        serde_json::to_string(&self.0.share()).map_err(|error| error.to_string())
    }

    /// What explains a stretch \[s\] of what the page sees, as JSON.
    pub fn explain(&mut self, from_s: f64, to_s: f64) -> Result<String, String> {
        serde_json::to_string(&self.0.explain(from_s, to_s)).map_err(|error| error.to_string())
    }

    /// Shows a recording in place of the lab, which waits.
    pub fn show(&mut self, recording: Recording) {
        self.0.show(Some(recording.0));
    }

    /// Shows the lab again.
    pub fn resume(&mut self) {
        self.0.show(None);
    }

    /// Makes the page that of another robot in the world.
    pub fn select(&mut self, robot: usize) {
        self.0.select(robot);
    }

    /// Warns the page.
    pub fn warn(&mut self, text: String) {
        self.0.warn(text);
    }

    /// Takes an order, as JSON.
    pub fn order(&mut self, json: &str) {
        self.0.order(json);
    }

    /// One round, of 20 ms at most.
    pub fn advance(&mut self) -> Result<(), String> {
        let done = self.0.advance(wall_us, day_ms());
        done.map_err(|error| error.to_string())
    }

    /// The messages that are new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        self.0.news()
    }
}

/// A real robot at a serial port.
#[wasm_bindgen]
pub struct Robot(Real);

#[wasm_bindgen]
impl Robot {
    /// A session with the robot at the port of this name. With `text` it runs the original program.
    #[wasm_bindgen(constructor)]
    pub fn new(port: String, baud: u32, text: bool) -> Result<Robot, String> {
        let robot = Real::new(port, baud, text, random_id, wall_us(), day_ms());
        robot.map(Robot).map_err(|error| error.to_string())
    }

    /// These bytes arrived.
    pub fn arrived(&mut self, bytes: &[u8]) {
        self.0.arrived(bytes);
    }

    /// The bytes to send since the last call.
    pub fn take_outgoing(&mut self) -> Vec<u8> {
        self.0.take_outgoing()
    }

    /// The port is gone, and why.
    pub fn lost(&mut self, why: &str) {
        self.0.lost(why);
    }

    /// It is open again, or another one of this name is in its place.
    pub fn back(&mut self, name: &str) {
        self.0.back(name);
    }

    /// Takes an order, as JSON.
    pub fn order(&mut self, json: &str) {
        self.0.order(json);
    }

    /// Warns the page.
    pub fn warn(&mut self, text: String) {
        self.0.warn(text);
    }

    /// One round.
    pub fn advance(&mut self) -> Result<(), String> {
        let done = self.0.advance(wall_us, day_ms());
        done.map_err(|error| error.to_string())
    }

    /// The messages that are new to the page, as JSON.
    pub fn news(&mut self) -> Vec<String> {
        self.0.news()
    }

    /// When the session began \[ms since 1970\].
    #[wasm_bindgen(getter)]
    pub fn began_ms(&mut self) -> f64 {
        self.0.began_ms()
    }

    /// Begins to write the session so far as a log, which began at `started`, the time in UTC.
    pub fn save(&mut self, started: String) -> Result<(), String> {
        self.0.save(started).map_err(|error| error.to_string())
    }

    /// Goes on writing for a few milliseconds; the log, once it is complete.
    pub fn saved(&mut self) -> Result<Option<LogFile>, String> {
        let saved = self.0.saved(wall_us).map_err(|error| error.to_string())?;
        Ok(saved.map(|(name, bytes)| LogFile { name, bytes }))
    }
}

/// A recording to be shown. It is read apart from the lab, which goes on when the memory does not suffice.
#[wasm_bindgen]
pub struct Recording(Showing);

#[wasm_bindgen]
impl Recording {
    /// Reads a file of this name.
    #[wasm_bindgen(constructor)]
    pub fn new(file: &str, bytes: Vec<u8>) -> Result<Recording, String> {
        Showing::new(file, bytes).map(Recording)
    }
}

/// Writes a program to an Arduino Mega at a serial port.
#[wasm_bindgen]
pub struct Flasher(Programmer);

/// What is to be done with the port; nothing of it: to wait for bytes, or some milliseconds.
#[wasm_bindgen(getter_with_clone)]
pub struct Turn {
    /// Pull DTR and RTS, or release them.
    pub lines: Option<bool>,
    /// Send these bytes.
    pub send: Option<Vec<u8>>,
    /// All is done.
    pub done: bool,
}

#[wasm_bindgen]
impl Flasher {
    /// The program in a file of this name.
    #[wasm_bindgen(constructor)]
    pub fn new(file: &str, content: &[u8]) -> Result<Flasher, String> {
        crate::programmer(file, content).map(Flasher)
    }

    /// These bytes arrived.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.0.receive(bytes);
    }

    /// What to do now.
    pub fn poll(&mut self) -> Result<Turn, String> {
        let action = self.0.poll(wall_us()).map_err(|error| error.to_string())?;
        let done = action == PortAction::Done;
        let (lines, send) = match action {
            PortAction::Lines(pulled) => (Some(pulled), None),
            PortAction::Send(bytes) => (None, Some(bytes)),
            PortAction::Wait | PortAction::Done => (None, None),
        };
        Ok(Turn { lines, send, done })
    }

    /// What is going on, in a word or two.
    #[wasm_bindgen(getter)]
    pub fn phase(&self) -> String {
        self.0.progress().0.to_string()
    }

    /// Which part of all is done, 0 to 1.
    #[wasm_bindgen(getter)]
    pub fn part(&self) -> f64 {
        self.0.progress().1
    }

    /// What an end now leaves behind.
    #[wasm_bindgen(getter)]
    pub fn aftermath(&self) -> String {
        self.0.aftermath().into()
    }
}

/// A log to be saved.
#[wasm_bindgen(getter_with_clone)]
pub struct LogFile {
    /// The name of a file for it.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The hash of a headless run as 16 hexadecimal digits: of a [`Start`] as JSON, by the native program, or by an image if
/// it is not empty.
#[wasm_bindgen]
pub fn run_hash(start: &str, image: &[u8]) -> Result<String, String> {
    let start: Start = serde_json::from_str(start).map_err(|error| error.to_string())?;
    let image = (!image.is_empty()).then_some(("image", image));
    let hash = start
        .setup()
        .and_then(|setup| rumbo_lab::run_hash(setup, start.seed, image));
    hash.map(|hash| format!("{hash:016x}"))
        .map_err(|error| error.to_string())
}

/// The names of the scenarios, in order.
#[wasm_bindgen]
pub fn scenarios() -> Vec<String> {
    use rumbo_experiment::files::{Kind, Library};
    Library::new().list(Kind::Scenario)
}
