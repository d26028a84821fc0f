//! Injected link faults: bytes lost, flipped, repeated, cut off, late, or none at all for a while.
//!
//! A [`Faulty`] target stands between a session and its robot, for tests and experiments; a [`Line`] is one direction
//! of it. Which bytes are hit follows from the seed alone. Order is preserved, as on a serial line.

use crate::error::TargetError;
use crate::target::{Abilities, LinkNews, Target};
use crate::world::EditedWorld;
use rumbo_log::{Choice, Manifest, Scene, Truth};
use rumbo_wire::Command;
use std::collections::VecDeque;
use std::ops::Range;

/// The faults. A piece is what is sent, or arrives, at once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// Share of bytes that get lost, 0..=1.
    pub lose: f64,
    /// Share of bytes of which one bit is flipped, 0..=1.
    pub flip: f64,
    /// Share of pieces that arrive twice, 0..=1.
    pub duplicate: f64,
    /// Share of pieces of which the end is missing, 0..=1.
    pub cut: f64,
    /// Longest delay of a piece; each has its own \[us\].
    pub delay_us: u64,
    /// When nothing gets through \[us\].
    pub silent_us: Vec<Range<u64>>,
}

/// One direction of a faulty link.
#[derive(Clone, Debug)]
pub struct FaultyLine {
    faults: Faults,
    random: u64,
    /// Pieces in flight, with their arrival times.
    waiting: VecDeque<(u64, Vec<u8>)>,
}

impl FaultyLine {
    /// A line whose faults follow from the seed.
    #[must_use]
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self {
            faults,
            random: seed,
            waiting: VecDeque::new(),
        }
    }

    /// Takes a piece; returns whether it will arrive once and intact.
    pub fn send(&mut self, bytes: &[u8], now_us: u64) -> bool {
        if bytes.is_empty() {
            return true;
        }
        let damaged = self.damage(bytes, now_us);
        let whole = damaged == bytes;
        let twice = self.happens(self.faults.duplicate);
        let delay_us = match self.faults.delay_us {
            0 => 0,
            longest_us => self.next() % (longest_us + 1),
        };
        // Nothing overtakes.
        let last_us = self.waiting.back().map_or(0, |(arrives_us, _)| *arrives_us);
        let arrives_us = (now_us + delay_us).max(last_us);
        for _ in 0..=u8::from(twice) {
            self.waiting.push_back((arrives_us, damaged.clone()));
        }
        whole && !twice
    }

    /// Appends what has arrived by now.
    pub fn receive(&mut self, now_us: u64, into: &mut Vec<u8>) {
        let arrived = |(arrives_us, _): &mut (u64, Vec<u8>)| *arrives_us <= now_us;
        while let Some((_, bytes)) = self.waiting.pop_front_if(arrived) {
            into.extend(bytes);
        }
    }

    /// The piece as it will arrive.
    fn damage(&mut self, bytes: &[u8], now_us: u64) -> Vec<u8> {
        let silent = |range: &Range<u64>| range.contains(&now_us);
        if self.faults.silent_us.iter().any(silent) {
            return Vec::new();
        }
        let end = match self.happens(self.faults.cut) {
            true => self.next() as usize % bytes.len(),
            false => bytes.len(),
        };
        let mut damaged = Vec::with_capacity(end);
        for byte in &bytes[..end] {
            if self.happens(self.faults.lose) {
                continue;
            }
            let flip = match self.happens(self.faults.flip) {
                true => 1 << (self.next() % 8),
                false => 0,
            };
            damaged.push(byte ^ flip);
        }
        damaged
    }

    fn happens(&mut self, share: f64) -> bool {
        share > 0.0 && (self.next() >> 11) as f64 / (1u64 << 53) as f64 <= share
    }

    /// SplitMix64 (Steele, Lea, Flood 2014).
    fn next(&mut self) -> u64 {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.random;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }
}

/// A target behind a faulty link, the same faults in both directions.
#[derive(Debug)]
pub struct Faulty<T> {
    /// The target.
    pub target: T,
    to_robot: FaultyLine,
    from_robot: FaultyLine,
    bytes: Vec<u8>,
}

impl<T: Target> Faulty<T> {
    /// Wraps a target with these faults.
    pub fn new(target: T, faults: Faults, seed: u64) -> Self {
        Self {
            target,
            to_robot: FaultyLine::new(faults.clone(), seed),
            from_robot: FaultyLine::new(faults, !seed),
            bytes: Vec::new(),
        }
    }
}

impl<T: Target> Target for Faulty<T> {
    fn now_us(&self) -> u64 {
        self.target.now_us()
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        self.target.advance(dt_us)?;
        self.bytes.clear();
        self.to_robot.receive(self.target.now_us(), &mut self.bytes);
        self.target.send(&self.bytes)
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        self.to_robot.send(bytes, self.target.now_us());
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        let now_us = self.target.now_us();
        self.bytes.clear();
        self.target.receive(&mut self.bytes);
        self.from_robot.send(&self.bytes, now_us);
        self.from_robot.receive(now_us, into);
    }

    fn baud(&self) -> u32 {
        self.target.baud()
    }

    fn manifest(&self) -> Manifest {
        self.target.manifest()
    }

    fn news(&mut self) -> Option<LinkNews> {
        self.target.news()
    }

    fn abilities(&self) -> Abilities {
        self.target.abilities()
    }

    fn truth(&self) -> Option<Truth> {
        self.target.truth()
    }

    fn scene(&self) -> Option<Scene> {
        self.target.scene()
    }

    fn first_commands(&self) -> Vec<Command> {
        self.target.first_commands()
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), TargetError> {
        self.target.reset(choice)
    }

    fn world(&mut self, given: Option<&str>) -> EditedWorld {
        self.target.world(given)
    }

    fn drive_in(&mut self, world: &str) -> Result<Choice, TargetError> {
        self.target.drive_in(world)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn carried(faults: Faults, pieces: u64) -> Vec<u8> {
        let mut line = FaultyLine::new(faults, 5);
        let mut arrived = Vec::new();
        for number in 0..pieces {
            line.send(&[7; 10], number * 1_000);
            line.receive(number * 1_000, &mut arrived);
        }
        line.receive(u64::MAX, &mut arrived);
        arrived
    }

    #[test]
    fn each_fault_hits_its_share() {
        let near = |count: usize, expected: f64| {
            assert!(
                (count as f64 / expected - 1.0).abs() < 0.1,
                "{count} {expected}"
            );
        };
        assert_eq!(carried(Faults::default(), 100), vec![7; 1_000]);
        let lose = Faults {
            lose: 0.2,
            ..Faults::default()
        };
        near(carried(lose, 1_000).len(), 8_000.0);
        let flip = Faults {
            flip: 0.2,
            ..Faults::default()
        };
        near(
            carried(flip, 1_000)
                .iter()
                .filter(|byte| **byte != 7)
                .count(),
            2_000.0,
        );
        let duplicate = Faults {
            duplicate: 0.2,
            ..Faults::default()
        };
        near(carried(duplicate, 1_000).len(), 12_000.0);
        let cut = Faults {
            cut: 0.5,
            ..Faults::default()
        };
        // On average a cut takes 5.5 of 10 bytes.
        near(carried(cut, 1_000).len(), 7_250.0);
        let silent = Faults {
            silent_us: std::iter::once(100_000..600_000).collect(),
            ..Faults::default()
        };
        assert_eq!(carried(silent, 1_000).len(), 5_000);
    }

    #[test]
    fn what_is_late_is_not_overtaken() {
        let faults = Faults {
            delay_us: 50_000,
            ..Faults::default()
        };
        let mut line = FaultyLine::new(faults, 1);
        let (mut arrived, mut late) = (Vec::new(), 0);
        for number in 0..200u8 {
            let now_us = u64::from(number) * 1_000;
            line.send(&[number], now_us);
            line.receive(now_us, &mut arrived);
            late = late.max(usize::from(number) + 1 - arrived.len());
        }
        line.receive(u64::MAX, &mut arrived);
        assert!(late > 20, "{late}");
        assert!(arrived.into_iter().eq(0..200));
    }
}
