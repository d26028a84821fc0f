//! docs/wiring.md: the connections of the Mega's pins, as a drawing and as a table, from the robot file.

use super::Made;
use rumbo_experiment::files::Library;
use rumbo_sim::boards::MEGA;
use rumbo_sim::wiring::Wiring;
use std::fmt::Write;

/// Where a terminal of a part goes.
#[derive(Clone, Copy)]
enum To {
    /// To the pin of a signal of the wiring.
    Signal(&'static str),
    /// To a rail, by its name.
    Rail(&'static str),
    /// To another part.
    Part(&'static str),
}

/// A part beside the board, its terminals from top to bottom.
struct Part {
    title: &'static str,
    terminals: &'static [(&'static str, To)],
}

const SUPPLY: To = To::Rail("5 V");
const BOTH: To = To::Rail("5 V, GND");
const GROUND: To = To::Rail("GND");
const BATTERY: To = To::Rail("battery +");

const LEFT: &[Part] = &[
    Part {
        title: "L298N, motor driver",
        terminals: &[
            ("ENA", To::Signal("right_enable")),
            ("IN1", To::Signal("right_backward")),
            ("IN2", To::Signal("right_forward")),
            ("IN3", To::Signal("left_backward")),
            ("IN4", To::Signal("left_forward")),
            ("ENB", To::Signal("left_enable")),
            ("12V", BATTERY),
            ("GND", GROUND),
            ("OUT1, OUT2", To::Part("right motor")),
            ("OUT3, OUT4", To::Part("left motor")),
        ],
    },
    Part {
        title: "Hall sensor, left motor",
        terminals: &[
            ("OUT", To::Signal("left_encoder")),
            ("VCC", SUPPLY),
            ("GND", GROUND),
        ],
    },
    Part {
        title: "Hall sensor, right motor",
        terminals: &[
            ("OUT", To::Signal("right_encoder")),
            ("VCC", SUPPLY),
            ("GND", GROUND),
        ],
    },
    Part {
        title: "Battery, 2 Li-ion cells",
        terminals: &[("+, over a switch", BATTERY), ("−", GROUND)],
    },
];

const RIGHT: &[Part] = &[
    Part {
        title: "HC-05, Bluetooth",
        terminals: &[
            ("RXD, over 1 kΩ; 2 kΩ to GND", To::Signal("link_tx")),
            ("TXD", To::Signal("link_rx")),
            ("VCC", SUPPLY),
            ("GND", GROUND),
        ],
    },
    Part {
        title: "HC-SR04, left",
        terminals: &[
            ("Trig", To::Signal("left_trigger")),
            ("Echo", To::Signal("left_echo")),
            ("VCC, GND", BOTH),
        ],
    },
    Part {
        title: "HC-SR04, right",
        terminals: &[
            ("Trig", To::Signal("right_trigger")),
            ("Echo", To::Signal("right_echo")),
            ("VCC, GND", BOTH),
        ],
    },
    Part {
        title: "HC-SR04, on the servo",
        terminals: &[
            ("Trig", To::Signal("front_trigger")),
            ("Echo", To::Signal("front_echo")),
            ("VCC, GND", BOTH),
        ],
    },
    Part {
        title: "Servo",
        terminals: &[("signal", To::Signal("servo")), ("VCC, GND", BOTH)],
    },
];

const WIDTH: i32 = 940;
const ROW: i32 = 22;
const TOP: i32 = 44;
/// Left and right edge of the board, and width of the parts.
const BOARD: (i32, i32) = (360, 580);
const PART: i32 = 230;
const MARGIN: i32 = 16;

/// A wire's colour by its signal.
fn colour(to: To) -> &'static str {
    match to {
        To::Rail("5 V" | "5 V, GND") => "#d55e00",
        To::Rail("GND") => "#333333",
        To::Rail(_) | To::Part(_) => "#cc79a7",
        To::Signal(signal) if signal.ends_with("_encoder") || signal.ends_with("_echo") => {
            "#009e73"
        }
        To::Signal(signal) if signal.starts_with("link") => "#56b4e9",
        To::Signal(_) => "#0072b2",
    }
}

/// The page's part.
pub(super) fn wiring() -> Result<Option<Made>, String> {
    let robot = Library::new()
        .robot("memoria")
        .map_err(|error| error.to_string())?;
    let wiring = robot
        .wirings
        .get("final")
        .ok_or("robot memoria: no wiring final")?;
    let svg = drawing(wiring)?;
    let words = table(wiring)?;
    let alt = "The Mega with driver, sensors, servo and Bluetooth module, each wire with its pin";
    Ok(Some(Made {
        figures: vec![("wiring", alt, svg)],
        words,
    }))
}

fn pin(wiring: &Wiring, signal: &str) -> Result<u8, String> {
    let pin = wiring.pins.get(signal).copied();
    pin.ok_or_else(|| format!("robot memoria: wiring final has no {signal}"))
}

fn drawing(wiring: &Wiring) -> Result<String, String> {
    let mut body = String::new();
    let left = column(&mut body, wiring, LEFT, true)?;
    let right = column(&mut body, wiring, RIGHT, false)?;
    let height = left.max(right) + MARGIN;
    let middle = (BOARD.0 + BOARD.1) / 2;
    let board = format!(
        "<rect x=\"{}\" y=\"16\" width=\"{}\" height=\"{}\" rx=\"6\" fill=\"#e8f1f5\" stroke=\"#0072b2\"/>\
         <text x=\"{}\" y=\"36\" text-anchor=\"middle\" font-weight=\"bold\">Arduino Mega 2560</text>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">VIN: battery +</text>\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">5V, GND: the parts beside</text>\n",
        BOARD.0,
        BOARD.1 - BOARD.0,
        height - 32,
        middle,
        middle,
        height - 46,
        middle,
        height - 28
    );
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\" fill=\"#333333\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fbfbf9\"/>\n{board}{body}</svg>\n"
    ))
}

/// Draws the parts of one side; returns where they end.
fn column(
    body: &mut String,
    wiring: &Wiring,
    parts: &[Part],
    is_left: bool,
) -> Result<i32, String> {
    let x = if is_left {
        MARGIN
    } else {
        WIDTH - MARGIN - PART
    };
    let mut y = TOP;
    for part in parts {
        let height = ROW * (part.terminals.len() as i32 + 1);
        let _ = writeln!(
            body,
            "<rect x=\"{x}\" y=\"{y}\" width=\"{PART}\" height=\"{height}\" rx=\"6\" fill=\"#ffffff\" stroke=\"#999999\"/>\
             <text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-weight=\"bold\">{}</text>",
            x + PART / 2,
            y + 16,
            part.title
        );
        for (index, (name, to)) in part.terminals.iter().enumerate() {
            terminal(
                body,
                wiring,
                y + ROW * (index as i32 + 1) + ROW / 2,
                is_left,
                name,
                *to,
            )?;
        }
        y += height + 14;
    }
    Ok(y)
}

fn terminal(
    body: &mut String,
    wiring: &Wiring,
    y: i32,
    is_left: bool,
    name: &str,
    to: To,
) -> Result<(), String> {
    let (edge, board, sign) = if is_left {
        (MARGIN + PART, BOARD.0, 1)
    } else {
        (WIDTH - MARGIN - PART, BOARD.1, -1)
    };
    let (anchor, other) = if is_left {
        ("end", "start")
    } else {
        ("start", "end")
    };
    let stroke = colour(to);
    let text = |x: i32, anchor: &str, words: &str| {
        format!(
            "<text x=\"{x}\" y=\"{}\" text-anchor=\"{anchor}\">{words}</text>",
            y + 4
        )
    };
    let line = |from: i32, to: i32| {
        format!(
            "<path d=\"M{from} {y}H{to}\" stroke=\"{stroke}\" stroke-width=\"2\" fill=\"none\"/>"
        )
    };
    body.push_str(&text(edge - 8 * sign, anchor, name));
    match to {
        To::Signal(signal) => {
            let number = pin(wiring, signal)?;
            body.push_str(&line(edge, board));
            body.push_str(&text(
                board + 8 * sign,
                other,
                &format!("{number}  {signal}"),
            ));
        }
        To::Rail(words) | To::Part(words) => {
            let end = edge + 30 * sign;
            body.push_str(&line(edge, end));
            body.push_str(&text(end + 6 * sign, other, words));
        }
    }
    body.push('\n');
    Ok(())
}

/// The pins by their numbers.
fn table(wiring: &Wiring) -> Result<String, String> {
    let mut rows: Vec<(u8, &str, &str, &str)> = Vec::new();
    for part in LEFT.iter().chain(RIGHT) {
        for (name, to) in part.terminals {
            if let To::Signal(signal) = to {
                rows.push((pin(wiring, signal)?, signal, part.title, name));
            }
        }
    }
    rows.sort_unstable();
    let mut words = String::from("| pin | of the chip | signal | goes to |\n|---|---|---|---|\n");
    for (number, signal, part, terminal) in rows {
        let chip = MEGA
            .pin(number)
            .map_or_else(String::new, |pin| pin.to_string());
        let _ = writeln!(
            words,
            "| {number} | {chip} | `{signal}` | {part}: {terminal} |"
        );
    }
    Ok(words)
}
