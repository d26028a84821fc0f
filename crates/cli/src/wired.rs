//! The robot that a page of the lab wires: what there is to choose from, and the file that its choices make, checked.

use crate::args::{driver_named, drivers, pin, sensor};
use rumbo_experiment::files::new_robot::{
    ASKED, Asked, JUMPERS, Measured, NewRobot, find, looks_like, needed, remarks,
};
use rumbo_experiment::files::{FileError, Kind, Library, RobotFile};
use rumbo_sim::boards::{BOARDS, Board};
use rumbo_sim::bus::DeviceKind;
use rumbo_sim::wiring::{PartKind, Wiring};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use toml::Table;

/// What a page asks: nothing yet, or what its choices make.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    plan: Option<Plan>,
}

/// The choices of a page. Of a known robot, `like`, its file says all but where the signals are.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Plan {
    name: String,
    like: Option<String>,
    board: String,
    driver: String,
    pins: Vec<(String, String)>,
    /// What is said besides wires, by the names of [`ASKED`].
    said: BTreeMap<String, String>,
    /// Where sensors are, as `--sensors` takes it.
    places: Vec<String>,
    parts: Vec<[String; 3]>,
}

/// Answers a page: `{"choices": …}`, or `{"toml": …, "remarks": […], "alike": …, "on": …}` of its plan, or `{"problem": …}`;
/// both with what may be said of such a robot and where its sensors are, `{"asked": …, "places": …}`.
pub(crate) fn answer(request: &Value) -> Value {
    let library = Library::new();
    let answer = match Request::deserialize(request) {
        Err(error) => Err(error.to_string()),
        Ok(Request { plan: None }) => choices(&library).map_err(|error| error.to_string()),
        Ok(Request { plan: Some(plan) }) => made(&library, plan),
    };
    answer.unwrap_or_else(|problem| json!({ "problem": problem }))
}

fn choices(library: &Library) -> Result<Value, FileError> {
    let drivers: Vec<Value> = drivers()
        .map(|(name, driver, jumpers)| {
            json!({
                "name": name,
                "title": driver.title,
                "jumpers": jumpers,
                "needed": needed(driver, jumpers),
                "standby": driver.has_standby,
            })
        })
        .collect();
    let known = library.list(Kind::Robot).into_iter();
    let known = known
        .map(|name| known_robot(library, &name))
        .collect::<Result<Vec<_>, _>>()?;
    let parts = PartKind::ALL.map(PartKind::name).into_iter();
    let devices = DeviceKind::ALL.into_iter().map(DeviceKind::name);
    Ok(json!({ "choices": {
        "boards": BOARDS.map(board),
        "drivers": drivers,
        "known": known.into_iter().flatten().collect::<Vec<_>>(),
        "parts": parts.chain(devices).collect::<Vec<_>>(),
        "asked": ASKED.iter().map(asked).collect::<Vec<_>>(),
    } }))
}

fn board(board: &Board) -> Value {
    let pins: Vec<Value> = (0..=board.last_pin())
        .map(|pin| {
            json!({
                "name": board.shown(pin),
                "pwm": board.pwm.contains(&pin),
            })
        })
        .collect();
    json!({ "name": board.name, "title": board.title, "pins": pins })
}

fn asked(asked: &Asked) -> Value {
    json!({
        "key": asked.key,
        "label": asked.label,
        "about": asked.about,
        "choices": asked.choices(),
        "range": asked.range(),
    })
}

/// A known robot to begin with; none where it has no wiring, or several.
fn known_robot(library: &Library, name: &str) -> Result<Option<Value>, FileError> {
    let robot = library.robot(name)?;
    let mut wirings = robot.wirings.values();
    let (Some(wiring), None) = (wirings.next(), wirings.next()) else {
        return Ok(None);
    };
    Ok(Some(json!({
        "name": name,
        "title": robot.title,
        "board": wiring.board.name,
        "driver": driver_of(wiring),
        "pins": signals(wiring),
    })))
}

fn driver_of(wiring: &Wiring) -> String {
    let jumpers = if wiring.held.is_empty() { "" } else { JUMPERS };
    format!("{}{jumpers}", wiring.driver.name)
}

/// Where the signals of a wiring are, those of motors on a shield too.
fn signals(wiring: &Wiring) -> BTreeMap<String, String> {
    let pins = wiring.pins.iter();
    let pins = pins.map(|(signal, pin)| (signal.clone(), wiring.board.shown(*pin)));
    let motors = ["left", "right"].into_iter().zip(wiring.motors);
    let motors = motors.filter_map(|(side, motor)| {
        let motor = motor?;
        let way = if motor.reversed {
            "backward"
        } else {
            "forward"
        };
        Some((format!("{side}_{way}"), format!("M{}", motor.number)))
    });
    pins.chain(motors).collect()
}

fn made(library: &Library, plan: Plan) -> Result<Value, String> {
    if let Some(like) = &plan.like {
        let (text, robot) = rewired(library, like, &plan.pins)?;
        return drawn(library, &text, &robot);
    }
    let robot = new(plan)?;
    let asked: BTreeMap<&str, String> = robot
        .asked()
        .into_iter()
        .map(|(asked, usual)| (asked.key, usual))
        .collect();
    let places = robot.places().into_iter();
    let places: BTreeMap<String, String> = places
        .map(|(sensor, place)| (sensor, place.map(|number| number.to_string()).join(":")))
        .collect();
    let checked = robot.checked().map_err(|error| error.to_string());
    let drawn = checked.and_then(|(text, robot)| drawn(library, &text, &robot));
    let mut answer = drawn.unwrap_or_else(|problem| json!({ "problem": problem }));
    answer["asked"] = json!(asked);
    answer["places"] = json!(places);
    Ok(answer)
}

/// What a page shows of a robot's file.
fn drawn(library: &Library, text: &str, robot: &RobotFile) -> Result<Value, String> {
    let wiring = robot.wirings.values().next();
    let wiring = wiring.ok_or("a robot needs pins")?;
    let alike = looks_like(library, wiring).map_err(|error| error.to_string())?;
    let on: BTreeMap<String, &str> = (0..=wiring.board.last_pin())
        .filter_map(|pin| Some((wiring.board.shown(pin), wiring.owner_of(pin)?)))
        .collect();
    Ok(json!({
        "toml": text,
        "remarks": remarks(wiring),
        "alike": alike.map(|alike| json!({
            "robot": alike.robot, "same": alike.same, "of": alike.of, "others": alike.others,
        })),
        "on": on,
    }))
}

fn new(plan: Plan) -> Result<NewRobot, String> {
    let (driver, jumpers) = driver_named(&plan.driver)?;
    let board = Board::named(&plan.board);
    let is_plain = |c: char| c.is_alphanumeric() || "_- ".contains(c);
    if !plan.name.chars().all(is_plain) {
        return Err("a robot's name has letters, digits, blanks, _ and - only".into());
    }
    for (signal, place) in &plan.pins {
        pin(&format!("{signal}={place}"))?;
    }
    let places = plan.places.iter().map(|place| sensor(place));
    let mut robot = NewRobot {
        name: plan.name,
        board: board.ok_or_else(|| format!("no board {}", plan.board))?,
        driver,
        jumpers,
        pins: plan.pins,
        sensors: places.collect::<Result<_, _>>()?,
        measured: Measured::default(),
        parts: plan.parts,
    };
    for (key, text) in &plan.said {
        let asked = find(key).ok_or_else(|| format!("nobody asks for {key}"))?;
        robot.say(asked, text)?;
    }
    Ok(robot)
}

/// The file of a known robot, as it is where its signals stay, else with these in their places.
fn rewired(
    library: &Library,
    like: &str,
    pins: &[(String, String)],
) -> Result<(String, RobotFile), String> {
    let say = |error: FileError| error.to_string();
    let parsed = |text: &str| RobotFile::parse(like, &format!("{like}.toml"), text).map_err(say);
    let text = library.text(Kind::Robot, like).map_err(say)?;
    let robot = parsed(&text)?;
    let wiring = robot.wirings.iter().next();
    let (name, wiring) = wiring.ok_or("it has no wiring")?;
    let before = signals(wiring);
    let after: BTreeMap<String, String> = pins.iter().cloned().collect();
    if before == after {
        return Ok((text, robot));
    }
    let mut file: Table = text
        .parse()
        .map_err(|error: toml::de::Error| error.to_string())?;
    let own = file
        .get_mut("wiring")
        .and_then(|wirings| wirings.get_mut(name.as_str()));
    let own = own.and_then(toml::Value::as_table_mut);
    let own = own.ok_or("it has no wiring")?;
    own.retain(|signal, _| !before.contains_key(signal));
    own.extend(after.into_iter().map(|(signal, pin)| {
        let pin = pin
            .parse::<i64>()
            .map_or(toml::Value::from(pin), toml::Value::from);
        (signal, pin)
    }));
    let text = toml::to_string(&file).map_err(|error| error.to_string())?;
    let robot = parsed(&text)?;
    Ok((text, robot))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(changes: Value) -> Value {
        let mut plan = json!({
            "name": "my car", "like": null, "board": "uno", "driver": "l298n-jumpers", "said": {}, "places": [], "parts": [],
            "pins": [["left_forward", "5"], ["left_backward", "6"], ["right_forward", "9"], ["right_backward", "10"]],
        });
        let (plan_fields, changes) = (plan.as_object_mut().unwrap(), changes.as_object().unwrap());
        plan_fields.extend(changes.clone());
        answer(&json!({ "plan": plan }))
    }

    #[test]
    fn a_plan_is_answered_by_its_file_or_by_what_is_wrong_with_it() {
        let good = plan(json!({}));
        assert!(
            good["toml"].as_str().unwrap().contains("left_forward = 5"),
            "{good}"
        );
        assert_eq!(good["on"]["10"], "right_backward");
        let charged = plan(json!({ "said": { "battery": "7.4" } }));
        assert!(
            charged["toml"]
                .as_str()
                .unwrap()
                .contains("open_circuit_v = 7.4"),
            "{charged}"
        );
        for (wrong, why) in [
            (json!({ "driver": "l297" }), "no such driver"),
            (json!({ "board": "due" }), "no board due"),
            (json!({ "name": "a\nboard = 1" }), "letters, digits"),
            (
                json!({ "pins": [["left_foward", "5"]] }),
                "no signal `left_foward`",
            ),
            (
                json!({ "parts": [["go", "button", "5"]] }),
                "left_forward is on that pin",
            ),
            (
                json!({ "said": { "battery": "40" } }),
                "battery = 40: must be within 5.6..12 V",
            ),
            (json!({ "said": { "top-speed": "3" } }), "gears reach"),
            (json!({ "places": ["line_1=here"] }), "write it as"),
            (json!({ "extra": 1 }), "unknown field"),
        ] {
            let problem = plan(wrong.clone());
            let problem = problem["problem"].as_str().unwrap_or_default().to_owned();
            assert!(problem.contains(why), "{wrong}: {problem}");
        }
    }

    #[test]
    fn a_known_robot_is_as_its_file_has_it_but_for_the_pins_that_differ() {
        let choices = answer(&json!({}));
        let known = choices["choices"]["known"].as_array().unwrap();
        assert!(known.len() > 4);
        for robot in known {
            let pins = |change: Option<&str>| -> Vec<Value> {
                let pins = robot["pins"].as_object().unwrap().iter();
                pins.map(|(signal, pin)| match change {
                    Some(to) if signal == "servo" => json!([signal, to]),
                    _ => json!([signal, pin]),
                })
                .collect()
            };
            let like = |pins: Vec<Value>| {
                plan(
                    json!({ "like": robot["name"], "board": robot["board"], "driver": robot["driver"], "pins": pins }),
                )
            };
            let same = like(pins(None));
            let name = robot["name"].as_str().unwrap();
            assert_eq!(
                same["toml"],
                Library::new().text(Kind::Robot, name).unwrap(),
                "{same}"
            );
            if robot["pins"]["servo"].is_string() {
                let is_free = |pin: &&&str| same["on"][**pin].is_null();
                let free = ["4", "10", "13", "A1"].iter().find(is_free);
                let free = *free.unwrap_or_else(|| panic!("{name} has none"));
                let moved = like(pins(Some(free)));
                assert_eq!(moved["on"][free], "servo", "{moved}");
                assert_eq!(
                    moved["on"].as_object().unwrap().len(),
                    same["on"].as_object().unwrap().len()
                );
            }
        }
    }
}
