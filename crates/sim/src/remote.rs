//! Infrared remote controls, and what their receiver does at its pin: the NEC protocol behind a demodulator (VS1838B, TSOP38).
//!
//! The receiver's output is high, and low while it sees the carrier. A key sends its frame once, and a short repeat every
//! 108 ms while it is held. The address is 0, and the commands are those of the three remotes that come with Arduino kits, as the
//! library IRremote lists the one with arrows (DemoIRCommandMapping.h, Keyes clone); the same chip in the others sends the same
//! command for the same place. That of Adafruit and DFRobot has an address of two bytes, 0xBF00. Any other one's keys are bits.

use std::collections::VecDeque;

/// Cycles of the board's crystal in a microsecond.
const US: u64 = 16;
/// The unit of the protocol, 21 periods of its 38 kHz \[us\].
const UNIT_US: f64 = 562.5;
/// From the beginning of a frame or repeat to the next one \[us\].
const REPEAT_US: u64 = 108_000;
/// How long a key stays down after it was pressed \[us\]: longer than a repeat takes to come.
const DOWN_US: u64 = 200_000;

/// A key: what stands on it, and the bits that it sends, the first one lowest (IRremote's `decodedRawData` from version 3 on).
pub type Key = (String, u32);
/// A key of a remote that is known, and its command, below the second byte of an address that has one.
pub type Known = (&'static str, u16);

/// The keys of a remote that is known.
#[must_use]
pub fn keys(remote: &[Known]) -> Vec<Key> {
    let key = |&(name, command): &Known| (name.to_owned(), bits(command));
    remote.iter().map(key).collect()
}

/// Address 0 and its inverse or second byte, command and its inverse.
#[must_use]
pub const fn bits(code: u16) -> u32 {
    let [second, command] = code.to_be_bytes();
    let second = if second == 0 { 0xFF } else { second };
    u32::from_le_bytes([0, second, command, !command])
}

/// The remote with arrows, 17 keys, row by row.
pub const ARROWS: [Known; 17] = [
    ("1", 0x45),
    ("2", 0x46),
    ("3", 0x47),
    ("4", 0x44),
    ("5", 0x40),
    ("6", 0x43),
    ("7", 0x07),
    ("8", 0x15),
    ("9", 0x09),
    ("*", 0x16),
    ("0", 0x19),
    ("#", 0x0D),
    ("up", 0x18),
    ("left", 0x08),
    ("ok", 0x1C),
    ("right", 0x5A),
    ("down", 0x52),
];

/// The one with its arrows above the digits, as kits for cars have it (Elegoo, Keyestudio, LAFVIN), row by row.
pub const CAR: [Known; 17] = [
    ("up", 0x46),
    ("left", 0x44),
    ("ok", 0x40),
    ("right", 0x43),
    ("down", 0x15),
    ("1", 0x16),
    ("2", 0x19),
    ("3", 0x0D),
    ("4", 0x0C),
    ("5", 0x18),
    ("6", 0x5E),
    ("7", 0x08),
    ("8", 0x1C),
    ("9", 0x5A),
    ("*", 0x42),
    ("0", 0x52),
    ("#", 0x4A),
];

/// The remote of a car radio, 21 keys, row by row.
pub const RADIO: [Known; 21] = [
    ("ch-", 0x45),
    ("ch", 0x46),
    ("ch+", 0x47),
    ("prev", 0x44),
    ("next", 0x40),
    ("play", 0x43),
    ("vol-", 0x07),
    ("vol+", 0x15),
    ("eq", 0x09),
    ("0", 0x16),
    ("100+", 0x19),
    ("200+", 0x0D),
    ("1", 0x0C),
    ("2", 0x18),
    ("3", 0x5E),
    ("4", 0x08),
    ("5", 0x1C),
    ("6", 0x5A),
    ("7", 0x42),
    ("8", 0x52),
    ("9", 0x4A),
];

/// The same codes under the names on the remote of starter kits (Elegoo and others), row by row.
pub const STARTER: [Known; 21] = {
    let names = [
        "power", "vol+", "func", "prev", "play", "next", "down", "vol-", "up", "0", "eq", "st",
    ];
    let (mut keys, mut at) = (RADIO, 0);
    while at < names.len() {
        keys[at].0 = names[at];
        at += 1;
    }
    keys
};

/// The mini remote of Adafruit and DFRobot, 21 keys, row by row, as Adafruit's product 389 lists its codes.
pub const MINI: [Known; 21] = [
    ("vol-", 0xBF00),
    ("play", 0xBF01),
    ("vol+", 0xBF02),
    ("setup", 0xBF04),
    ("up", 0xBF05),
    ("stop", 0xBF06),
    ("left", 0xBF08),
    ("enter", 0xBF09),
    ("right", 0xBF0A),
    ("0", 0xBF0C),
    ("down", 0xBF0D),
    ("back", 0xBF0E),
    ("1", 0xBF10),
    ("2", 0xBF11),
    ("3", 0xBF12),
    ("4", 0xBF14),
    ("5", 0xBF15),
    ("6", 0xBF16),
    ("7", 0xBF18),
    ("8", 0xBF19),
    ("9", 0xBF1A),
];

/// A remote in somebody's hand.
#[derive(Clone, Debug, Default)]
pub(crate) struct Remote {
    /// The bits of the key that is down, and until when [us].
    down: Option<(u32, u64)>,
    /// When the next frame or repeat may begin [us].
    free_us: u64,
    /// The frame of the key that is down has been sent.
    sent: bool,
    /// Levels to come, each with its cycle.
    levels: VecDeque<(u64, bool)>,
}

impl Remote {
    /// A key is pressed, for a moment; pressed again meanwhile, it stays down for longer.
    pub(crate) fn press(&mut self, bits: u32, now_us: u64) {
        let down = self.down.filter(|(_, until_us)| *until_us >= now_us);
        self.sent &= down.is_some_and(|(down, _)| down == bits);
        self.down = Some((bits, now_us + DOWN_US));
    }

    /// The levels of the receiver's output that begin in this time [us], each with its cycle.
    pub(crate) fn send(&mut self, from_us: u64, to_us: u64) -> Vec<(u64, bool)> {
        if let Some((bits, until_us)) = self.down {
            let begin_us = self.free_us.max(from_us);
            if self.sent && begin_us > until_us {
                (self.down, self.sent) = (None, false);
            } else if begin_us < to_us {
                let levels = if self.sent { repeat() } else { frame(bits) };
                let at = |(cycle, level): (u64, bool)| (begin_us * US + cycle, level);
                self.levels.extend(levels.into_iter().map(at));
                (self.sent, self.free_us) = (true, begin_us + REPEAT_US);
            }
        }
        let due = self
            .levels
            .partition_point(|(cycle, _)| *cycle < to_us * US);
        self.levels.drain(..due).collect()
    }
}

/// Low and high times in units, one after the other, as levels.
fn levels(times: impl IntoIterator<Item = f64>) -> Vec<(u64, bool)> {
    let (mut at, mut high) = (0.0, false);
    let mut levels = Vec::new();
    for units in times {
        levels.push(((at * US as f64) as u64, high));
        at += units * UNIT_US;
        high = !high;
    }
    levels.push(((at * US as f64) as u64, true));
    levels
}

/// Leader, the bits, the lowest first, and a last pulse.
fn frame(bits: u32) -> Vec<(u64, bool)> {
    let bits = (0..u32::BITS).map(|bit| bits >> bit & 1 != 0);
    let bits = bits.flat_map(|bit| [1.0, if bit { 3.0 } else { 1.0 }]);
    levels([16.0, 8.0].into_iter().chain(bits).chain([1.0]))
}

/// What a key that is held sends: a leader with a shorter gap, and a pulse.
fn repeat() -> Vec<(u64, bool)> {
    levels([16.0, 4.0, 1.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a remote sends within some time, a millisecond at a time.
    fn sent(remote: &mut Remote, ms: std::ops::Range<u64>) -> Vec<(u64, bool)> {
        let sent = ms.flat_map(|ms| remote.send(ms * 1_000, (ms + 1) * 1_000));
        sent.collect()
    }

    #[test]
    fn a_key_sends_its_frame_and_short_repeats_while_it_is_held() {
        let mut remote = Remote::default();
        let (_, ok) = ARROWS.into_iter().find(|(name, _)| *name == "ok").unwrap();
        remote.press(bits(ok), 5_000);
        let levels = sent(&mut remote, 5..300);
        // Leader, 32 bits and the last pulse; then a repeat: each low and its end.
        assert_eq!(levels.len(), 2 * 34 + 2 * 2);
        let us: Vec<u64> = levels.iter().map(|(cycle, _)| cycle / US).collect();
        assert_eq!(us[..3], [5_000, 14_000, 18_500]);
        let bit = |index: usize| us[2 * index + 4] - us[2 * index + 2] > 1_700;
        let byte = |from: usize| (0..8).fold(0, |all, at| all | u8::from(bit(8 * from + at)) << at);
        let command = ok as u8;
        assert_eq!([0, 1, 2, 3].map(byte), [0, 0xFF, command, !command]);
        assert_eq!(us[68..71], [113_000, 122_000, 124_250]);
        assert!(levels.iter().step_by(2).all(|(_, level)| !level));
        assert!(levels.last().unwrap().1);
        for ms in (300..600).step_by(100) {
            remote.press(bits(ok), ms * 1_000);
            let levels = sent(&mut remote, ms..ms + 100);
            assert_eq!(levels.len() > 20, ms == 300, "{ms} {}", levels.len());
        }
        assert!(sent(&mut remote, 800..1_000).is_empty());
    }

    #[test]
    fn the_mini_remote_s_up_is_what_sketches_compare_with() {
        let (_, up) = MINI.into_iter().find(|(name, _)| *name == "up").unwrap();
        let rises = frame(bits(up)).into_iter().filter(|(_, high)| !high);
        let starts: Vec<u64> = rises.map(|(cycle, _)| cycle / US).collect();
        let sent = starts[1..].windows(2).map(|pair| pair[1] - pair[0] > 1_700);
        let value = sent.fold(0_u32, |value, bit| value << 1 | u32::from(bit));
        assert_eq!(value, 0x00FD_A05F);
    }

    #[test]
    fn every_key_has_a_name_and_a_command_of_its_own() {
        for keys in [&ARROWS[..], &CAR, &RADIO, &MINI] {
            let mut names: Vec<_> = keys.iter().map(|(name, _)| name).collect();
            let mut commands: Vec<_> = keys.iter().map(|(_, command)| command).collect();
            names.sort_unstable();
            commands.sort_unstable();
            names.dedup();
            commands.dedup();
            assert_eq!((names.len(), commands.len()), (keys.len(), keys.len()));
        }
    }
}
