//! Failures of a run's program or robot, and notes beside them, in the reader's language: English as the command line
//! prints it, Spanish by the kind of the note (`content/es/messages.md`). A note of a kind without Spanish stays English.

use crate::text::{Language, escape, quoted, with};
use crate::words;
use rumbo_experiment::note::Note;

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

/// A note as a complaint, in a language.
pub(crate) fn complaint(language: Language, note: &Note) -> Complaint {
    let own = |own| Complaint {
        own,
        english: String::new(),
    };
    match language {
        Language::English => own(note.to_string()),
        Language::Spanish => in_spanish(note).unwrap_or_else(|| Complaint {
            own: String::new(),
            english: note.to_string(),
        }),
    }
}

fn in_spanish(note: &Note) -> Option<Complaint> {
    let (mut values, mut english) = (note.values(), String::new());
    match note {
        Note::Fault { at_s, fault } => {
            let why = spanish(&format!("Fault::{fault:?}"))?.to_owned();
            values = vec![("at_s", Language::Spanish.number(*at_s, 2)), ("why", why)];
        }
        Note::Refused { at_s, command, why } => {
            let why = spanish(&format!("Refusal::{why:?}"))?.to_owned();
            let at_s = Language::Spanish.number(*at_s, 2);
            values = vec![("at_s", at_s), ("command", command.clone()), ("why", why)];
        }
        Note::Program { name, note } => {
            let why = with(spanish(note.kind())?, &note.values());
            // Location and call stack are names and numbers of the program and stay as they are.
            let detail = note
                .values()
                .into_iter()
                .find(|(name, _)| *name == "detail");
            english.extend(detail.map(|(_, detail)| detail));
            values = vec![("name", name.clone()), ("note", why)];
        }
        Note::Robot { name, note } => {
            let note = in_spanish(note)?;
            (values, english) = (
                vec![("name", name.clone()), ("note", note.own)],
                note.english,
            );
        }
        _ => {}
    }
    let own = with(spanish(note.kind())?, &values);
    Some(Complaint { own, english })
}

/// A text of `content/es/messages.md`.
fn spanish(name: &str) -> Option<&'static str> {
    let messages = words::messages().ok()?;
    messages.get(name).map(String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::Fault;
    use rumbo_sim::mega;
    use rumbo_wire::Refusal;

    #[test]
    fn every_kind_of_note_but_limits_and_free_texts_has_its_spanish_and_nothing_else_has() {
        let faults = Fault::ALL.map(|fault| format!("Fault::{fault:?}"));
        let refusals = Refusal::ALL.map(|refusal| format!("Refusal::{refusal:?}"));
        let kinds = [Note::KINDS, mega::Note::KINDS].concat();
        let kinds = kinds
            .iter()
            .filter(|kind| !["Limit", "Other"].contains(kind));
        let mut due = [&faults[..], &refusals].concat();
        due.extend(kinds.map(ToString::to_string));
        due.sort();
        let known: Vec<_> = words::messages().unwrap().keys().cloned().collect();
        assert_eq!(known, due);
    }

    #[test]
    fn notes_are_translated_with_their_values_and_details_of_a_program_stay_english() {
        let spanish = |note: &Note| complaint(Language::Spanish, note);
        let fault = Note::Fault {
            at_s: 1.2,
            fault: Fault::BatteryLow,
        };
        assert_eq!(
            spanish(&fault).own,
            "a los 1,20 s, fallo: batería baja: cárgala"
        );
        let of_program = |note| Note::Program {
            name: "mine.elf".into(),
            note,
        };
        let detail = "stack overflow at loop+4 in cycle 12: 900 bytes deep".to_owned();
        let end = of_program(mega::Note::StackOverflow {
            detail: detail.clone(),
        });
        let own = "imagen mine.elf: la pila del programa creció hasta sus datos".into();
        let english = detail;
        assert_eq!(spanish(&end), Complaint { own, english });
        let link = of_program(mega::Note::OtherLink {
            link: "Serial1",
            wiring: "final".into(),
            others: "Serial (USB), Serial3".into(),
        });
        let own = "imagen mine.elf: no llegó nada por el enlace Bluetooth, Serial1 en el cableado final; sí por Serial (USB), \
                   Serial3";
        assert_eq!(spanish(&link).own, own);
        let free = Note::from("something new".to_owned());
        let english = "something new".to_owned();
        let own = String::new();
        assert_eq!(spanish(&free), Complaint { own, english });
    }
}
