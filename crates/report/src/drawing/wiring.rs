//! A wiring from the robot file: the Mega in the middle, modules on both sides, a line for each pin.

use super::sketch::{Anchor, Sketch};
use crate::text::{Language, Text, word};
use rumbo_sim::wiring::Wiring;

const ROW: f64 = 19.0;
const WIDTH: f64 = 680.0;
const MEGA: (f64, f64) = (265.0, 400.0);

/// A module: its name, what it is fed with, and its lines (signal in the robot file, name on the module).
struct Module {
    name: Text,
    supply: Text,
    lines: &'static [(&'static str, &'static str)],
}

const FIVE_VOLTS: Text = word("supply-from-the-mega");

const LEFT: [Module; 6] = [
    Module {
        name: word("hc-sr04-front"),
        supply: FIVE_VOLTS,
        lines: &[("front_trigger", "TRIG"), ("front_echo", "ECHO")],
    },
    Module {
        name: word("hc-sr04-left-or-first"),
        supply: FIVE_VOLTS,
        lines: &[("left_trigger", "TRIG"), ("left_echo", "ECHO")],
    },
    Module {
        name: word("hc-sr04-right-or-second"),
        supply: FIVE_VOLTS,
        lines: &[("right_trigger", "TRIG"), ("right_echo", "ECHO")],
    },
    Module {
        name: word("hall-encoder-a-right"),
        supply: FIVE_VOLTS,
        lines: &[("right_encoder", "OUT")],
    },
    Module {
        name: word("hall-encoder-b-left"),
        supply: FIVE_VOLTS,
        lines: &[("left_encoder", "OUT")],
    },
    Module {
        name: word("servo"),
        supply: FIVE_VOLTS,
        lines: &[("servo", "PWM")],
    },
];

const RIGHT: [Module; 3] = [
    Module {
        name: word("bridge-module"),
        supply: FIVE_VOLTS,
        lines: &[
            ("right_enable", "ENA"),
            ("right_backward", "IN1"),
            ("right_forward", "IN2"),
            ("left_backward", "IN3"),
            ("left_forward", "IN4"),
            ("left_enable", "ENB"),
        ],
    },
    Module {
        name: word("bluetooth-module"),
        supply: FIVE_VOLTS,
        lines: &[("link_tx", "RXD"), ("link_rx", "TXD")],
    },
    Module {
        name: word("battery-module"),
        supply: word("battery-charge"),
        lines: &[("battery", "+")],
    },
];

/// The drawing.
pub(crate) fn svg(language: Language, wiring: &Wiring) -> String {
    let mut sketch = Sketch::new();
    let left = side(&mut sketch, language, wiring, &LEFT, (8.0, 205.0), MEGA.0);
    let right = side(
        &mut sketch,
        language,
        wiring,
        &RIGHT,
        (462.0, 676.0),
        MEGA.1,
    );
    let height = left.max(right);
    sketch.rectangle((MEGA.0, 26.0), (MEGA.1 - MEGA.0, height - 26.0), "b");
    sketch.text(
        (0.5 * (MEGA.0 + MEGA.1), 18.0),
        "Arduino Mega 2560",
        Anchor::Middle,
    );
    pins(&mut sketch, wiring, &LEFT, MEGA.0 + 6.0, Anchor::Start);
    pins(&mut sketch, wiring, &RIGHT, MEGA.1 - 6.0, Anchor::End);
    sketch.finish(WIDTH, height + 10.0)
}

/// A module's lines that this wiring has.
fn wired<'a>(
    module: &'a Module,
    wiring: &'a Wiring,
) -> impl Iterator<Item = (&'static str, String)> + 'a {
    module.lines.iter().filter_map(|(signal, name)| {
        if *signal == "battery" {
            return Some((*name, "VIN".to_owned()));
        }
        let pin = wiring.pins.get(*signal)?;
        let pwm = if signal.ends_with("enable") || *signal == "servo" {
            " PWM"
        } else {
            ""
        };
        Some((*name, format!("{pin}{pwm}")))
    })
}

/// The modules of one side, from above; gives where they end.
fn side(
    sketch: &mut Sketch,
    language: Language,
    wiring: &Wiring,
    modules: &[Module],
    (from, to): (f64, f64),
    mega: f64,
) -> f64 {
    let mut y = 26.0;
    for module in modules {
        let lines: Vec<_> = wired(module, wiring).collect();
        if lines.is_empty() {
            continue;
        }
        let height = ROW * (lines.len() as f64 + 2.0) + 2.0;
        sketch.rectangle((from, y), (to - from, height), "b");
        let middle = 0.5 * (from + to);
        sketch.text((middle, y + 15.0), module.name.of(language), Anchor::Middle);
        sketch.text(
            (middle, y + height - 6.0),
            module.supply.of(language),
            Anchor::Middle,
        );
        for (index, (name, _)) in lines.iter().enumerate() {
            let at = y + ROW * (index as f64 + 1.5);
            let inner = if to < mega {
                (to - 6.0, Anchor::End)
            } else {
                (from + 6.0, Anchor::Start)
            };
            sketch.text((inner.0, at + 4.0), name, inner.1);
            let edge = if to < mega { to } else { from };
            sketch.line(&[(edge, at), (mega, at)], "l");
            sketch.circle((edge, at), 2.5, "k");
            sketch.circle((mega, at), 2.5, "k");
        }
        y += height + 8.0;
    }
    y
}

/// The Mega's pins at the heights of the modules' lines.
fn pins(sketch: &mut Sketch, wiring: &Wiring, modules: &[Module], x: f64, anchor: Anchor) {
    let mut y = 26.0;
    for module in modules {
        let lines: Vec<_> = wired(module, wiring).collect();
        if lines.is_empty() {
            continue;
        }
        for (index, (_, pin)) in lines.iter().enumerate() {
            sketch.text((x, y + ROW * (index as f64 + 1.5) + 4.0), pin, anchor);
        }
        y += ROW * (lines.len() as f64 + 2.0) + 10.0;
    }
}
