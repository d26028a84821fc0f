//! Watches the link and reports trouble, at limited intervals: a silent one, undecodable bytes, a full link, a noisy one.

use crate::client::LinkFigures;
use thiserror::Error;

/// Speed of the robot's Bluetooth module \[baud\].
pub const DEFAULT_BAUD: u32 = 9_600;
/// The same trouble is not reported again within this time \[us\].
const AGAIN_US: u64 = 30_000_000;
/// A robot of which nothing has come by then is reported \[us\]; one that a port resets says HELLO within two seconds.
const SILENCE_US: u64 = 5_000_000;
/// Undecodable bytes are reported after this many.
const NONSENSE_BYTES: u64 = 100;
/// More damaged frames than this within [`NOISE_US`] are reported.
const NOISE_FRAMES: u16 = 10;
/// Window in which damaged frames are counted \[us\].
const NOISE_US: u64 = 10_000_000;
/// Bytes a second that the robot needs for full telemetry: 25 frames of at most 30 bytes.
const TELEMETRY_BYTES_S: u32 = 25 * 30;
/// Telemetry frames a second of a link that carries them all.
const TELEMETRY_HZ: u32 = 25;
/// Bytes a second that go to the robot for the heartbeat alone: at most 7 bytes, every 150 ms.
const HEARTBEAT_BYTES_S: u32 = 47;

/// A link of this speed carries too few heartbeats: the robot would stop again and again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error(
    "{baud} baud carry {bytes_s} bytes/s, too few for the heartbeats ({HEARTBEAT_BYTES_S} bytes/s) and answers that \
     keep the robot going; it needs at least {least}, its own speed is {DEFAULT_BAUD}",
    baud = .0, bytes_s = .0 / 10, least = 20 * HEARTBEAT_BYTES_S
)]
pub struct BaudTooLow(u32);

/// The limitation of a link of this speed, if any.
///
/// # Errors
/// If not even heartbeats fit.
pub fn check_baud(baud: u32) -> Result<Option<String>, BaudTooLow> {
    // Ten bits to a byte.
    let bytes_s = baud / 10;
    if bytes_s < 2 * HEARTBEAT_BYTES_S {
        return Err(BaudTooLow(baud));
    }
    Ok((bytes_s < TELEMETRY_BYTES_S).then(|| {
        let hz = TELEMETRY_HZ * bytes_s / TELEMETRY_BYTES_S;
        format!(
            "{baud} baud carry {bytes_s} bytes/s, full telemetry needs {TELEMETRY_BYTES_S}: expect {hz} Hz at most, not {TELEMETRY_HZ}"
        )
    }))
}

/// The kinds of trouble.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    Silence,
    Nonsense,
    Full,
    Noise,
}

/// Keeps the times of the reports and the earlier figures.
#[derive(Debug, Default)]
pub(crate) struct LinkWatch {
    reported: [Option<u64>; 4],
    began_us: Option<u64>,
    noise_from: Option<(u64, u16)>,
    dropped: Option<u8>,
}

impl LinkWatch {
    /// Takes the figures; returns the trouble to report. `dropped`: telemetry frames left out by the robot so far,
    /// wrapping. `quiet`: the robot says nothing before it is asked to.
    pub(crate) fn look(
        &mut self,
        now_us: u64,
        link: &LinkFigures,
        connected: bool,
        dropped: u8,
        baud: u32,
        quiet: bool,
    ) -> Option<String> {
        let silent = self.silent(now_us, link.received_bytes) && !quiet;
        let nonsense = !connected && link.unread_bytes > NONSENSE_BYTES;
        let left_out = self.left_out(dropped);
        let noise = self.noise(now_us, link.crc_errors);
        if silent && self.is_due(Cause::Silence, now_us) {
            return Some(
                "nothing comes from the robot: is it on, is this the port of its Bluetooth module and not of its USB cable, \
                 are TXD and RXD exchanged? With the original program it is silent until its first ON (--text)"
                    .to_owned(),
            );
        }
        if nonsense && self.is_due(Cause::Nonsense, now_us) {
            return Some(format!(
                "bytes arrive that are neither frames nor rows of text: is {baud} baud the robot's speed? --baud sets it"
            ));
        }
        if left_out > 0 && self.is_due(Cause::Full, now_us) {
            return Some(format!(
                "the link is full: the robot left out {left_out} telemetry frames"
            ));
        }
        if noise > NOISE_FRAMES && connected && self.is_due(Cause::Noise, now_us) {
            return Some(format!(
                "the link is disturbed: {noise} damaged frames within 10 s; come nearer, or check the cable"
            ));
        }
        None
    }

    /// Whether nothing has arrived since the beginning.
    fn silent(&mut self, now_us: u64, received_bytes: u64) -> bool {
        let began_us = *self.began_us.get_or_insert(now_us);
        received_bytes == 0 && now_us >= began_us + SILENCE_US
    }

    /// Telemetry frames that the robot has left out since the last call.
    fn left_out(&mut self, dropped: u8) -> u8 {
        let before = self.dropped.replace(dropped).unwrap_or(dropped);
        dropped.wrapping_sub(before)
    }

    /// Damaged frames in the present window.
    fn noise(&mut self, now_us: u64, crc_errors: u16) -> u16 {
        let (from_us, from) = *self.noise_from.get_or_insert((now_us, crc_errors));
        // A count that has fallen is another one: that of a robot that restarted.
        if now_us >= from_us + NOISE_US || crc_errors < from {
            self.noise_from = Some((now_us, crc_errors));
        }
        crc_errors.saturating_sub(from)
    }

    fn is_due(&mut self, cause: Cause, now_us: u64) -> bool {
        let reported = &mut self.reported[cause as usize];
        let due = reported.is_none_or(|reported_us| now_us >= reported_us + AGAIN_US);
        if due {
            *reported = Some(now_us);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_of_damaged_frames_that_begins_again_is_no_noise() {
        let mut watch = LinkWatch::default();
        let counts = [3, 5, 0, 1].map(|count| watch.noise(1_000, count));
        assert_eq!(counts, [0, 2, 0, 1]);
    }

    #[test]
    fn a_speed_that_carries_too_little_is_warned_of_and_one_that_carries_nothing_refused() {
        assert_eq!(check_baud(9_600), Ok(None));
        let slow = check_baud(2_400).unwrap().unwrap();
        assert!(
            slow.contains("240 bytes/s") && slow.contains("8 Hz"),
            "{slow}"
        );
        // The least that is named is the least that is taken.
        let refused = check_baud(939).unwrap_err().to_string();
        assert!(refused.contains("at least 940"), "{refused}");
        assert!(check_baud(940).is_ok());
        assert!(
            check_baud(300)
                .unwrap_err()
                .to_string()
                .contains("heartbeats")
        );
    }

    #[test]
    fn the_heartbeat_is_no_longer_than_assumed() {
        use rumbo_wire::{FrameMessage, ToRobot};
        let longest = (0..16)
            .map(|seq| ToRobot::Heartbeat.frame(seq).bytes().len())
            .max();
        assert!(
            longest.unwrap() * 1_000 / 150 <= HEARTBEAT_BYTES_S as usize,
            "{longest:?}"
        );
    }

    #[test]
    fn each_trouble_is_reported_at_limited_intervals() {
        let mut watch = LinkWatch::default();
        let figures = |received_bytes, crc_errors| LinkFigures {
            received_bytes,
            unread_bytes: received_bytes,
            crc_errors,
            ..LinkFigures::default()
        };
        let mut look = |t_s: u64, figures: LinkFigures, connected, dropped| {
            watch.look(t_s * 1_000_000, &figures, connected, dropped, 9_600, false)
        };
        assert_eq!(look(0, figures(0, 0), false, 250), None);
        let said = look(1, figures(150, 0), false, 250).unwrap();
        assert!(said.contains("9600 baud"), "{said}");
        assert_eq!(look(2, figures(900, 0), false, 250), None);
        let said = look(3, figures(900, 0), true, 2).unwrap();
        assert!(said.contains("left out 8"), "{said}");
        let said = look(4, figures(900, 11), true, 2).unwrap();
        assert!(said.contains("11 damaged"), "{said}");
        assert_eq!(look(5, figures(900, 40), true, 2), None);
        assert_eq!(look(20, figures(900, 40), true, 2), None);
        assert_eq!(look(40, figures(900, 45), true, 2), None);
        assert!(look(41, figures(900, 64), true, 2).is_some());
    }

    #[test]
    fn a_robot_of_which_nothing_comes_is_reported_with_what_to_look_at() {
        let look = |received_bytes: u64, quiet: bool| {
            let mut watch = LinkWatch::default();
            let figures = LinkFigures {
                received_bytes,
                ..LinkFigures::default()
            };
            let mut at = |t_s: u64| watch.look(t_s * 1_000_000, &figures, false, 0, 9_600, quiet);
            assert_eq!(at(3), None);
            assert_eq!(at(7), None);
            at(8)
        };
        assert!(look(0, false).unwrap().contains("Bluetooth"));
        assert_eq!(look(0, true), None);
        assert_eq!(look(1, false), None);
    }
}
