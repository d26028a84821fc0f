//! How fast a new robot drives at full PWM, and the gears with which it drives as fast as somebody measured.
//!
//! A speed alone tells neither motor nor battery. Those are taken as they were said or usual, and the motor gets other gears,
//! with which it has the same power: where the PWM starts to turn a wheel hardly changes, and the torque falls as the speed grows.

use super::RobotFile;
use super::new_plant::{Measured, plant};
use rumbo_plant::drivetrain::{Bridge, Drivetrain, Side};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;
use rumbo_sim::drivers::Driver;

/// How much slower and faster than the motor's own gears others may make a wheel.
const GEARS: [f64; 2] = [0.3, 2.5];
/// Steps of a millisecond until it drives as fast as it can.
const STEPS: u32 = 2_000;
/// Halvings of [`GEARS`], to a thousandth of them.
const HALVINGS: u32 = 12;

/// The speed on the floor at full PWM of a robot whose gears make the wheels so many times faster \[m/s\].
pub(super) fn top_speed_m_s(driver: &Driver, measured: &Measured, faster: f64) -> f64 {
    let text = format!(
        "title = \"-\"\ndriver = \"{}\"\n{}",
        driver.name,
        plant(driver, measured, faster)
    );
    RobotFile::parse("", "", &text).map_or(0.0, |robot| driven_m_s(robot.plant))
}

/// The speed that both wheels at full PWM reach on an even floor \[m/s\].
fn driven_m_s(mut params: Params) -> f64 {
    (params.floor.roughness, params.floor.slip) = (0.0, 0.0);
    let drivetrain = Drivetrain::new(&params, Noise::new(0, 0), true);
    let mut state = drivetrain.start();
    for side in [Side::Left, Side::Right] {
        drivetrain.set_bridge(&mut state, side, Bridge::Forward(1.0));
    }
    let mut way_m = 0.0;
    for _ in 0..STEPS {
        way_m = drivetrain.step(&mut state, 0.001, [0.0; 2]).forward_m;
    }
    way_m / 0.001
}

/// The gears that reach the speed that was measured, those of the motor itself where none was.
///
/// # Errors
/// What other gears reach.
pub(super) fn gears(driver: &Driver, measured: &Measured) -> Result<f64, String> {
    let Some(wanted_m_s) = measured.top_speed_m_s else {
        return Ok(1.0);
    };
    let speed = |faster: f64| top_speed_m_s(driver, measured, faster);
    let [mut slow, mut fast] = GEARS;
    let [least, most] = GEARS.map(speed);
    if !(least..=most).contains(&wanted_m_s) {
        return Err(format!(
            "with these motors and this battery gears reach {least:.2} to {most:.2} m/s: say its motors, its battery, its wheels"
        ));
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (slow + fast);
        if speed(middle) < wanted_m_s {
            slow = middle;
        } else {
            fast = middle;
        }
    }
    Ok(0.5 * (slow + fast))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_sim::drivers::DRIVERS;

    #[test]
    fn gears_reach_the_speed_that_was_measured_and_say_what_they_cannot() {
        for driver in DRIVERS {
            for said in [&[][..], &[("wheels", "4")], &[("battery", "7.4")]] {
                let mut measured = Measured::default();
                for (key, text) in said {
                    measured.say(key, text);
                }
                let own = top_speed_m_s(driver, &measured, 1.0);
                assert!(own > 0.05, "{} {said:?}: {own}", driver.name);
                let wanted = 0.7 * own;
                measured.say("top-speed", &wanted.to_string());
                let faster = gears(driver, &measured).unwrap();
                let reached = top_speed_m_s(driver, &measured, faster);
                assert!(
                    (reached / wanted - 1.0).abs() < 0.01,
                    "{} {said:?}: {reached}",
                    driver.name
                );
                assert!(
                    (0.5..1.0).contains(&faster),
                    "{} {said:?}: {faster}",
                    driver.name
                );
                measured.say("top-speed", "2.9");
                let why = gears(driver, &measured).unwrap_err();
                assert!(why.contains("gears reach 0."), "{why}");
            }
        }
    }
}
