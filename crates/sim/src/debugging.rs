//! A debugger that attaches to a running simulation and may detach again: robot and world are frozen while it holds the
//! program. For the lab, which advances the simulation in slices of time.

use crate::emulated::Emulated;
use crate::sim::Sim;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::gdb::{GdbSession, Machine, Progress};
use std::io;
use std::net::{Ipv4Addr, TcpListener};

/// The longest time for which the program runs before the debugger is polled [us].
const TURN_US: u64 = 1_000;

/// A port to which a debugger may connect, and the session of the one that has.
pub struct Debugging {
    listener: TcpListener,
    session: Option<GdbSession<Held>>,
    /// When it was last announced that the program is halted [us]; `None` while it runs.
    stands: Option<u64>,
    news: Vec<String>,
}

impl Debugging {
    /// Listens on this port of 127.0.0.1; 0 takes any free one.
    ///
    /// # Errors
    /// The port is taken, or needs more rights.
    pub fn at(port: u16) -> io::Result<Debugging> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        Ok(Debugging {
            listener,
            session: None,
            stands: None,
            news: Vec::new(),
        })
    }

    /// The port.
    ///
    /// # Errors
    /// The operating system does not report it.
    pub fn port(&self) -> io::Result<u16> {
        Ok(self.listener.local_addr()?.port())
    }

    /// Drains the messages about debugger and program.
    pub fn take_news(&mut self) -> Vec<String> {
        std::mem::take(&mut self.news)
    }

    /// Another simulation replaces the one being debugged: the debugger's connection ends.
    pub fn forget(&mut self) {
        if self.session.take().is_some() {
            self.stands = None;
            self.news.push("the debugger is gone with the run".into());
        }
    }

    /// Advances a simulation to this time [us], or as far as the debugger allows.
    pub fn advance(&mut self, sim: &mut Sim, until_us: u64) {
        self.welcome(sim);
        let Some(session) = &mut self.session else {
            sim.advance(until_us);
            return;
        };
        session.machine_mut().until_us = until_us;
        std::mem::swap(sim, session.machine_mut().world.sim_mut());
        let mut progress = Progress::Ran;
        while progress == Progress::Ran && session.machine_mut().world.sim().now_us() < until_us {
            progress = session.turn();
        }
        std::mem::swap(sim, session.machine_mut().world.sim_mut());
        self.announce(progress, sim);
    }

    fn announce(&mut self, progress: Progress, sim: &Sim) {
        let now_us = sim.now_us();
        match progress {
            // Only halts some time apart, not every single step.
            Progress::Stands
                if self
                    .stands
                    .is_none_or(|last_us| now_us >= last_us + TURN_US) =>
            {
                self.stands = Some(now_us);
                let place = place(sim);
                self.news
                    .push(format!("the program stands at {place}, and time with it"));
            }
            Progress::Ran if self.stands.take().is_some() => {
                self.news.push("the program goes on".into());
            }
            Progress::Gone => {
                self.session = None;
                self.stands = None;
                self.news
                    .push("the debugger has left; the program goes on".into());
            }
            Progress::Stands | Progress::Ran => {}
        }
    }

    /// Attaches a debugger that connects, if the simulation has an emulated Mega.
    fn welcome(&mut self, sim: &Sim) {
        if self.session.is_some() || sim.mega().is_none() {
            return;
        }
        let Ok((connection, _)) = self.listener.accept() else {
            return;
        };
        let Some(world) = Emulated::of(sim.clone()) else {
            return;
        };
        let held = Held { world, until_us: 0 };
        let session = connection
            .set_nonblocking(false)
            .and_then(|()| GdbSession::new(held, connection));
        match session {
            Ok(session) => {
                self.session = Some(session);
                self.news.push("a debugger has come".into());
            }
            Err(error) => self.news.push(error.to_string()),
        }
    }
}

/// Where the program is halted, for people.
fn place(sim: &Sim) -> String {
    sim.mega().map_or_else(String::new, |mega| {
        let word = mega.chip().cpu().program_counter();
        mega.firmware().image().place(word)
    })
}

/// A simulation in the hands of a debugger. Between its turns it is a stand-in: the real one is with its owner.
struct Held {
    world: Emulated,
    /// The owner's time goes up to here [us].
    until_us: u64,
}

impl Machine for Held {
    fn chip(&self) -> &Chip {
        self.world.chip()
    }

    fn chip_mut(&mut self) -> &mut Chip {
        self.world.mega_mut().chip_mut()
    }

    fn go(&mut self) -> Stopped {
        let now_us = self.world.sim().now_us();
        // An instruction may lie across the end.
        let until_us = self.until_us.max(now_us + 1);
        self.world.advance(until_us.min(now_us + TURN_US))
    }

    fn step(&mut self) -> Stopped {
        self.world.mega_mut().step();
        self.go()
    }
}
