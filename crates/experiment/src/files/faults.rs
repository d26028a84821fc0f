//! `[[sonar_fault]]` and `[[wire_fault]]` of a scenario: what fails in a run, and when.

use super::read::{Allowed, Table};
use rumbo_control::SonarId;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};

/// Tables of each kind in a scenario.
pub(super) const MOST_FAULTS: usize = 1_000;

pub(super) fn read_sonar_faults(
    tables: Vec<Table<'_, '_>>,
    duration_s: f64,
) -> Vec<TimedSonarFault> {
    let mut faults = Vec::new();
    for table in tables {
        let at_s = table.required_number("at_s", Allowed::new(0.0, duration_s, "s"));
        let share = table.number("share", Allowed::new(0.0, 1.0, ""));
        let sonar = table.required_text("sonar", "\"left\", \"right\" or \"front\"");
        let sonar_id = match sonar.value.as_str() {
            "left" => Some(SonarId::Left),
            "right" => Some(SonarId::Right),
            "front" => Some(SonarId::Front),
            "" => None,
            other => {
                let remedy = "write \"left\", \"right\" or \"front\"";
                table.complain("sonar", sonar.line, other, remedy);
                None
            }
        };
        let kind = table.required_text("kind", "\"cut\", \"stuck\", \"clear\" or \"spiking\"");
        let fault = match (kind.value.as_str(), share) {
            ("cut", None) => Some(SonarFault::Cut),
            ("stuck", None) => Some(SonarFault::Stuck),
            ("clear", None) => Some(SonarFault::Clear),
            ("", _) => None,
            ("spiking", share) => Some(SonarFault::Spiking(share.unwrap_or(0.3))),
            (other, _) => {
                let remedy = "write \"cut\", \"stuck\", \"clear\", or \"spiking\" with share = 0.3";
                table.complain("kind", kind.line, other, remedy);
                None
            }
        };
        table.finish();
        if let (Some(sonar), Some(fault)) = (sonar_id, fault) {
            faults.push(TimedSonarFault { at_s, sonar, fault });
        }
    }
    faults
}

pub(super) fn read_wire_faults(tables: Vec<Table<'_, '_>>, duration_s: f64) -> Vec<TimedWireFault> {
    let mut faults = Vec::new();
    for table in tables {
        let at_s = table.required_number("at_s", Allowed::new(0.0, duration_s, "s"));
        let share = table.number("share", Allowed::new(0.0, 1.0, ""));
        let rate_hz = table.number("rate_hz", Allowed::new(0.0, 20_000.0, "Hz"));
        let named = table.required_text("wire", "\"left_encoder\" or \"front_echo\", for instance");
        let wire = Wire::ALL.into_iter().find(|(name, _)| *name == named.value);
        if wire.is_none() && !named.value.is_empty() {
            let names = Wire::ALL.map(|(name, _)| name).join(", ");
            let remedy = format!("write one of {names}");
            table.complain("wire", named.line, &named.value, &remedy);
        }
        let kind = table.required_text("kind", "\"low\", \"high\", \"losing\" or \"noisy\"");
        let fault = match (kind.value.as_str(), share, rate_hz) {
            ("low", None, None) => Some(WireFault::Low),
            ("high", None, None) => Some(WireFault::High),
            ("losing", share, None) => Some(WireFault::Losing(share.unwrap_or(0.3))),
            ("noisy", None, rate_hz) => Some(WireFault::Noisy(rate_hz.unwrap_or(1_000.0))),
            ("", ..) => None,
            (other, ..) => {
                let remedy = "write \"low\", \"high\", \"losing\" with share = 0.3, or \"noisy\" with rate_hz = 1000";
                table.complain("kind", kind.line, other, remedy);
                None
            }
        };
        table.finish();
        if let (Some((_, wire)), Some(fault)) = (wire, fault) {
            faults.push(TimedWireFault { at_s, wire, fault });
        }
    }
    faults
}
