//! Encoder edges in the image: at full speed two edges of a wheel come within one look-ahead of the plant, and each is
//! counted once.

use crate::faults::drive::setup;
use rumbo_emulator::model::ATMEGA2560;
use rumbo_experiment::files::FileError;
use rumbo_experiment::run::run_by;

/// The image's latched encoder, in `RUMBO_INPUTS`.
#[derive(Clone, Copy, Default)]
struct Latched {
    count: u16,
    last_us: u32,
    turn_us: u32,
}

impl Latched {
    fn read(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        Self {
            count: u16::from_le_bytes([bytes[0], bytes[1]]),
            last_us: word(2),
            turn_us: word(6),
        }
    }

    /// Deviation of these edges from the prediction by the motor's last turn [edges]; `None` if the wheel is slow.
    fn off_edges(self, before: Self) -> Option<f64> {
        let edges = f64::from(self.count.wrapping_sub(before.count));
        let span_us = f64::from(self.last_us.wrapping_sub(before.last_us));
        let edge_us = f64::from(self.turn_us) / 8.0;
        (edges > 9.0 && edge_us > 0.0).then(|| (span_us / edge_us - edges).abs())
    }
}

#[test]
fn a_fast_wheel_s_edges_come_one_by_one() {
    let Some(setup) = setup("manual-asymmetry-forward", |_| {}) else {
        return;
    };
    let (mut judged, mut worst) = (0, 0.0_f64);
    run_by(&setup, 15, |run| {
        let mut before = [Latched::default(); 2];
        while !run.is_over() {
            run.advance();
            let mega = run.sim().mega_mut().unwrap();
            let inputs = mega.firmware().image().variable("RUMBO_INPUTS").unwrap();
            let at = inputs.address as usize - usize::from(ATMEGA2560.sram_start);
            for (side, before) in before.iter_mut().enumerate() {
                // Behind the time; 10 bytes for each wheel.
                let latched = Latched::read(&mega.chip().cpu().sram()[at + 4 + 10 * side..]);
                if let Some(off) = latched.off_edges(*before) {
                    (judged, worst) = (judged + 1, worst.max(off));
                }
                *before = latched;
            }
        }
        Ok::<(), FileError>(())
    })
    .unwrap();
    println!("{judged} ticks of fast wheels: at most {worst:.2} edges off");
    assert!(judged > 500 && worst < 0.5, "{judged} {worst}");
}
