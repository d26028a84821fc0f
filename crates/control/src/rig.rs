//! Where the sonars sit: the rigs of the report, a number in the parameter table.
//!
//! | number | rig | left | right | front |
//! |---|---|---|---|---|
//! | 0 | `front_single` (mode 1) | | | ahead |
//! | 1 | `front_pair` (mode 2) | ahead, left of the middle | ahead, right of it | |
//! | 2 | `side_pair_left` (modes 3, 4) | to the left, in front | to the left, behind | |
//! | 3 | `side_pair_right` | to the right, in front | to the right, behind | |
//! | 4 | `final` (mode 8) | to the left | to the right | ahead, on the servo |

use crate::params::{ParamId, Params};
use crate::types::{Side, SonarId};
use core::f32::consts::FRAC_PI_2;

/// Which sonars the robot carries, and where.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Rig {
    /// One sonar looking ahead.
    FrontSingle = 0,
    /// Two looking ahead.
    FrontPair = 1,
    /// Two looking to the left.
    SidePairLeft = 2,
    /// Two looking to the right.
    SidePairRight = 3,
    /// One on the servo in front, one on each side.
    #[default]
    Final = 4,
}

impl Rig {
    /// All rigs, by number.
    pub const ALL: [Rig; 5] = [
        Rig::FrontSingle,
        Rig::FrontPair,
        Rig::SidePairLeft,
        Rig::SidePairRight,
        Rig::Final,
    ];

    /// The rig with this number.
    pub fn from_number(number: u8) -> Option<Rig> {
        Self::ALL.into_iter().find(|rig| *rig as u8 == number)
    }

    /// The names, by number.
    #[cfg(feature = "names")]
    pub const NAMES: [&str; Self::ALL.len()] = {
        let (mut names, mut i) = ([""; Self::ALL.len()], 0);
        while i < names.len() {
            names[i] = Self::ALL[i].name();
            i += 1;
        }
        names
    };

    /// The name used in files.
    #[cfg(feature = "names")]
    pub const fn name(self) -> &'static str {
        match self {
            Rig::FrontSingle => "front_single",
            Rig::FrontPair => "front_pair",
            Rig::SidePairLeft => "side_pair_left",
            Rig::SidePairRight => "side_pair_right",
            Rig::Final => "final",
        }
    }

    /// The rig whose number is nearest, ties to even.
    pub(crate) fn nearest(number: f32) -> Rig {
        if number >= 3.5 {
            Rig::Final
        } else if number <= 0.5 {
            Rig::FrontSingle
        } else if number < 1.5 {
            Rig::FrontPair
        } else if number <= 2.5 {
            Rig::SidePairLeft
        } else {
            Rig::SidePairRight
        }
    }

    /// The side on which a pair of sonars looks, if this rig has one.
    pub const fn paired_side(self) -> Option<Side> {
        match self {
            Rig::SidePairLeft => Some(Side::Left),
            Rig::SidePairRight => Some(Side::Right),
            Rig::FrontSingle | Rig::FrontPair | Rig::Final => None,
        }
    }
}

/// Some of the rigs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rigs(u8);

impl Rigs {
    /// Any rig.
    pub const ANY: Rigs = Rigs::of(&Rig::ALL);

    /// These rigs.
    pub const fn of(rigs: &[Rig]) -> Rigs {
        let (mut bits, mut i) = (0, 0);
        while i < rigs.len() {
            bits |= 1 << rigs[i] as u8;
            i += 1;
        }
        Rigs(bits)
    }

    /// Which they are.
    #[cfg(feature = "names")]
    pub fn iter(self) -> impl Iterator<Item = Rig> {
        Rig::ALL.into_iter().filter(move |rig| self.contains(*rig))
    }

    /// Whether this one is among them.
    pub const fn contains(self, rig: Rig) -> bool {
        self.0 & (1 << rig as u8) != 0
    }
}

/// Position and direction of a sonar, in the robot's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// Ahead of the wheels' axis [m].
    pub x_m: f32,
    /// Left of the middle [m].
    pub y_m: f32,
    /// The beam's axis, counter-clockwise from ahead [rad].
    pub axis_rad: f32,
}

impl Params {
    /// Whether the rig has this sonar.
    pub fn carries(&self, sonar: SonarId) -> bool {
        match self.rig() {
            Rig::FrontSingle => sonar == SonarId::Front,
            Rig::Final => true,
            Rig::FrontPair | Rig::SidePairLeft | Rig::SidePairRight => sonar != SonarId::Front,
        }
    }

    /// Whether a sonar looks ahead, with the servo ahead; the others look to a side, or the rig has no such sonar.
    pub fn looks_ahead(&self, sonar: SonarId) -> bool {
        match self.rig() {
            Rig::FrontSingle | Rig::Final => sonar == SonarId::Front,
            Rig::FrontPair => sonar != SonarId::Front,
            Rig::SidePairLeft | Rig::SidePairRight => false,
        }
    }

    /// The view of a sonar, with the servo at `servo_rad`; `None` where the rig has no such sonar.
    pub fn view(&self, sonar: SonarId, servo_rad: f32) -> Option<View> {
        let ahead = self.get(ParamId::SonarFrontX);
        let beside = self.get(ParamId::SonarSideY);
        let middle = self.get(ParamId::SonarSideX);
        let (x_m, y_m, axis_rad) = match (self.rig(), sonar) {
            (Rig::FrontSingle, SonarId::Front) => (ahead, 0.0, 0.0),
            (Rig::Final, SonarId::Front) => (ahead, 0.0, servo_rad),
            (Rig::Final, SonarId::Left) => (middle, beside, FRAC_PI_2),
            (Rig::Final, SonarId::Right) => (middle, -beside, -FRAC_PI_2),
            (Rig::FrontPair, SonarId::Left | SonarId::Right) => {
                let half = 0.5 * self.get(ParamId::FrontGap);
                (
                    ahead,
                    if sonar == SonarId::Left { half } else { -half },
                    0.0,
                )
            }
            (rig @ (Rig::SidePairLeft | Rig::SidePairRight), SonarId::Left | SonarId::Right) => {
                let half = 0.5 * self.get(ParamId::SideGap);
                let sign = if rig == Rig::SidePairLeft { 1.0 } else { -1.0 };
                let x_m = if sonar == SonarId::Left {
                    middle + half
                } else {
                    middle - half
                };
                (x_m, sign * beside, sign * FRAC_PI_2)
            }
            (Rig::FrontSingle, _) => return None,
            (_, SonarId::Front) => return None,
        };
        Some(View { x_m, y_m, axis_rad })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_rig_carries_its_own_sonars() {
        let mut params = Params::default();
        for rig in Rig::ALL {
            params.set(ParamId::Rig, f32::from(rig as u8)).unwrap();
            assert_eq!(params.rig(), rig);
            assert_eq!(Rig::from_number(rig as u8), Some(rig));
            let carried = SonarId::ALL.map(|sonar| params.view(sonar, 0.0).is_some());
            let expected = match rig {
                Rig::FrontSingle => [false, false, true],
                Rig::Final => [true; 3],
                _ => [true, true, false],
            };
            assert_eq!(carried, expected, "{rig:?}");
            assert_eq!(SonarId::ALL.map(|sonar| params.carries(sonar)), expected);
            for sonar in SonarId::ALL {
                let ahead = params
                    .view(sonar, 0.0)
                    .is_some_and(|view| view.axis_rad == 0.0);
                assert_eq!(params.looks_ahead(sonar), ahead);
            }
        }
        assert_eq!(Rig::from_number(5), None);
    }

    #[test]
    fn the_servo_turns_the_front_sonar_of_the_final_rig_only() {
        let mut params = Params::default();
        let axis = |params: &Params, sonar| params.view(sonar, 0.4).unwrap().axis_rad;
        assert_eq!(axis(&params, SonarId::Front), 0.4);
        assert_eq!(axis(&params, SonarId::Left), FRAC_PI_2);
        params.set(ParamId::Rig, 0.0).unwrap();
        assert_eq!(axis(&params, SonarId::Front), 0.0);
    }
}
