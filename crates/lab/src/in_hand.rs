//! The program of the lab's robot in the hands of a debugger.
//!
//! The session's time is the furthest that the program has come: it stands while the program stands, and while the program
//! is in its past. What it does again there, up to where it was, the session knows already.

use crate::live::{LINK, Live};
use crate::sight;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_log::{HeldState, Truth};
use rumbo_session::{Shown, TargetError};
use rumbo_sim::Sim;
use serde_json::Value;

/// A debugger with the simulation that it holds.
pub trait Holder: Send {
    /// The simulation, where the program is, until it lets go of it.
    fn live(&self) -> Option<&Live>;

    /// Acts on it: what was ahead is another future.
    fn change(&mut self, act: &mut dyn FnMut(&mut Live));

    /// The program runs.
    fn is_running(&self) -> bool;

    /// Lets it run for a slice of time, or until it stands.
    fn turn(&mut self);

    /// Takes a request of the Debug Adapter Protocol.
    ///
    /// # Errors
    /// It is none.
    fn ask(&mut self, request: &Value) -> Result<(), String>;

    /// Drains the responses and events.
    fn take_messages(&mut self) -> Vec<Value>;

    /// Drains what the program has sent, by stream, each byte once.
    fn take_output(&mut self) -> Vec<(u8, Vec<u8>)>;
}

/// Gives a simulation at its start to a debugger.
pub type Attach = Box<dyn FnOnce(Live) -> Box<dyn Holder> + Send>;

/// What a page may ask of a debugger: nothing that starts another program, or takes the session's time to look for.
const ALLOWED: [&str; 14] = [
    "setBreakpoints",
    "configurationDone",
    "threads",
    "stackTrace",
    "scopes",
    "variables",
    "evaluate",
    "setVariable",
    "continue",
    "pause",
    "next",
    "stepIn",
    "stepOut",
    "stepBack",
];

/// A debugger, and what the session knows of its program.
pub(crate) struct InHand {
    holder: Box<dyn Holder>,
    /// The session's time \[us\], and the robot then.
    reached_us: u64,
    truth: Truth,
    consoles: Vec<(u8, Vec<u8>)>,
    link: Vec<u8>,
    /// Up to which reading the session has them \[us\].
    read_us: u64,
}

impl InHand {
    pub(crate) fn new(attach: Attach, sim: Sim) -> Option<Self> {
        let (reached_us, truth) = (sim.now_us(), sight::truth(&sim));
        Some(Self {
            holder: attach(Live::of(sim)?),
            reached_us,
            truth,
            consoles: Vec::new(),
            link: Vec::new(),
            read_us: 0,
        })
    }

    /// The simulation, where the program is.
    pub(crate) fn sim(&self) -> Option<&Sim> {
        self.holder.live().map(Live::sim)
    }

    /// Acts on it.
    pub(crate) fn act<T>(&mut self, act: impl FnOnce(&mut Sim) -> T) -> Option<T> {
        let (mut act, mut done) = (Some(act), None);
        self.holder
            .change(&mut |live| done = act.take().map(|act| act(live.sim_mut())));
        done
    }

    /// A slice of time passes, if the program runs.
    pub(crate) fn pass(&mut self) {
        if self.holder.is_running() {
            self.holder.turn();
            self.follow();
        }
    }

    /// A request of a page.
    pub(crate) fn ask(&mut self, request: &Value) -> Result<(), TargetError> {
        let command = request["command"].as_str().unwrap_or_default();
        if !ALLOWED.contains(&command) {
            return Err(TargetError::NotDebugged);
        }
        self.holder.ask(request).map_err(TargetError::Setup)?;
        self.follow();
        Ok(())
    }

    /// Takes what the program has sent, and the robot's pose if it is further than ever.
    fn follow(&mut self) {
        for (stream, bytes) in self.holder.take_output() {
            match stream {
                LINK => self.link.extend(bytes),
                usart => self.consoles.push((usart, bytes)),
            }
        }
        if let Some(sim) = self.holder.live().map(Live::sim)
            && sim.now_us() >= self.reached_us
        {
            (self.reached_us, self.truth) = (sim.now_us(), sight::truth(sim));
        }
    }

    pub(crate) fn take_messages(&mut self) -> Vec<Value> {
        self.holder.take_messages()
    }

    pub(crate) fn take_consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        std::mem::take(&mut self.consoles)
    }

    pub(crate) fn receive(&mut self, into: &mut Vec<u8>) {
        into.append(&mut self.link);
    }

    /// The next reading of its instruments, if there is one that the session does not have.
    pub(crate) fn take_shown(&mut self) -> Option<Shown> {
        let live = self.holder.live()?;
        let (shown, due_us) = live.shown();
        let is_new = due_us > self.read_us && live.now_us() >= self.reached_us;
        let shown = shown.filter(|_| is_new).cloned();
        self.read_us = self.read_us.max(due_us);
        shown
    }

    pub(crate) fn reached_us(&self) -> u64 {
        self.reached_us
    }

    pub(crate) fn truth(&self) -> Truth {
        self.truth
    }

    /// For the page.
    pub(crate) fn state(&self) -> HeldState {
        let t_us = self.sim().map_or(self.reached_us, Sim::now_us);
        HeldState {
            stands: !self.holder.is_running(),
            t_us,
            back_us: self.reached_us.saturating_sub(t_us),
        }
    }
}
