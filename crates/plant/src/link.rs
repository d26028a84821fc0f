//! One direction of a serial link, in simulated time: a pipe of bytes with a baud rate, a delay and faults.
//!
//! Bytes leave one after another, ten bits each (8N1), and arrive after the latency. Each byte may be lost, changed
//! or doubled, by a draw that depends on its number only; in a silence everything that would arrive is lost.

use std::collections::VecDeque;

use crate::noise::{Noise, source};

/// The properties of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkParams {
    /// Bits per second; a byte takes ten.
    pub baud: u32,
    /// From the last bit sent to the byte received.
    pub latency_us: u64,
    /// Share of bytes that vanish.
    pub loss_rate: f64,
    /// Share of bytes that arrive with one bit inverted.
    pub corruption_rate: f64,
    /// Share of bytes that arrive twice.
    pub duplication_rate: f64,
    /// Intervals `[from, until)` of simulated time in which nothing arrives.
    pub silences_us: Vec<(u64, u64)>,
}

impl Default for LinkParams {
    /// A clean Bluetooth module at 9600 baud, 8 ms away.
    fn default() -> Self {
        Self {
            baud: 9600,
            latency_us: 8_000,
            loss_rate: 0.0,
            corruption_rate: 0.0,
            duplication_rate: 0.0,
            silences_us: Vec::new(),
        }
    }
}

/// Which way the bytes go; each way has its own faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkDirection {
    /// From the station to the robot.
    ToRobot,
    /// From the robot to the station.
    ToStation,
}

/// One direction of a link with the bytes under way.
#[derive(Clone, Debug)]
pub struct Link {
    params: LinkParams,
    noise: Noise,
    source: u32,
    byte_ns: u64,
    line_free_ns: u64,
    sent: u64,
    under_way: VecDeque<(u64, u8)>,
}

impl Link {
    /// An idle link; its faults follow from the noise.
    #[must_use]
    pub fn new(params: LinkParams, noise: Noise, direction: LinkDirection) -> Self {
        let byte_ns = 10_000_000_000 / u64::from(params.baud.max(1));
        let source = source::LINK
            + match direction {
                LinkDirection::ToRobot => 0,
                LinkDirection::ToStation => 10,
            };
        Self {
            params,
            noise,
            source,
            byte_ns,
            line_free_ns: 0,
            sent: 0,
            under_way: VecDeque::new(),
        }
    }

    /// Queues bytes behind those that still wait; the line takes as long as its baud rate says.
    pub fn send(&mut self, now_us: u64, bytes: &[u8]) {
        self.send_before(now_us, u64::MAX, bytes.iter().copied());
    }

    /// Sends what comes while the line is free before `end_us`.
    #[inline]
    pub fn send_before(&mut self, now_us: u64, end_us: u64, mut bytes: impl Iterator<Item = u8>) {
        let mut free_us = self.line_free_us();
        while free_us < end_us
            && let Some(byte) = bytes.next()
        {
            self.line_free_ns = self.line_free_ns.max(now_us * 1000) + self.byte_ns;
            free_us = self.line_free_us();
            let index = self.sent;
            self.sent += 1;
            self.deliver(index, free_us + self.params.latency_us, byte);
        }
    }

    #[inline]
    fn deliver(&mut self, index: u64, at_us: u64, byte: u8) {
        let chance = |fault: u32, rate| self.noise.chance(self.source + fault, index, rate);
        let silent = self
            .params
            .silences_us
            .iter()
            .any(|&(from, until)| (from..until).contains(&at_us));
        if silent || chance(0, self.params.loss_rate) {
            return;
        }
        let byte = if chance(1, self.params.corruption_rate) {
            byte ^ (1 << (self.noise.bits(self.source + 3, index) >> 61))
        } else {
            byte
        };
        let copies = if chance(2, self.params.duplication_rate) {
            2
        } else {
            1
        };
        for _ in 0..copies {
            self.under_way.push_back((at_us, byte));
        }
    }

    /// Appends to `into` every byte that has arrived by now.
    pub fn receive(&mut self, now_us: u64, into: &mut Vec<u8>) {
        let waiting = self.under_way.iter();
        let arrived = waiting.take_while(|(at_us, _)| *at_us <= now_us).count();
        if arrived > 0 {
            into.extend(self.under_way.range(..arrived).map(|(_, byte)| *byte));
            self.under_way.drain(..arrived);
        }
    }

    /// The next byte that has arrived by now, with its time of arrival.
    pub fn pop(&mut self, now_us: u64) -> Option<(u64, u8)> {
        if self.next_arrival_us()? <= now_us {
            self.under_way.pop_front()
        } else {
            None
        }
    }

    /// When the next byte arrives, `None` if none is under way.
    #[must_use]
    pub fn next_arrival_us(&self) -> Option<u64> {
        self.under_way.front().map(|&(at_us, _)| at_us)
    }

    /// When the line has sent all it was given: a byte sent now starts then, or at once if that is past.
    #[must_use]
    pub const fn line_free_us(&self) -> u64 {
        self.line_free_ns.div_ceil(1000)
    }

    /// What it does to the bytes.
    #[must_use]
    pub const fn params(&self) -> &LinkParams {
        &self.params
    }

    /// Changes the faults, for instance to cut the link while it runs. Bytes under way are not touched; the baud rate
    /// stays.
    pub fn set_faults(&mut self, params: LinkParams) {
        self.params = LinkParams {
            baud: self.params.baud,
            ..params
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(params: LinkParams) -> Link {
        Link::new(params, Noise::new(1, 0), LinkDirection::ToStation)
    }

    fn received(link: &mut Link, now_us: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        link.receive(now_us, &mut bytes);
        bytes
    }

    #[test]
    fn at_9600_baud_960_bytes_arrive_per_second() {
        let mut link = link(LinkParams {
            latency_us: 0,
            ..LinkParams::default()
        });
        link.send(0, &[0x55; 2_000]);
        assert_eq!(received(&mut link, 1_000_000).len(), 960);
        assert_eq!(received(&mut link, 2_000_000).len(), 960);
    }

    #[test]
    fn a_byte_arrives_after_its_ten_bits_and_the_latency() {
        let mut link = link(LinkParams::default());
        link.send(5_000, b"a");
        assert_eq!(link.next_arrival_us(), Some(5_000 + 1_042 + 8_000));
        assert_eq!(link.pop(14_041), None);
        assert_eq!(link.pop(14_042), Some((14_042, b'a')));
        assert_eq!(link.pop(20_000), None);
    }

    #[test]
    fn an_idle_line_owes_nothing_for_the_past() {
        let mut link = link(LinkParams::default());
        link.send(0, b"a");
        link.send(1_000_000, b"b");
        assert_eq!(received(&mut link, 1_009_041), b"a");
        assert_eq!(received(&mut link, 1_009_042), b"b");
    }

    #[test]
    fn faults_come_at_their_rates_and_repeat_with_the_seed() {
        let params = LinkParams {
            loss_rate: 0.1,
            corruption_rate: 0.05,
            duplication_rate: 0.02,
            ..LinkParams::default()
        };
        let run = || {
            let mut link = link(params.clone());
            link.send(0, &[0; 20_000]);
            received(&mut link, u64::MAX)
        };
        let bytes = run();
        assert_eq!(bytes, run());
        let expected = 20_000.0 * 0.9 * 1.02;
        assert!(
            (bytes.len() as f64 - expected).abs() < 200.0,
            "{}",
            bytes.len()
        );
        let changed = bytes.iter().filter(|byte| byte.count_ones() == 1).count() as f64;
        assert!(
            (changed / bytes.len() as f64 - 0.05).abs() < 0.006,
            "{changed}"
        );
    }

    #[test]
    fn nothing_arrives_in_a_silence() {
        let mut link = link(LinkParams {
            latency_us: 0,
            silences_us: vec![(500_000, 700_000)],
            ..LinkParams::default()
        });
        link.send(0, &[1; 960]);
        let mut arrivals = Vec::new();
        while let Some((at_us, _)) = link.pop(u64::MAX) {
            arrivals.push(at_us);
        }
        assert!(
            arrivals
                .iter()
                .all(|at_us| !(500_000..700_000).contains(at_us))
        );
        assert_eq!(arrivals.len(), 960 - 192);
    }

    #[test]
    fn each_direction_has_faults_of_its_own() {
        let arrived = |direction| {
            let params = LinkParams {
                loss_rate: 0.5,
                ..LinkParams::default()
            };
            let mut link = Link::new(params, Noise::new(1, 0), direction);
            link.send(0, &(0..64).collect::<Vec<u8>>());
            received(&mut link, u64::MAX)
        };
        assert_ne!(
            arrived(LinkDirection::ToRobot),
            arrived(LinkDirection::ToStation)
        );
    }
}
