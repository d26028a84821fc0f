//! Where the sonars of the rig in force sit, by the table.

use super::{ParamId, Params};
use crate::rig::Rig;
use crate::types::{SonarId, SonarView};
use core::f32::consts::FRAC_PI_2;

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
    pub fn view(&self, sonar: SonarId, servo_rad: f32) -> Option<SonarView> {
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
        Some(SonarView { x_m, y_m, axis_rad })
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
