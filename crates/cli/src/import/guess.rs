//! What the columns of another program's table probably are, by their names, types and values.

use rumbo_ros::recorded::Series;

/// A guess.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Guess {
    pub(crate) column: usize,
    /// `left_rpm`.
    pub(crate) name: String,
    /// A number that the table does not say, as it is named in a command: `COUNTS`.
    pub(crate) divisor: Option<&'static str>,
    /// Name or type say it, and the unit.
    pub(crate) is_sure: bool,
}

impl Guess {
    /// As it is written in a command.
    pub(crate) fn text(&self, series: &[Series]) -> String {
        let column = series.get(self.column).map_or("", |column| &column.name);
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./ :".contains(c);
        let column = match column.chars().all(is_plain) && !column.is_empty() {
            true => column.to_owned(),
            false => format!("#{}", self.column + 1),
        };
        let divisor = self
            .divisor
            .map(|divisor| format!("/{divisor}"))
            .unwrap_or_default();
        format!("{}={column}{divisor}", self.name)
    }
}

const TIMES: &[&str] = &[
    "time",
    "timestamp",
    "t",
    "millis",
    "micros",
    "clock",
    "elapsed",
    "uptime",
    "tiempo",
];
const LEFT: &[&str] = &["left", "l", "izq", "izquierda", "izquierdo"];
const RIGHT: &[&str] = &["right", "r", "der", "derecha", "derecho"];
const FRONT: &[&str] = &["front", "center", "centre", "middle", "frontal", "centro"];
const REFERENCES: &[&str] = &[
    "setpoint",
    "set",
    "sp",
    "ref",
    "reference",
    "target",
    "desired",
    "cmd",
    "consigna",
    "referencia",
];
const COUNTS: &[&str] = &[
    "count", "counts", "tick", "ticks", "enc", "encoder", "pulse", "pulses", "pulsos", "cuentas",
];
const PWMS: &[&str] = &["pwm", "duty", "power", "output", "out"];
const SPEEDS: &[&str] = &[
    "speed",
    "vel",
    "velocity",
    "rpm",
    "omega",
    "velocidad",
    "rads",
    "v",
];
const RANGES: &[&str] = &[
    "range",
    "distance",
    "dist",
    "sonar",
    "ultrasonic",
    "ultrasound",
    "distancia",
    "sensor",
];

/// The unit that a column's name has, of these.
pub(crate) fn unit(column: &Series, of: &[(&'static str, f64)]) -> Option<(&'static str, f64)> {
    let words = words(&column.name);
    let last = |count: usize| words.get(words.len().checked_sub(count)?..);
    let says = |unit: &str| {
        let parts: Vec<&str> = unit.split('_').collect();
        let long: &[&str] = match unit {
            "s" => &["seconds", "sec", "secs", "segundos"],
            "ms" => &["milliseconds", "millis", "msec", "milisegundos"],
            "us" => &["microseconds", "micros", "usec"],
            "ns" => &["nanoseconds", "nanosec"],
            "rpm" => &["rpm"],
            "pwm" => &["pwm"],
            "percent" => &["percent"],
            "deg" => &["degrees", "grados"],
            "turn" => &["turns", "revs", "revolutions", "vueltas"],
            "rad_s" => &["rads"],
            "duty" => &["duty"],
            _ => &[],
        };
        last(parts.len()).is_some_and(|words| words == parts)
            || words.iter().any(|word| long.contains(&word.as_str()))
    };
    of.iter()
        .filter(|(unit, _)| says(unit))
        .max_by_key(|(unit, _)| unit.len())
        .copied()
}

/// What is guessed, at most one column for each name.
pub(crate) fn guess(series: &[Series], timed: bool) -> Vec<Guess> {
    let mut guesses: Vec<Guess> = Vec::new();
    let mut add = |column: usize, name: String, divisor, is_sure| {
        guesses.push(Guess {
            column,
            name,
            divisor,
            is_sure,
        });
    };
    if !timed && let Some((column, name)) = time(series) {
        add(column, name, None, true);
    }
    let mut known: Vec<&str> = Vec::new();
    let found = series.iter().enumerate();
    let mut found: Vec<_> = found
        .filter_map(|(index, column)| Some((index, signal(column)?)))
        .collect();
    // Speeds as they are rather than those of angles.
    found.sort_by_key(|(_, (stem, unit, ..))| *stem != "heading" && ["turn", "rad"].contains(unit));
    for (index, (stem, unit, divisor, is_sure)) in found {
        // A joint has a speed and an angle; a wheel's PWM is another thing.
        let key = match unit {
            "pwm" | "duty" | "percent" if stem == "left" => "left_pwm",
            "pwm" | "duty" | "percent" => "right_pwm",
            _ => stem,
        };
        if !known.contains(&key) {
            known.push(key);
            add(index, format!("{stem}_{unit}"), divisor, is_sure);
        }
    }
    guesses
}

/// The column of the times, and its name with the unit.
fn time(series: &[Series]) -> Option<(usize, String)> {
    let rises = |column: &Series| {
        column.samples.len() > 1
            && column.samples.windows(2).all(|pair| pair[0].1 <= pair[1].1)
            && column.samples.first().map(|first| first.1)
                != column.samples.last().map(|last| last.1)
    };
    let is_named =
        |column: &Series, name: &str| words(&column.name).iter().any(|word| word == name);
    let is_time = |column: &&Series| {
        let words = words(&column.name);
        let is_unit = matches!(&words[..], [word] if ["s", "ms", "us", "sec", "seconds"].contains(&word.as_str()));
        (is_unit || words.iter().any(|word| TIMES.contains(&word.as_str()))) && rises(column)
    };
    let position =
        |wanted: &dyn Fn(&&Series) -> bool| series.iter().position(|column| wanted(&column));
    // A program's own times are better than those of what received them.
    let own = position(&|column| is_time(column) && !is_named(column, "clock"));
    let found = own.or_else(|| position(&|column| is_time(column)));
    if let Some(index) = found {
        let column = series.get(index)?;
        return Some((index, format!("t_{}", time_unit(column))));
    }
    let index = position(&|column| {
        is_named(column, "dt") && column.samples.iter().all(|(_, dt)| *dt >= 0.0)
    })?;
    let typical = series.get(index).map_or(0.0, middle);
    let named = series
        .get(index)
        .and_then(|column| unit(column, &[("s", 1.0), ("ms", 1.0), ("us", 1.0)]));
    let unit = named.map_or(if typical >= 1.0 { "ms" } else { "s" }, |(unit, _)| unit);
    Some((index, format!("dt_{unit}")))
}

fn time_unit(column: &Series) -> &'static str {
    if let Some((unit, _)) = unit(column, &[("s", 1.0), ("ms", 1.0), ("us", 1.0), ("ns", 1.0)]) {
        return unit;
    }
    let first = column.samples.first().map_or(0.0, |first| first.1);
    let is_whole = column.samples.iter().all(|(_, t)| t.fract() == 0.0);
    match first {
        1e17.. => "ns",
        1e14.. => "us",
        1e11.. => "ms",
        _ if is_whole => "ms",
        _ => "s",
    }
}

/// Half of the values are larger.
fn middle(column: &Series) -> f64 {
    let mut values: Vec<f64> = column.samples.iter().map(|(_, value)| *value).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Name, unit, what it is to be divided by, and whether that is certain.
type Signal = (&'static str, &'static str, Option<&'static str>, bool);

const LENGTHS: &[&str] = &["m", "cm", "mm", "in"];
const TURN_RATES: &[&str] = &["rpm", "rad_s", "deg_s", "rps"];

fn signal(series: &Series) -> Option<Signal> {
    let column = Column::of(series);
    let is_other = column.has(&["min", "max", "covariance", "imu", "status"])
        || series.name.ends_with("field_of_view");
    if is_other {
        return None;
    }
    let found = column.twist().or_else(|| column.pose());
    found.or_else(|| column.range()).or_else(|| column.wheel())
}

/// A column, and what its name says.
struct Column<'a> {
    series: &'a Series,
    words: Vec<String>,
    is_left: Option<bool>,
    largest: f64,
    /// Of a message of ROS, whose units are those of REP 103.
    is_ros: bool,
}

impl<'a> Column<'a> {
    fn of(series: &'a Series) -> Column<'a> {
        let words = words(&series.name);
        let sizes = series.samples.iter().map(|(_, value)| value.abs());
        Column {
            series,
            is_left: side(&words),
            words,
            largest: sizes.fold(0.0, f64::max),
            is_ros: series.kind.contains('/'),
        }
    }

    fn has(&self, list: &[&str]) -> bool {
        has(&self.words, list)
    }

    fn last(&self) -> &str {
        self.words.last().map_or("", String::as_str)
    }

    fn says(&self, units: &[&'static str]) -> Option<&'static str> {
        let units: Vec<_> = units.iter().map(|unit| (*unit, 1.0)).collect();
        unit(self.series, &units).map(|(unit, _)| unit)
    }

    fn twist(&self) -> Option<Signal> {
        let is_command = self.has(&["cmd"]);
        let (stem, unit) = match self.last() {
            "x" if self.has(&["linear"]) && is_command => ("forward_ref", "m_s"),
            "x" if self.has(&["linear"]) => ("forward", "m_s"),
            "z" if self.has(&["angular"]) && is_command => ("yaw_ref", "rad_s"),
            "z" if self.has(&["angular"]) => ("yaw", "rad_s"),
            _ => return None,
        };
        Some((stem, unit, None, self.is_ros))
    }

    fn pose(&self) -> Option<Signal> {
        let mut words = self.words.iter().rev().map(String::as_str);
        let bare =
            words.find(|word| !["m", "cm", "mm", "in", "rad", "deg", "degrees"].contains(word));
        let of_place =
            self.has(&["position", "pose", "pos", "odom", "odometry"]) || self.words.len() <= 2;
        let (stem, unit, likely) = match bare? {
            "x" | "y" if !of_place || self.has(&["orientation", "linear", "angular"]) => {
                return None;
            }
            "x" => ("x", self.says(LENGTHS), "m"),
            "y" => ("y", self.says(LENGTHS), "m"),
            "yaw" | "heading" | "theta" | "rumbo" if self.is_left.is_none() => {
                let is_small = self.is_ros || self.largest < 7.0;
                let likely = if is_small { "rad" } else { "deg" };
                ("heading", self.says(&["rad", "deg"]), likely)
            }
            _ => return None,
        };
        let is_sure = self.is_ros || unit.is_some();
        Some((stem, unit.unwrap_or(likely), None, is_sure))
    }

    fn range(&self) -> Option<Signal> {
        let is_range = match self.series.kind.ends_with("/Range") {
            true => self.last() == "range",
            false => self.has(RANGES) && !self.has(REFERENCES),
        };
        if !is_range {
            return None;
        }
        let unit = self.says(LENGTHS);
        let is_small = self.is_ros || self.largest <= 10.0;
        let likely = if is_small { "m" } else { "cm" };
        let is_left = self.is_left.or_else(|| side(&words(&self.series.frame)));
        let stem = match is_left {
            Some(true) => "range_left",
            Some(false) => "range_right",
            None => "range_front",
        };
        let says_where = is_left.is_some() || self.has(FRONT) || self.words.len() <= 2;
        let is_sure = self.is_ros || unit.is_some() && says_where;
        Some((stem, unit.unwrap_or(likely), None, is_sure))
    }

    fn wheel(&self) -> Option<Signal> {
        let [wheel, reference] = match self.is_left? {
            true => ["left", "left_ref"],
            false => ["right", "right_ref"],
        };
        let rate = self.says(TURN_RATES);
        let is_speed = self.has(SPEEDS) || rate.is_some();
        if self.has(REFERENCES) {
            let signal = (reference, rate.unwrap_or("rpm"), None, rate.is_some());
            return is_speed.then_some(signal);
        }
        if self.has(PWMS) {
            let likely = if self.largest <= 1.0 { "duty" } else { "pwm" };
            let unit = self.says(&["pwm", "percent"]).unwrap_or(likely);
            return Some((wheel, unit, None, self.has(&["pwm"]) && self.largest > 1.0));
        }
        if self.has(COUNTS) {
            return Some((wheel, "turn", Some("COUNTS"), false));
        }
        let is_joint = self.series.kind.ends_with("/JointState");
        if !is_speed {
            let is_angle = is_joint && self.last() == "position";
            return is_angle.then_some((wheel, "rad", None, true));
        }
        if self.says(&["m_s", "mm_s", "cm_s"]).is_some() {
            return Some((wheel, "rad_s", Some("RADIUS"), false));
        }
        let likely = if self.is_ros { "rad_s" } else { "rpm" };
        // A speed of a joint is in rad/s, one of a plain number in anything.
        Some((
            wheel,
            rate.unwrap_or(likely),
            None,
            rate.is_some() || is_joint,
        ))
    }
}

fn has(words: &[String], list: &[&str]) -> bool {
    words.iter().any(|word| list.contains(&word.as_str()))
}

/// Whether it is that on the left, where the words say one side.
fn side(words: &[String]) -> Option<bool> {
    match (has(words, LEFT), has(words, RIGHT)) {
        (true, false) => Some(true),
        (false, true) => Some(false),
        _ => None,
    }
}

/// `Left Speed (rpm)`, `leftSpeed_rpm`, `speedL`: words in small letters.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        if c == '%' {
            words.push("percent".into());
        } else if c.is_alphanumeric() {
            let is_new = !before.is_alphanumeric()
                || before.is_lowercase() && c.is_uppercase()
                || before.is_numeric() != c.is_numeric();
            match words.last_mut().filter(|_| !is_new) {
                Some(word) => word.extend(c.to_lowercase()),
                None => words.push(c.to_lowercase().collect()),
            }
        }
        before = c;
    }
    words
}
