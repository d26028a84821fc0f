//! What fails in a drive, and how it is made to.

use crate::files::Setup;
use rumbo_control::SonarId;
use rumbo_emulator::devices::{Cause, Input};
use rumbo_plant::drivetrain::Side;
use rumbo_sim::Sim;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use std::fmt;

/// More friction than any motor has torque [N m].
const HELD_N_M: f64 = 2.0;

/// What fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Failure {
    /// A sonar.
    Sonar(SonarId, SonarFault),
    /// A wire.
    Wire(Wire, WireFault),
    /// A wheel is held.
    Held(Side),
    /// The chip that the image runs on.
    Chip(ChipFailure),
}

/// What fails of the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChipFailure {
    /// The button is pressed, or the port of a serial adapter is opened.
    Reset,
    /// The supply dips.
    BrownOut,
    /// A tick hangs.
    Hang,
    /// The EEPROM holds nothing but zeros, and the chip is reset.
    Forgets,
}

/// Where a tick of our image can be stopped.
const IN_EACH_TICK: &str = "rumbo_inputs_latched";
/// A jump to itself.
const FOR_EVER: u16 = 0xCFFF;

impl ChipFailure {
    fn befall(self, sim: &mut Sim) {
        let Some(mega) = sim.mega_mut() else {
            return;
        };
        let place = mega.firmware().image().function_named(IN_EACH_TICK);
        let place = place.map(|function| function.address);
        let chip = mega.chip_mut();
        let reset = |cause| Input::Reset(cause);
        match self {
            Self::Reset => chip.input(chip.cycle(), reset(Cause::External)),
            Self::BrownOut => chip.input(chip.cycle(), reset(Cause::BrownOut)),
            Self::Hang => {
                if let Some(place) = place {
                    chip.cpu_mut().write_flash(place, FOR_EVER);
                }
            }
            Self::Forgets => {
                chip.devices_mut().eeprom_mut().fill(0);
                chip.input(chip.cycle(), reset(Cause::External));
            }
        }
    }
}

impl fmt::Display for ChipFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Reset => "chip: reset",
            Self::BrownOut => "chip: brown-out",
            Self::Hang => "chip: a tick that hangs",
            Self::Forgets => "chip: EEPROM of zeros, and a reset",
        })
    }
}

impl Failure {
    /// Every failure of the campaign; those of the chip are for images.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let encoder = [
            WireFault::Low,
            WireFault::High,
            WireFault::Losing(0.1),
            WireFault::Losing(0.5),
            WireFault::Losing(0.6),
            WireFault::Losing(0.7),
            WireFault::Losing(0.8),
            WireFault::Losing(0.9),
            WireFault::Losing(0.95),
            WireFault::Losing(0.98),
            WireFault::Noisy(20.0),
            WireFault::Noisy(200.0),
            WireFault::Noisy(2_000.0),
        ];
        let echo = [
            WireFault::Low,
            WireFault::High,
            WireFault::Losing(0.3),
            WireFault::Noisy(200.0),
            WireFault::Noisy(2_000.0),
        ];
        let sonar = [
            SonarFault::Cut,
            SonarFault::Stuck,
            SonarFault::Clear,
            SonarFault::Spiking(0.1),
            SonarFault::Spiking(0.3),
            SonarFault::Spiking(0.5),
            SonarFault::Spiking(0.7),
            SonarFault::Spiking(0.9),
            SonarFault::Spiking(1.0),
        ];
        let wheels = [Side::Left, Side::Right].into_iter().flat_map(|side| {
            let wires = encoder.map(|fault| Self::Wire(Wire::Encoder(side), fault));
            wires.into_iter().chain([Self::Held(side)])
        });
        let sonars = SonarId::ALL.into_iter().rev().flat_map(|id| {
            let wires = echo.map(|fault| Self::Wire(Wire::Echo(id), fault));
            sonar
                .map(|fault| Self::Sonar(id, fault))
                .into_iter()
                .chain(wires)
        });
        let chip = [
            ChipFailure::Reset,
            ChipFailure::BrownOut,
            ChipFailure::Hang,
            ChipFailure::Forgets,
        ];
        let chip = chip.into_iter().map(Self::Chip);
        wheels.chain(sonars).chain(chip).collect()
    }

    /// Whether the robot carries what fails.
    pub(super) fn befalls(self, setup: &Setup) -> bool {
        let mounted = |id: SonarId| match id {
            SonarId::Left => setup.rig.left.is_some(),
            SonarId::Right => setup.rig.right.is_some(),
            SonarId::Front => setup.rig.front.is_some(),
        };
        match self {
            Self::Sonar(id, _) | Self::Wire(Wire::Echo(id), _) => mounted(id),
            Self::Wire(Wire::Encoder(_), _) | Self::Held(_) => true,
            Self::Chip(_) => setup.firmware.is_some(),
        }
    }

    /// The same drive, with this failure.
    pub(super) fn put_into(self, setup: &mut Setup, at_s: f64) {
        let scenario = &mut setup.scenario;
        scenario.sonar_faults.clear();
        scenario.wire_faults.clear();
        match self {
            Self::Sonar(sonar, fault) => {
                scenario
                    .sonar_faults
                    .push(TimedSonarFault { at_s, sonar, fault });
            }
            Self::Wire(wire, fault) => {
                scenario
                    .wire_faults
                    .push(TimedWireFault { at_s, wire, fault });
            }
            Self::Chip(_) | Self::Held(_) => {}
        }
    }

    /// What the scenario does not do: it befalls the drive now.
    pub(super) fn befall(self, sim: &mut Sim) {
        match self {
            Self::Chip(failure) => failure.befall(sim),
            Self::Held(side) => sim.hold(side, HELD_N_M),
            Self::Sonar(..) | Self::Wire(..) => {}
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sonar = |id: &SonarId| match id {
            SonarId::Left => "left sonar",
            SonarId::Right => "right sonar",
            SonarId::Front => "front sonar",
        };
        let percent = |share: &f64| (100.0 * share).round();
        match self {
            Self::Sonar(id, SonarFault::Cut) => write!(f, "{}: cut", sonar(id)),
            Self::Sonar(id, SonarFault::Stuck) => write!(f, "{}: last answer for ever", sonar(id)),
            Self::Sonar(id, SonarFault::Clear) => {
                write!(f, "{}: nothing in reach for ever", sonar(id))
            }
            Self::Sonar(id, SonarFault::Spiking(share)) => {
                write!(f, "{}: {} % random", sonar(id), percent(share))
            }
            Self::Wire(wire, fault) => {
                match wire {
                    Wire::Encoder(Side::Left) => f.write_str("left encoder: ")?,
                    Wire::Encoder(Side::Right) => f.write_str("right encoder: ")?,
                    Wire::Echo(id) => write!(f, "{}, echo line: ", sonar(id))?,
                }
                match fault {
                    WireFault::Low => f.write_str("low"),
                    WireFault::High => f.write_str("high"),
                    WireFault::Losing(share) => write!(f, "loses {} %", percent(share)),
                    WireFault::Noisy(rate_hz) => write!(f, "{rate_hz} pulses/s of noise"),
                }
            }
            Self::Held(Side::Left) => f.write_str("left wheel: held"),
            Self::Held(Side::Right) => f.write_str("right wheel: held"),
            Self::Chip(failure) => failure.fmt(f),
        }
    }
}
