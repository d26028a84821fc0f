//! Failures of a run's program or robot, and notes beside them, in the reader's language.
//!
//! A failure is an English line, as the command line prints it. There are few kinds of lines; faults and refusals have
//! fixed wordings, translated in `content/es/messages.md`. A line without a translation (from a newer program) is
//! shown as it is.

use crate::text::{Language, escape, quoted, with};
use crate::words;
use rumbo_control::Fault;
use rumbo_wire::Refusal;

/// A complaint as shown: the part in the reader's language, and the part that follows in English.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Complaint {
    pub(crate) own: String,
    pub(crate) english: String,
}

impl Complaint {
    /// As a line.
    #[cfg(feature = "host")]
    pub(crate) fn text(self) -> String {
        match (self.own.is_empty(), self.english.is_empty()) {
            (_, true) => self.own,
            (true, false) => self.english,
            (false, false) => format!("{} ({})", self.own, self.english),
        }
    }

    /// As HTML.
    pub(crate) fn html(&self) -> String {
        let english = escape(&self.english);
        let span = format!("<span lang=\"en\" translate=\"no\">{english}</span>");
        match (self.own.is_empty(), english.is_empty()) {
            (_, true) => quoted(&self.own),
            (true, false) => span,
            (false, false) => format!("{} ({span})", quoted(&self.own)),
        }
    }
}

/// The complaint that a line makes, in a language.
pub(crate) fn complaint(language: Language, line: &str) -> Complaint {
    let spanish = match language {
        Language::English => None,
        Language::Spanish => of_robot(line)
            .or_else(|| of_image(line))
            .or_else(|| of_note(line)),
    };
    match (spanish, language) {
        (Some(complaint), _) => complaint,
        (None, Language::English) => Complaint {
            own: line.into(),
            english: String::new(),
        },
        (None, Language::Spanish) => Complaint {
            own: String::new(),
            english: line.into(),
        },
    }
}

/// `at 1.20 s fault: ...`, `at 1.20 s ... was refused: ...`.
fn of_robot(line: &str) -> Option<Complaint> {
    let (at_s, what) = line.strip_prefix("at ")?.split_once(" s ")?;
    let seconds = at_s.replace('.', ",");
    let own = match what.strip_prefix("fault: ") {
        Some(why) => {
            let fault = Fault::ALL
                .into_iter()
                .find(|fault| fault.explanation() == why)?;
            let why = spanish(&format!("Fault::{fault:?}"))?;
            with(spanish("fault")?, &[("seconds", &seconds), ("why", why)])
        }
        None => {
            let (command, why) = what.rsplit_once(" was refused: ")?;
            let refusal = Refusal::ALL
                .into_iter()
                .find(|refusal| refusal.explanation() == why)?;
            let why = spanish(&format!("Refusal::{refusal:?}"))?;
            let values = [
                ("seconds", seconds.as_str()),
                ("command", command),
                ("why", why),
            ];
            with(spanish("refused")?, &values)
        }
    };
    Some(Complaint {
        own,
        english: String::new(),
    })
}

/// How a program ended: the beginning of the emulator's message, and its name in `messages.md`.
const ENDS: [(&str, &str); 3] = [
    ("ran into erased flash at ", "erased-flash"),
    ("illegal instruction ", "illegal-instruction"),
    ("stack overflow at ", "stack-overflow"),
];

/// `firmware NAME: ...`: how its program ended. Location and call stack are names and numbers of the program and stay
/// as they are.
fn of_image(line: &str) -> Option<Complaint> {
    let (name, verdict) = line.strip_prefix("firmware ")?.split_once(": ")?;
    let (_, end) = ENDS
        .into_iter()
        .find(|(english, _)| verdict.starts_with(english))?;
    let values = [("name", name), ("why", spanish(end)?)];
    Some(Complaint {
        own: with(spanish("image")?, &values),
        english: verdict.into(),
    })
}

/// Notes beside a run or a hand-in, with names where values stand, and their names in `messages.md`.
const NOTES: [(&str, &str); 15] = [
    (
        "firmware {name}: it never drove a motor; are its pins those of wiring {wiring}? (docs/emulator.md)",
        "no-motor",
    ),
    (
        "firmware {name}: nothing came over the Bluetooth link, {link} in wiring {wiring}, on no other either",
        "no-link",
    ),
    (
        "firmware {name}: nothing came over the Bluetooth link, {link} in wiring {wiring}, but on {others}",
        "other-link",
    ),
    (
        "firmware {name}: a trigger of a sonar was high for {us} us; the HC-SR04's data sheet asks for 10 us, and some modules do not answer a shorter one",
        "short-trigger",
    ),
    (
        "firmware {name}: the supply fell too low and reset the chip {times} times; start the motors more gently, or charge the battery",
        "brown-outs",
    ),
    (
        "firmware {name}: the watchdog reset the chip {times} times; call wdt_reset() in time, or wdt_disable() at the start of setup()",
        "watchdog-resets",
    ),
    (
        "firmware {name}: it sends over the Bluetooth link at {sent} baud; the module is set to {own}, and what it passes on is garbage: give begin() that rate",
        "link-rate",
    ),
    (
        "handed in as an image: its compiler is not known",
        "image-handed-in",
    ),
    ("handed in late, as its name says", "handed-in-late"),
    (
        "compiled with {what} {is}; the assignment's marks are for {wanted}",
        "other-compiler",
    ),
    (
        "it switches the robot's pins more than {most} times a second, which no motor follows; the run was ended",
        "too-many-edges",
    ),
    (
        "it waits {count} times, the longest time in {function}",
        "busy-waits",
    ),
    (
        "interrupt {name} takes {cycles} cycles at most, in {count} calls",
        "long-interrupt",
    ),
    (
        "{function} is called by {caller}, {cycles} cycles in all",
        "called-for-cycles",
    ),
    (
        "{function} is called by {caller}, {calls} times in all",
        "called-times",
    ),
];

/// One of [`NOTES`].
fn of_note(line: &str) -> Option<Complaint> {
    let (values, name) = NOTES
        .iter()
        .find_map(|(form, name)| Some((values(form, line)?, name)))?;
    Some(Complaint {
        own: with(spanish(name)?, &values),
        english: String::new(),
    })
}

/// What stands in a line where a form has names.
fn values<'a>(form: &'static str, line: &'a str) -> Option<Vec<(&'static str, &'a str)>> {
    let mut values = Vec::new();
    let (before, mut form) = form.split_once('{').unwrap_or((form, ""));
    let mut line = line.strip_prefix(before)?;
    while let Some((name, rest)) = form.split_once('}') {
        let (between, next) = rest.split_once('{').unwrap_or((rest, ""));
        let (value, after) = match next.is_empty() {
            true => (line.strip_suffix(between)?, ""),
            false => line.split_once(between)?,
        };
        values.push((name, value));
        (form, line) = (next, after);
    }
    line.is_empty().then_some(values)
}

/// A text of `content/es/messages.md`.
fn spanish(name: &str) -> Option<&'static str> {
    let messages = words::messages().ok()?;
    messages.get(name).map(String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_and_refusals_are_translated_whole_and_left_alone_in_english() {
        let faults = Fault::ALL.map(|fault| format!("at 1.20 s fault: {}", fault.explanation()));
        let refusals = Refusal::ALL
            .map(|refusal| format!("at 0.50 s ON was refused: {}", refusal.explanation()));
        for line in faults.iter().chain(&refusals) {
            let spanish = complaint(Language::Spanish, line);
            assert!(
                spanish.own.starts_with("a los ") && spanish.english.is_empty(),
                "{line}: {spanish:?}"
            );
            assert_eq!(&complaint(Language::English, line).own, line);
        }
    }

    #[test]
    fn how_an_image_ended_is_translated_but_for_the_location_in_the_program() {
        let line = "firmware mine.elf: stack overflow at loop+4 in cycle 12: 900 bytes deep";
        let complaint = complaint(Language::Spanish, line);
        assert_eq!(
            complaint.own,
            "imagen mine.elf: la pila del programa creció hasta sus datos"
        );
        assert!(complaint.english.contains("loop+4"));
    }

    #[test]
    fn notes_are_translated_with_their_values_and_others_stay() {
        let name = "a: but on b";
        for (line, own) in [
            (
                format!("firmware {name}: it never drove a motor; are its pins those of wiring mode_1? (docs/emulator.md)"),
                "no movió ningún motor; ¿son sus pines los del cableado mode_1?",
            ),
            (
                format!("firmware {name}: nothing came over the Bluetooth link, Serial1 in wiring final, but on Serial (USB), Serial3"),
                "no llegó nada por el enlace Bluetooth, Serial1 en el cableado final; sí por Serial (USB), Serial3",
            ),
            (
                format!("firmware {name}: nothing came over the Bluetooth link, Serial1 in wiring final, on no other either"),
                "no llegó nada por el enlace Bluetooth, Serial1 en el cableado final, ni por otro",
            ),
            (
                format!("firmware {name}: a trigger of a sonar was high for 9.5 us; the HC-SR04's data sheet asks for 10 us, and some modules do not answer a shorter one"),
                "un disparo de sonar estuvo en alto 9.5 us",
            ),
            (
                format!("firmware {name}: the supply fell too low and reset the chip 11 times; start the motors more gently, or charge the battery"),
                "reinició el microcontrolador 11 veces",
            ),
            (
                format!("firmware {name}: the watchdog reset the chip 16 times; call wdt_reset() in time, or wdt_disable() at the start of setup()"),
                "el watchdog reinició el microcontrolador 16 veces",
            ),
            (
                format!("firmware {name}: it sends over the Bluetooth link at 38462 baud; the module is set to 9600, and what it passes on is garbage: give begin() that rate"),
                "envía por el enlace Bluetooth a 38462 baudios",
            ),
            (
                "handed in as an image: its compiler is not known".into(),
                "entregado como imagen: no se conoce su compilador",
            ),
            (
                "compiled with avr-gcc 7.3; the assignment's marks are for 5.4.0".into(),
                "compilado con avr-gcc 7.3; las calificaciones del enunciado son para 5.4.0",
            ),
            (
                "it switches the robot's pins more than 25000 times a second, which no motor follows; the run was ended".into(),
                "conmuta los pines del robot más de 25000 veces por segundo",
            ),
            (
                "it waits 40 times, the longest time in delay".into(),
                "espera 40 veces, la más larga en delay",
            ),
            (
                "interrupt TIMER1_COMPA takes 900 cycles at most, in 12 calls".into(),
                "la interrupción TIMER1_COMPA tarda 900 ciclos como máximo, en 12 llamadas",
            ),
            (
                "__mulsf3 is called by filter, 900 cycles in all".into(),
                "filter llama a __mulsf3, 900 ciclos en total",
            ),
            (
                "malloc is called by loop, 9 times in all".into(),
                "loop llama a malloc, 9 veces en total",
            ),
        ] {
            let spanish = complaint(Language::Spanish, &line);
            assert!(spanish.own.contains(own) && spanish.english.is_empty(), "{line}: {spanish:?}");
            assert!(!spanish.own.contains("{{"), "{spanish:?}");
        }
    }

    #[test]
    fn every_message_is_one_of_a_fault_a_refusal_an_end_or_a_note() {
        let faults = Fault::ALL.map(|fault| format!("Fault::{fault:?}"));
        let refusals = Refusal::ALL.map(|refusal| format!("Refusal::{refusal:?}"));
        let ends = ENDS.map(|(_, name)| name.to_owned());
        let lines = ["fault", "refused", "image"].map(String::from);
        let notes = NOTES.map(|(_, name)| name.to_owned());
        let mut due = [&faults[..], &refusals, &ends, &notes, &lines].concat();
        due.sort();
        let known: Vec<_> = words::messages().unwrap().keys().cloned().collect();
        assert_eq!(known, due);
    }

    #[test]
    fn a_line_of_no_known_kind_stays_english() {
        let complaint = complaint(Language::Spanish, "something new");
        assert_eq!(
            (complaint.own.as_str(), complaint.english.as_str()),
            ("", "something new")
        );
    }
}
