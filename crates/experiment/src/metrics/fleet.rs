//! Metrics of several robots in one world: those of each, of each pair, and of all.

use super::{Metrics, bare};
use rumbo_sim::Sim;
use rumbo_sim::fleet::{Encounter, Fleet, Met};

/// Of robots by their names, with the metrics of each: those begin with its name, a pair's with both, as in
/// `north.contacts` and `north-south.closest_m`.
pub(crate) fn of_fleet(fleet: &Fleet, sims: &[Sim], robots: &[(&str, &Metrics)]) -> Metrics {
    let mut metrics = Metrics::new();
    for (robot, own) in robots {
        let own = own.iter();
        metrics.extend(own.map(|(metric, value)| (format!("{robot}.{metric}"), *value)));
    }
    let numbered = sims.iter().enumerate();
    let encounters: Vec<_> = numbered
        .map(|(number, sim)| fleet.encounters(number, sim))
        .collect();
    let (mut closest_m, mut met, mut fastest_m_s) = (f64::INFINITY, 0, 0.0_f64);
    for (second, (robot, _)) in robots.iter().enumerate() {
        for (first, (other, _)) in robots[..second].iter().enumerate() {
            let pair = Pair::of(fleet, &encounters, first, second);
            let mut put = |metric: &str, value: f64| {
                let name = format!("{other}-{robot}.{metric}");
                metrics.insert(name, rounded(value));
            };
            put("closest_m", pair.closest_m);
            put("contacts", pair.contacts as f64);
            if pair.contacts > 0 {
                put("contact_speed_m_s", pair.fastest_m_s);
            }
            closest_m = closest_m.min(pair.closest_m);
            met += pair.contacts;
        }
        let speeds = encounters[second]
            .iter()
            .map(|encounter| encounter.speed_m_s);
        fastest_m_s = speeds.fold(fastest_m_s, f64::max);
    }
    let arrived = robots.iter().filter(|(_, own)| has_arrived(own));
    metrics.insert("arrived".into(), arrived.count() as f64);
    metrics.insert("closest_m".into(), rounded(closest_m));
    metrics.insert("contact_speed_m_s".into(), rounded(fastest_m_s));
    metrics.insert("robot_contacts".into(), met as f64);
    metrics
}

/// It has reached each of its goals.
fn has_arrived(metrics: &Metrics) -> bool {
    let mut times = metrics.iter().filter(|(name, _)| bare(name) == "time_s");
    metrics.get("reached").is_some_and(|reached| *reached > 0.0)
        && times.all(|(_, time_s)| time_s.is_finite())
}

/// How near two robots came.
struct Pair {
    closest_m: f64,
    /// Contacts that either felt: those of the one that felt more.
    contacts: usize,
    /// Largest closing speed of them [m/s].
    fastest_m_s: f64,
}

impl Pair {
    fn of(fleet: &Fleet, encounters: &[Vec<Encounter>], first: usize, second: usize) -> Self {
        let felt = |robot: usize, other: usize| {
            let with = |encounter: &&Encounter| encounter.met == Met::Robot(other);
            encounters[robot].iter().filter(with).collect::<Vec<_>>()
        };
        let (one, other) = (felt(first, second), felt(second, first));
        let speeds = one.iter().chain(&other).map(|each| each.speed_m_s);
        Self {
            closest_m: fleet.closest_m(first, second),
            contacts: one.len().max(other.len()),
            fastest_m_s: speeds.fold(0.0, f64::max),
        }
    }
}

/// A billionth of any unit is rounding, not behaviour.
fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9 + 0.0
}
