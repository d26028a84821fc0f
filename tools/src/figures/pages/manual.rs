//! Mode 0: static curves, dead zones and basic movements.

use super::*;

/// Speed of a wheel over the PWM, up and down again, on the floor and in the air.
fn panel(wheel: &str, side: usize, floor: &[Runs; 2], air: &[Runs; 2]) -> Panel {
    let mut curves = vec![
        threshold("the report's thresholds", 35.0),
        threshold("", -35.0),
        threshold("", 65.0),
        threshold("", -65.0),
    ];
    for (names, ink, both) in [
        (["in the air", ""], Ink::Third, air),
        (["on the floor", ""], OURS, floor),
    ] {
        for (name, runs) in names.into_iter().zip(both) {
            let speeds =
                runs.each(|sample| (f64::from(sample.duty[side]), RPM * sample.wheel_rad_s[side]));
            curves.push(Curve::median(name, ink, &speeds));
        }
    }
    Panel::new(&format!("{wheel}, rpm"), curves)
}

fn threshold(name: &'static str, pwm: f64) -> Curve {
    Curve::new(name, Ink::Reference, vec![(pwm, -170.0), (pwm, 170.0)])
}

fn forward_and_backward(scenario: &str) -> Result<Option<[Runs; 2]>, String> {
    let forward = runs(&format!("{scenario}-forward"), runs::OURS)?;
    Ok(forward
        .zip(runs(&format!("{scenario}-backward"), runs::OURS)?)
        .map(|(forward, backward)| [forward, backward]))
}

pub(super) fn manual() -> Result<Option<Made>, String> {
    let (Some(floor), Some(air)) = (
        forward_and_backward("manual-curve-floor")?,
        forward_and_backward("manual-curve-air")?,
    ) else {
        return Ok(None);
    };
    let plot = Plot {
        x: "PWM, of 255".into(),
        x_range: None,
        panels: vec![
            panel("left wheel", 0, &floor, &air),
            panel("right wheel", 1, &floor, &air),
        ],
    };
    let Some(movements) = movements()? else {
        return Ok(None);
    };
    Ok(Some(Made {
        figures: vec![(
            "manual",
            "Wheel speed over PWM: a dead zone, left at less PWM than it was entered with",
            figure("Speed over PWM", &plot),
        )],
        words: format!("{}\n{movements}", starts(&floor, &air)),
    }))
}

/// The PWM at which wheels start and stop.
fn starts(floor: &[Runs; 2], air: &[Runs; 2]) -> String {
    let mut text = String::from(
        "| starts to turn at a PWM of | left | right | the report's robot |\n|---|---|---|---|\n",
    );
    for (place, [forward, backward], real) in [
        ("on the floor", floor, "about 65"),
        ("in the air", air, "35"),
    ] {
        for (way, runs) in [("forward", forward), ("backward", backward)] {
            let cell = |metric| spread(&row("", metric, "", ""), runs);
            text += &format!(
                "| {place}, {way} | {} | {} | {real} |\n",
                cell("left_dead_zone_duty"),
                cell("right_dead_zone_duty"),
            );
        }
    }
    text
}

/// Movements open loop, as the report makes them, beside the same by speed.
fn movements() -> Result<Option<String>, String> {
    let rows = [
        (
            "manual-straight",
            row("straight on: turned by", "turn_rad", "deg", ""),
        ),
        (
            "manual-straight",
            row("straight on: to the side", "sideways_m", "cm", ""),
        ),
        (
            "manual-arc-left",
            row("arc to the left: radius", "radius_m", "cm", ""),
        ),
        (
            "manual-turn-left",
            row("turn on the spot: path of its centre", "path_m", "cm", ""),
        ),
    ];
    let mut text =
        String::from("| movement | open loop, as the report | by speed |\n|---|---|---|\n");
    for (scenario, row) in rows {
        let speed = format!("{scenario}-speed");
        let (Some(open), Some(by_speed)) = (runs(scenario, runs::OURS)?, runs(&speed, runs::OURS)?)
        else {
            return Ok(None);
        };
        text += &format!(
            "| {} | {} | {} |\n",
            row.what,
            spread(&row, &open),
            spread(&row, &by_speed)
        );
    }
    text += &format!(
        "\n{} simulated robots: median, min and max in parentheses.\n`rumbo run manual-curve-floor-forward --runs {}`, and the like.\n",
        runs::SEEDS,
        runs::SEEDS
    );
    Ok(Some(text))
}
