//! What is at hand of an emulated board: its pins by the cycle, and what its ports have sent.

use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::observe::waveform::Waveform;
use rumbo_sim::Sim;
use rumbo_sim::mega::{CONSOLES, CYCLES_PER_US, Mega};
use std::collections::{BTreeMap, VecDeque};
use std::io::{self, Write};

/// Edges kept of each pin; older ones are forgotten.
const MOST_EDGES: usize = 1 << 20;
/// Bytes kept of each port.
const MOST_BYTES: usize = 1 << 24;
const HZ: f64 = 1e6 * CYCLES_PER_US as f64;

/// A pulse of a pin: a time for which it was high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse {
    /// When it rose, since the start [s].
    pub at_s: f64,
    /// How long it was high, exact to a cycle of 62.5 ns [us].
    pub width_us: f64,
}

/// A record of pins and ports.
#[derive(Clone, Debug, Default)]
pub struct Probe {
    /// Cycle and level of each change, since the start.
    edges: BTreeMap<Pin, VecDeque<(i64, bool)>>,
    said: [Vec<u8>; CONSOLES as usize],
    /// The present cycle, since the start.
    now: i64,
}

impl Probe {
    /// Begins a record at a board's pins.
    pub(super) fn at(mega: &mut Mega) -> Self {
        mega.chip_mut().record_levels();
        let mut probe = Self::default();
        probe.look(mega);
        // The present levels are no edges.
        for edges in probe.edges.values_mut() {
            edges.iter_mut().for_each(|(cycle, _)| *cycle = i64::MIN);
        }
        probe
    }

    /// Takes what has happened since.
    pub(super) fn look(&mut self, mega: &mut Mega) {
        let zero = mega.zero_cycle();
        let since = |cycle: u64| cycle.wrapping_sub(zero) as i64;
        for level in mega.chip_mut().take_levels() {
            let edges = self.edges.entry(level.pin).or_default();
            if edges.back().is_some_and(|(_, high)| *high == level.high) {
                continue;
            }
            if edges.len() == MOST_EDGES {
                edges.pop_front();
            }
            edges.push_back((since(level.cycle), level.high));
        }
        self.now = since(mega.chip().cycle());
    }

    /// Takes what a port has sent.
    pub(super) fn hear(&mut self, port: u8, bytes: &[u8]) {
        if let Some(said) = self.said.get_mut(usize::from(port)) {
            let room = MOST_BYTES.saturating_sub(said.len());
            said.extend(bytes.iter().take(room));
        }
    }

    /// All that a port has sent since the start: a USART by its number, or [`ON_PINS`](rumbo_sim::mega::ON_PINS); the
    /// first 16 MB of it.
    pub fn said(&self, port: u8) -> &[u8] {
        self.said.get(usize::from(port)).map_or(&[], Vec::as_slice)
    }

    /// The level of a pin now.
    pub fn is_high(&self, pin: Pin) -> bool {
        let edges = self.edges.get(&pin);
        edges
            .and_then(VecDeque::back)
            .is_some_and(|(_, high)| *high)
    }

    /// The edges of a pin since `from_s` [s]: when [s since the start], and whether it rose. At most the latest 1,048,576.
    pub fn edges(&self, pin: Pin, from_s: f64) -> impl Iterator<Item = (f64, bool)> {
        let edges = self.edges.get(&pin).into_iter().flatten();
        let edges = edges.filter(|(cycle, _)| *cycle > i64::MIN);
        let timed = edges.map(|(cycle, high)| (*cycle as f64 / HZ, *high));
        timed.skip_while(move |(at_s, _)| *at_s < from_s)
    }

    /// The pulses of a pin that have both begun and ended since `from_s` [s], in order.
    pub fn pulses(&self, pin: Pin, from_s: f64) -> Vec<Pulse> {
        let edges = self.edges.get(&pin).into_iter().flatten();
        let edges =
            edges.skip_while(|(cycle, _)| (*cycle as f64) < from_s * HZ || *cycle == i64::MIN);
        let (mut rise, mut pulses) = (None, Vec::new());
        for (cycle, high) in edges {
            match (high, rise) {
                (true, _) => rise = Some(*cycle),
                (false, Some(rise)) => pulses.push(Pulse {
                    at_s: rise as f64 / HZ,
                    width_us: (cycle - rise) as f64 / CYCLES_PER_US as f64,
                }),
                (false, None) => {}
            }
        }
        pulses
    }

    /// For which share of the time since `from_s` [s] a pin was high, 0 to 1; not a number if none has passed.
    pub fn share_high(&self, pin: Pin, from_s: f64) -> f64 {
        let from = (from_s * HZ).max(0.0) as i64;
        let (mut at, mut high, mut sum) = (from, false, 0);
        for (cycle, level) in self.edges.get(&pin).into_iter().flatten() {
            if high {
                sum += (*cycle).max(from) - at;
            }
            (at, high) = ((*cycle).max(from), *level);
        }
        if high {
            sum += self.now - at;
        }
        match self.now - from {
            passed if passed > 0 => sum as f64 / passed as f64,
            _ => f64::NAN,
        }
    }

    /// Writes all pins of the board over time as a value change dump, which viewers of waveforms show.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_vcd(&self, sim: &Sim, out: impl Write) -> io::Result<()> {
        let names = sim.mega().map(|mega| mega.firmware().signals());
        let mut waves = Waveform::new(out, &names.unwrap_or_default())?;
        let mut levels: Vec<_> = (self.edges.iter())
            .flat_map(|(pin, edges)| edges.iter().map(|(cycle, high)| (*cycle, *pin, *high)))
            .collect();
        levels.sort_by_key(|(cycle, ..)| *cycle);
        for (cycle, pin, high) in levels {
            let cycle = cycle.max(0) as u64;
            waves.put(rumbo_emulator::devices::Level { cycle, pin, high })?;
        }
        waves.finish(self.now.max(0) as u64)
    }
}
