//! Limits what is recorded of a real robot: a link carries some kilobytes per second, and a flood on the port must not
//! fill the disk.

use crate::entry::Entry;
use crate::event::{Level, LoggedEvent};
use crate::signals::Row;

/// Most of link, signals and consoles recorded per second, before compression \[bytes\].
const ROOM: usize = 128 << 10;
/// So many events are recorded in a second.
const EVENTS: usize = 50;
/// A message of the log besides the bytes in it, and one with all signals \[bytes\].
const MESSAGE: usize = 100;
const ROW: usize = 1_000;

/// What has been recorded of the second that passes, and what was left out of it.
#[derive(Debug, Default)]
pub struct Bound {
    second: u64,
    filled: usize,
    events: usize,
    bytes_left_out: usize,
    others_left_out: usize,
}

impl Bound {
    /// Whether an entry is recorded; and what is to be recorded before it of what was left out.
    pub fn judge(&mut self, entry: &Entry) -> (bool, Option<Entry>) {
        // The only ones whose time is ours and not the robot's.
        let second = match entry {
            Entry::Burst(burst) => burst.t_us / 1_000_000,
            _ => self.second,
        };
        let note = (second != self.second)
            .then(|| self.pass_to(second))
            .flatten();
        (self.admits(entry), note)
    }

    /// The event that says what was left out, if something was.
    pub fn pass_to(&mut self, second: u64) -> Option<Entry> {
        let past = std::mem::replace(
            self,
            Self {
                second,
                ..Self::default()
            },
        );
        if past.bytes_left_out + past.others_left_out == 0 {
            return None;
        }
        let Self {
            bytes_left_out: bytes,
            others_left_out: others,
            ..
        } = past;
        Some(Entry::Event(LoggedEvent {
            t_s: past.second as f64,
            level: Level::Warning,
            text: format!(
                "recording: more came in this second than a robot says; {bytes} bytes of the link and {others} samples and events are left out"
            ),
        }))
    }

    fn admits(&mut self, entry: &Entry) -> bool {
        let (cost, bytes) = match entry {
            // Base64 has four characters for three bytes.
            Entry::Burst(burst) if !burst.to_robot => {
                (MESSAGE + burst.bytes.len() * 4 / 3, burst.bytes.len())
            }
            Entry::Said(said) => (MESSAGE + said.bytes.len() * 4 / 3, said.bytes.len()),
            Entry::Rows(rows) => (ROW * rows.len(), 0),
            Entry::State(_) => (ROW, 0),
            Entry::Parameters(values) => (MESSAGE * values.len(), 0),
            Entry::Event(_) => {
                self.events += 1;
                let admitted = self.events <= EVENTS;
                self.others_left_out += usize::from(!admitted);
                return admitted;
            }
            // Ours, as often as we like.
            _ => return true,
        };
        let admitted = self.filled + cost <= ROOM;
        match admitted {
            true => self.filled += cost,
            false if bytes > 0 => self.bytes_left_out += bytes,
            false => self.others_left_out += rows_of(entry).len().max(1),
        }
        admitted
    }
}

fn rows_of(entry: &Entry) -> &[Row] {
    match entry {
        Entry::Rows(rows) => rows,
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::entry::Burst;

    fn burst(t_us: u64, length: usize) -> Entry {
        Entry::Burst(Burst {
            t_us,
            to_robot: false,
            bytes: vec![0; length],
        })
    }

    #[test]
    fn of_a_flood_some_is_recorded_in_each_second_and_the_rest_is_counted() {
        let mut bound = Bound::default();
        let (mut kept, mut said) = (0, Vec::new());
        // 14 MB in each of three seconds.
        for number in 0..3_000 {
            let (admitted, note) = bound.judge(&burst(1_000 * number, 14_000));
            kept += usize::from(admitted) * 14_000;
            said.extend(note);
        }
        said.extend(bound.pass_to(3));
        assert!((150_000..400_000).contains(&kept), "{kept}");
        let texts = said.iter().map(|entry| match entry {
            Entry::Event(event) => event.text.clone(),
            other => panic!("{other:?}"),
        });
        let left_out = texts.map(|text| {
            let number = text.split(' ').find_map(|word| word.parse::<usize>().ok());
            number.unwrap()
        });
        assert_eq!(left_out.sum::<usize>() + kept, 42_000_000);
    }

    #[test]
    fn a_link_at_115200_baud_is_recorded_whole() {
        let mut bound = Bound::default();
        for number in 0..2_000 {
            // Every 5 ms what arrived; 25 samples a second.
            assert!(bound.judge(&burst(5_000 * number, 58)).0);
            if number % 8 == 0 {
                assert!(bound.judge(&Entry::Rows(vec![Row::unknown(0)])).0);
            }
        }
        assert!(bound.pass_to(11).is_none());
    }
}
