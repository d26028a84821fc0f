//! A robot behind a serial port that the page was granted: bytes in, bytes out.
//!
//! The worker moves the bytes and opens the port again when it is gone ([`crate::Robot`]). Bytes to be sent meanwhile
//! are dropped, so that no old command takes effect afterwards. The robot has stopped by then, for lack of a heartbeat,
//! and nothing here arms it.

use rumbo_log::{LogKind, Manifest};
use rumbo_session::{LinkNews, Target, TargetError};
use std::collections::VecDeque;

/// Most bytes that wait for the session: a flood beyond them is lost, as in a port's own buffer.
const WAITING: usize = 1 << 20;

/// The port with the robot.
#[derive(Debug)]
pub(crate) struct SerialPort {
    /// What a person calls it.
    name: String,
    baud: u32,
    /// By the wall clock, since the session began.
    now_us: u64,
    incoming: Vec<u8>,
    outgoing: Vec<u8>,
    gone: bool,
    news: VecDeque<LinkNews>,
}

impl SerialPort {
    pub(crate) fn new(name: String, baud: u32) -> Self {
        Self {
            name,
            baud,
            now_us: 0,
            incoming: Vec::new(),
            outgoing: Vec::new(),
            gone: false,
            news: VecDeque::new(),
        }
    }

    /// Time since the session began \[us\]; it never goes back.
    pub(crate) fn set_now(&mut self, now_us: u64) {
        self.now_us = self.now_us.max(now_us);
    }

    /// These bytes arrived.
    pub(crate) fn arrived(&mut self, bytes: &[u8]) {
        let room = WAITING - self.incoming.len();
        self.incoming
            .extend_from_slice(&bytes[..bytes.len().min(room)]);
    }

    /// The bytes to be sent since the last call.
    pub(crate) fn take_outgoing(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.outgoing)
    }

    /// The port is gone, and why.
    pub(crate) fn lost(&mut self, why: &str) {
        self.outgoing.clear();
        if !std::mem::replace(&mut self.gone, true) {
            self.news.push_back(LinkNews::Lost(format!(
                "port {} is gone ({why}); waiting for it",
                self.name
            )));
        }
    }

    /// It is open again, or another one of this name is in its place.
    pub(crate) fn back(&mut self, name: &str) {
        if std::mem::take(&mut self.gone) {
            self.name = name.into();
            let text = format!("port {} is back", self.name);
            self.news.push_back(LinkNews::Back(text));
        }
    }
}

impl Target for SerialPort {
    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn advance(&mut self, _dt_us: u64) -> Result<(), TargetError> {
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        if !self.gone {
            self.outgoing.extend_from_slice(bytes);
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        into.append(&mut self.incoming);
    }

    fn baud(&self) -> u32 {
        self.baud
    }

    fn manifest(&self) -> Manifest {
        Manifest {
            kind: LogKind::Robot,
            program: "unknown".into(),
            port: Some(self.name.clone()),
            ..Manifest::default()
        }
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.news.pop_front()
    }
}
