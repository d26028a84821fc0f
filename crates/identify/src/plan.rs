//! A short drive that shows as much as possible of a robot: open loop, each movement for about a second.
//!
//! | part | what it shows |
//! |---|---|
//! | in the air | back-EMF, dry and viscous friction of each wheel and direction, break-away, inertia: no floor disturbs |
//! | straight on | rolling resistance; the body's mass, which is known, gives the torques their scale |
//! | turns on the spot | scrubbing, damping of the yaw, yaw inertia |
//!
//! A frame of telemetry tells in which 40 ms the duty changed, not at which of the four ticks. Rests last a tick more than
//! whole frames, so that changes fall on all four alike.
//!
//! Fast stretches are followed by slow ones: how long the friction remembers. Each movement on the floor has its
//! opposite, so that the robot ends about where it began.

use rumbo_control::mode::Movement;

/// One movement, or a stop, for a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanStep {
    /// What.
    pub movement: Movement,
    /// At this PWM, of 255.
    pub pwm: u8,
    /// How long, s.
    pub seconds: f64,
}

/// Movements without a pause for the person.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanPart {
    /// Its name.
    pub name: &'static str,
    /// What the person does before.
    pub instruction: &'static str,
    /// Whether the wheels are on the floor.
    pub on_floor: bool,
    /// The movements.
    pub steps: Vec<PlanStep>,
}

impl PlanPart {
    /// How long it takes, s.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.steps.iter().map(|step| step.seconds).sum()
    }
}

const fn step(movement: Movement, pwm: u8, seconds: f64) -> PlanStep {
    PlanStep {
        movement,
        pwm,
        seconds,
    }
}

const fn rest(seconds: f64) -> PlanStep {
    step(Movement::Stop, 0, seconds)
}

/// The parts, in their order; less than two minutes of driving.
#[must_use]
pub fn plan() -> [PlanPart; 3] {
    [
        PlanPart {
            name: "wheels in the air",
            instruction: "put the robot on a box so that both wheels turn freely",
            on_floor: false,
            steps: in_the_air(),
        },
        PlanPart {
            name: "straight on",
            instruction: "put the robot on the floor with 1 m free ahead of it and 1 m behind it",
            on_floor: true,
            steps: straight_on(),
        },
        PlanPart {
            name: "turns on the spot",
            instruction: "leave the robot on the floor with half a metre free around it",
            on_floor: true,
            steps: turns(),
        },
    ]
}

fn in_the_air() -> Vec<PlanStep> {
    let direction = |movement| {
        let ramp = (30..=50).step_by(4).map(|pwm| step(movement, pwm, 0.41));
        // Coasting shows friction over inertia, whatever the motors do.
        let levels = [70, 110, 180, 255];
        let levels = levels.map(|pwm| [step(movement, pwm, 1.2), rest(0.81)]);
        // How easily a wheel runs that has gone fast for long, and for how long it does.
        let after = [
            step(movement, 255, 5.0),
            step(movement, 60, 3.5),
            rest(0.81),
        ];
        let starts = [100, 0, 160, 0].map(|pwm| step(movement, pwm, 0.7));
        let parts: [Vec<PlanStep>; 4] =
            [ramp.collect(), levels.concat(), after.into(), starts.into()];
        parts.concat()
    };
    [direction(Movement::Forward), direction(Movement::Backward)].concat()
}

fn straight_on() -> Vec<PlanStep> {
    let mut steps = Vec::new();
    for (pwm, seconds) in [
        (80, 1.6),
        (110, 1.2),
        (150, 0.9),
        (95, 1.4),
        (190, 0.7),
        (120, 1.1),
        (230, 0.6),
        (170, 0.8),
    ] {
        // A fast robot rolls for longer; it is not to be driven back before it stands.
        let rolling_s = if pwm < 170 { 0.71 } else { 1.01 };
        for movement in [Movement::Forward, Movement::Backward] {
            steps.extend([step(movement, pwm, seconds), rest(rolling_s)]);
        }
    }
    // Fast to slow, without a stop.
    for movement in [Movement::Forward, Movement::Backward] {
        steps.extend([
            step(movement, 150, 0.7),
            step(movement, 75, 1.2),
            rest(0.71),
        ]);
    }
    steps
}

fn turns() -> Vec<PlanStep> {
    let mut steps = Vec::new();
    for (pwm, seconds) in [
        (100, 1.4),
        (140, 1.0),
        (85, 1.6),
        (180, 0.8),
        (115, 1.2),
        (220, 0.7),
        (95, 1.3),
        (160, 0.9),
        (130, 1.1),
        (200, 0.75),
    ] {
        for movement in [Movement::TurnLeft, Movement::TurnRight] {
            steps.extend([step(movement, pwm, seconds), rest(0.61)]);
        }
    }
    for pair in [
        [Movement::PivotLeftForward, Movement::PivotLeftBackward],
        [Movement::PivotRightForward, Movement::PivotRightBackward],
    ] {
        for movement in pair {
            steps.extend([step(movement, 130, 0.9), rest(0.61)]);
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drive_lasts_at_most_two_minutes() {
        let seconds: f64 = plan().iter().map(PlanPart::seconds).sum();
        assert!(seconds <= 120.0, "{seconds}");
    }

    #[test]
    fn each_movement_on_the_floor_has_its_opposite() {
        for part in plan().iter().filter(|part| part.on_floor) {
            let of = |movement: Movement| -> f64 {
                let steps = part.steps.iter().filter(|step| step.movement == movement);
                steps.map(|step| step.seconds).sum()
            };
            for (there, back) in [
                (Movement::Forward, Movement::Backward),
                (Movement::TurnLeft, Movement::TurnRight),
                (Movement::PivotLeftForward, Movement::PivotLeftBackward),
                (Movement::PivotRightForward, Movement::PivotRightBackward),
            ] {
                assert_eq!(of(there), of(back), "{there:?} in {}", part.name);
            }
        }
    }
}
