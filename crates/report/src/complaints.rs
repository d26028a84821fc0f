//! What a run's program or robot complained of, in the reader's language.
//!
//! A failure is an English line, as the command line prints it. The kinds of lines are few; a fault and a refusal say the same words each
//! time. What has no Spanish (a line of a newer program) is shown as it is.

use crate::text::Language;
use rumbo_control::Fault;
use rumbo_wire::Refusal;

/// A complaint as it is shown: what is in the reader's language, and what follows it in English.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Complaint {
    pub(crate) own: String,
    pub(crate) english: String,
}

/// A line in a language.
pub(crate) fn told(language: Language, line: &str) -> Complaint {
    let spanish = match language {
        Language::English => None,
        Language::Spanish => of_robot(line).or_else(|| of_image(line)),
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
    let at_s = at_s.replace('.', ",");
    let own = match what.strip_prefix("fault: ") {
        Some(why) => {
            let fault = Fault::ALL
                .into_iter()
                .find(|fault| fault.explanation() == why)?;
            format!("a los {at_s} s, fallo: {}", fault_in_spanish(fault))
        }
        None => {
            let (command, why) = what.rsplit_once(" was refused: ")?;
            let refusal = Refusal::ALL
                .into_iter()
                .find(|refusal| refusal.explanation() == why)?;
            format!(
                "a los {at_s} s se rechazó {command}: {}",
                refusal_in_spanish(refusal)
            )
        }
    };
    Some(Complaint {
        own,
        english: String::new(),
    })
}

/// `firmware NAME: ...`: how its program ended. Where it was and how it came there are names and numbers of the program.
fn of_image(line: &str) -> Option<Complaint> {
    let (name, verdict) = line.strip_prefix("firmware ")?.split_once(": ")?;
    let ends = [
        (
            "ran into erased flash at ",
            "el programa entró en memoria flash borrada",
        ),
        (
            "illegal instruction ",
            "el programa llegó a una instrucción que no existe",
        ),
        (
            "stack overflow at ",
            "la pila del programa creció hasta sus datos",
        ),
    ];
    let (_, spanish) = ends
        .into_iter()
        .find(|(english, _)| verdict.starts_with(english))?;
    Some(Complaint {
        own: format!("imagen {name}: {spanish}"),
        english: verdict.into(),
    })
}

const fn fault_in_spanish(fault: Fault) -> &'static str {
    match fault {
        Fault::LinkLost => {
            "enlace perdido: no llegó a tiempo ningún latido; compruebe la conexión, borre el fallo y vuelva a armar"
        }
        Fault::SonarFaulty => {
            "sensor averiado: su línea de eco calla o da valores imposibles; compruebe su cableado"
        }
        Fault::SonarStale => {
            "sensor sin lecturas: ninguna buena durante demasiado tiempo; ¿hay algo que absorba el eco?"
        }
        Fault::WallLost => {
            "pared perdida: no hay nada al alcance del sensor; ponga el robot frente a una pared"
        }
        Fault::LeftEncoderSilent => {
            "encoder izquierdo en silencio: la rueda recibe PWM y no gira, o su sensor está cortado"
        }
        Fault::RightEncoderSilent => {
            "encoder derecho en silencio: la rueda recibe PWM y no gira, o su sensor está cortado"
        }
        Fault::BatteryLow => "batería baja: cárguela",
        Fault::NotFinite => "un valor no era un número finito; restablezca los parámetros",
        Fault::Overrun => "un periodo de control duró demasiado",
        Fault::Blocked => {
            "bloqueado: hay algo en el camino; despéjelo o gire el robot, borre el fallo y vuelva a armar"
        }
        Fault::LeftEncoderImplausible => {
            "encoder izquierdo no creíble: pierde flancos o capta ruido; compruebe sus cables, su masa y la distancia entre sensor e imán"
        }
        Fault::RightEncoderImplausible => {
            "encoder derecho no creíble: pierde flancos o capta ruido; compruebe sus cables, su masa y la distancia entre sensor e imán"
        }
    }
}

const fn refusal_in_spanish(refusal: Refusal) -> &'static str {
    match refusal {
        Refusal::NotFinite => "el valor no es un número finito; envíe un número",
        Refusal::OutOfRange => "el valor está fuera de los límites, que muestra `rumbo list`",
        Refusal::UnknownParam => "no existe tal parámetro; `rumbo list` los muestra",
        Refusal::NotInThisMode => "el modo elegido no admite esa orden; elija el que sí la admite",
        Refusal::Armed => "no puede hacerse con el robot armado; desármelo antes",
        Refusal::Faulted => "hay un fallo retenido; elimine su causa y bórrelo antes",
        Refusal::SonarNotReady => {
            "el sensor que necesita este modo no da buenas lecturas; compruebe su cableado"
        }
        Refusal::NoLink => "al robot no le llega ningún latido; conéctelo y vuelva a armar",
        Refusal::Malformed => {
            "el robot no entendió la orden; use la misma versión en ambos extremos"
        }
        Refusal::BatteryLow => "la batería está baja; cárguela",
        Refusal::TooOld => {
            "es demasiado antigua: se dio hace más de 2 s, o antes de que el robot volviera a arrancar; vuelva a darla"
        }
        Refusal::NoWall => {
            "no hay ninguna pared al alcance del sensor que necesita este modo; coloque el robot a menos de 2,5 m de una"
        }
        Refusal::WrongRig => {
            "los sensores del robot no están donde los necesita este modo; móntelos así y fije el parámetro `rig`"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_and_refusals_are_told_in_spanish_whole_and_in_english_as_they_are() {
        let faults = Fault::ALL.map(|fault| format!("at 1.20 s fault: {}", fault.explanation()));
        let refusals = Refusal::ALL
            .map(|refusal| format!("at 0.50 s Arm was refused: {}", refusal.explanation()));
        for line in faults.iter().chain(&refusals) {
            let spanish = told(Language::Spanish, line);
            assert!(
                spanish.own.starts_with("a los ") && spanish.english.is_empty(),
                "{line}: {spanish:?}"
            );
            assert_eq!(&told(Language::English, line).own, line);
        }
    }

    #[test]
    fn how_an_image_ended_is_told_in_spanish_with_the_place_as_the_emulator_names_it() {
        let line = "firmware mine.elf: stack overflow at loop+4 in cycle 12: 900 bytes deep";
        let told = told(Language::Spanish, line);
        assert_eq!(
            told.own,
            "imagen mine.elf: la pila del programa creció hasta sus datos"
        );
        assert!(told.english.contains("loop+4"));
    }

    #[test]
    fn a_line_of_no_known_kind_stays_english() {
        let told = told(Language::Spanish, "something new");
        assert_eq!(
            (told.own.as_str(), told.english.as_str()),
            ("", "something new")
        );
    }
}
