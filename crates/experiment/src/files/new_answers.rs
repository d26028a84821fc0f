//! What is asked of a new robot, its answers, and what is taken in their place.

use super::light::{RESISTOR_KOHM, SWITCH_LUX};
use super::new_asked::{
    ASKED, Asked, BATTERY_RATIO, LINE_PITCH, LINK_BAUD, SERVO_AHEAD, TOP_SPEED, USUAL_RATIO,
};
use super::new_robot::NewRobot;
use super::new_sensors::{are_photoresistors, line_pitch_m, places};
use super::new_speed::top_speed_m_s;
use super::obstacle::REACH_M;
use rumbo_sim::drivers::Direction;
use rumbo_sim::floor::USUAL_V;

impl NewRobot {
    /// Takes an answer to what may be asked.
    ///
    /// # Errors
    /// What is to be answered instead, after what was asked.
    pub fn say(&mut self, asked: &Asked, text: &str) -> Result<(), String> {
        let Asked { key, .. } = asked;
        let said = |remedy: String| format!("{key} = {text}: {remedy}");
        asked.check(text).map_err(said)?;
        if asked.is_option() {
            self.measured.say(key, text);
        } else {
            self.pins.push(((*key).to_owned(), text.to_owned()));
        }
        Ok(())
    }

    /// What may be asked of such a robot, each with what is taken where nobody says it.
    #[must_use]
    pub fn asked(&self) -> Vec<(&'static Asked, String)> {
        let has_gear_motors = self.driver.direction != Direction::Pulse;
        let asked = ASKED.iter();
        let asked = asked.filter(|asked| asked.is_of(&self.pins, has_gear_motors));
        asked.map(|asked| (asked, self.usual(asked.key))).collect()
    }

    /// What is taken where nobody says it.
    fn usual(&self, key: &str) -> String {
        let usual = match key {
            TOP_SPEED => {
                let speed_m_s = top_speed_m_s(self.driver, &self.measured, 1.0);
                return format!("{speed_m_s:.2}");
            }
            SERVO_AHEAD => "90",
            LINK_BAUD => "9600",
            BATTERY_RATIO => USUAL_RATIO,
            "line_dark" => "high",
            "line_light_v" => return USUAL_V[0].to_string(),
            "line_dark_v" => return USUAL_V[1].to_string(),
            LINE_PITCH => return line_pitch_m(&self.pins).to_string(),
            "sharp_model" => "gp2y0a21",
            // Photoresistors; a module is low where it is bright.
            "light_bright" if are_photoresistors(&self.pins) => "high",
            "light_bright" => "low",
            "light_resistor_kohm" => return RESISTOR_KOHM.to_string(),
            "light_rated_kohm" => "15",
            "light_switch_lux" => return SWITCH_LUX.to_string(),
            "obstacle_seen" => "low",
            "obstacle_reach_m" => return REACH_M.to_string(),
            body => {
                return self
                    .measured
                    .usual(body, self.driver)
                    .unwrap_or("false".into());
            }
        };
        usual.to_owned()
    }

    /// Where its sensors are: x and y \[m\], and the direction \[deg\].
    #[must_use]
    pub fn places(&self) -> Vec<(String, [f64; 3])> {
        places(&self.pins, &self.sensors)
    }
}
