//! What is said of runs and hand-ins. Reports have it in other languages by its kind.

use rumbo_control::Fault;
use rumbo_sim::mega;
use rumbo_wire::Refusal;
use serde::{Serialize, Serializer};

rumbo_sim::notes! {
    /// Why a run did not pass, how its program ended, or what else its reader should know.
    Note {
        Fault { at_s: f64, fault: Fault } "at {at_s:.2} s fault: {fault}";
        Refused { at_s: f64, command: String, why: Refusal } "at {at_s:.2} s {command} was refused: {why}";
        Limit { metric: String, why: String } "{metric}{why}";
        Program { name: String, note: mega::Note } "firmware {name}: {note}";
        Robot { name: String, note: Box<Note> } "{name}: {note}";
        TooManyEdges { most: f64 } "it switches the robot's pins more than {most} times a second, which no motor follows; the run was ended";
        NeverTurned { pwm: u16 } "it drove the motors, by a PWM of at most {pwm} of 255, and no wheel turned: that is too little for [plant.motor] at [plant.battery] of the robot's file";
        StoodStill { from_s: f64, for_s: f64, pwm: u16 } "it drove the motors from {from_s:.1} s on for {for_s:.1} s, by a PWM of at most {pwm} of 255, and no wheel turned: that is too little for [plant.motor] at [plant.battery] of the robot's file";
        LostLine { at_s: f64, speed_m_s: f64 } "it lost its line at {at_s:.1} s, at {speed_m_s:.2} m/s; if yours is slower, or its sensors are elsewhere, say its motors, its battery and their places: --motor, --battery and --sensors of `rumbo new robot`, or the robot's file";
        HandedInAsImage {} "handed in as an image: its compiler is not known";
        HandedInLate {} "handed in late, as its name says";
        OtherCompiler { what: &'static str, is: String, wanted: String } "compiled with {what} {is}; the assignment's marks are for {wanted}";
        BusyWaits { count: u64, function: String } "it waits {count} times, the longest time in {function}";
        LongInterrupt { name: String, cycles: u64, count: u64 } "interrupt {name} takes {cycles} cycles at most, in {count} calls";
        CalledForCycles { function: String, caller: String, cycles: u64 } "{function} is called by {caller}, {cycles} cycles in all";
        CalledTimes { function: String, caller: String, calls: u64 } "{function} is called by {caller}, {calls} times in all";
        Other { text: String } "{text}";
    }
}

impl From<String> for Note {
    fn from(text: String) -> Self {
        Self::Other { text }
    }
}

impl Serialize for Note {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
