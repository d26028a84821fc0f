//! Pins over time as a value change dump (IEEE 1364, section 18), which GTKWave and other viewers of waveforms show.
//!
//! [`Chip::record_levels`](crate::chip::Chip::record_levels) -> levels with their cycles -> [`Waveform`].

use crate::devices::Level;
use crate::devices::ports::Pin;
use std::io::{self, Write};
use vcd::{IdCode, TimescaleUnit, Writer};

/// A cycle is 62.5 ns: 625 units of 100 ps.
const UNIT_PS: u32 = 100;
const UNITS_PER_CYCLE: u64 = 625;

/// A file of waveforms.
pub struct Waveform<W: Write> {
    writer: Writer<W>,
    signals: Vec<Signal>,
    /// The last time written.
    cycle: Option<u64>,
}

struct Signal {
    pin: Pin,
    id: IdCode,
}

impl<W: Write> Waveform<W> {
    /// Starts a file with these signals; spaces in their names become underscores. A pin may have several.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn new(out: W, names: &[(String, Pin)]) -> io::Result<Waveform<W>> {
        let mut writer = Writer::new(out);
        writer.timescale(UNIT_PS, TimescaleUnit::PS)?;
        writer.add_module("mega")?;
        let mut signals = Vec::new();
        for (name, pin) in names {
            let name: String = name.split_whitespace().collect::<Vec<_>>().join("_");
            let id = writer.add_wire(1, &name)?;
            signals.push(Signal { pin: *pin, id });
        }
        writer.upscope()?;
        writer.enddefinitions()?;
        Ok(Waveform {
            writer,
            signals,
            cycle: None,
        })
    }

    /// Says what level a pin has from this cycle on; cycles ascend.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn put(&mut self, level: Level) -> io::Result<()> {
        let Level { cycle, pin, high } = level;
        for signal in self.signals.iter().filter(|signal| signal.pin == pin) {
            if self.cycle.is_none_or(|last| last < cycle) {
                self.writer.timestamp(cycle * UNITS_PER_CYCLE)?;
                self.cycle = Some(cycle);
            }
            self.writer.change_scalar(signal.id, high)?;
        }
        Ok(())
    }

    /// Ends the file at a cycle.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(mut self, cycle: u64) -> io::Result<()> {
        if self.cycle.is_none_or(|last| last < cycle) {
            self.writer.timestamp(cycle * UNITS_PER_CYCLE)?;
        }
        self.writer.flush()
    }
}
