//! Repairs how functions reach arguments that their caller left on the stack.
//!
//! LLVM 22 takes a return address for two bytes. On this chip it has three, and so a function without room for all
//! its arguments in registers reads the rest one byte too low (rust-lang/rust#149223 shows what comes of it). The
//! instructions are these, in functions whose prologue pushes `pushes` registers and makes a frame of `frame` bytes:
//!
//! - `ldd r, Y+q` and `std Y+q, r` with q at least `frame + pushes + 3`, where the return address still is;
//! - the same farther away, with Y moved there and back around it by `adiw`/`sbiw` or `subi`, `sbci`.
//!
//! All of them become one byte larger, in place. Whoever meets something else stops: a wrong image is worse than none.

/// What arguments lie above: the return address as the compiler has it, and the byte that the stack pointer points at.
const TAKEN_FOR: u16 = 2 + 1;
/// Largest displacement of one instruction.
const FARTHEST: u16 = 63;

const IN_R28_SPL: u16 = 0xB7CD;
const IN_R29_SPH: u16 = 0xB7DE;
const OUT_SPL_R28: u16 = 0xBFCD;

/// An instruction that this module has to do with.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Push,
    /// Y goes up by so much: `adiw`; down: `sbiw`, negative.
    Move(i32),
    /// `subi r28, low`.
    SubtractLow(u8),
    /// `sbci r29, high`.
    SubtractHigh(u8),
    /// A load or store at Y + q.
    Access(u16),
    /// The stack pointer is given back: the epilogue.
    Release,
    Other,
}

fn decode(word: u16) -> Op {
    let word_immediate = i32::from((word >> 2 & 0x30) | (word & 0xF));
    let byte_immediate = ((word >> 4 & 0xF0) | (word & 0xF)) as u8;
    match word {
        OUT_SPL_R28 => Op::Release,
        _ if word & 0xFE0F == 0x920F => Op::Push,
        _ if word & 0xFF30 == 0x9620 => Op::Move(word_immediate),
        _ if word & 0xFF30 == 0x9720 => Op::Move(-word_immediate),
        _ if word & 0xF0F0 == 0x50C0 => Op::SubtractLow(byte_immediate),
        _ if word & 0xF0F0 == 0x40D0 => Op::SubtractHigh(byte_immediate),
        _ if word & 0xD008 == 0x8008 => {
            Op::Access((word >> 8 & 0x20) | (word >> 7 & 0x18) | (word & 7))
        }
        _ => Op::Other,
    }
}

/// Words of the instruction that begins with `word`.
fn length(word: u16) -> usize {
    let long = word & 0xFE0C == 0x940C || word & 0xFC0F == 0x9000;
    if long { 2 } else { 1 }
}

fn with_displacement(word: u16, q: u16) -> u16 {
    word & !0x2C07 | (q & 0x20) << 8 | (q & 0x18) << 7 | q & 7
}

fn with_byte_immediate(word: u16, value: u8) -> u16 {
    word & 0xF0F0 | u16::from(value & 0xF0) << 4 | u16::from(value & 0xF)
}

/// A change of Y: where its first word is, by how much Y goes up, and whether it takes two words.
#[derive(Clone, Copy, Debug)]
struct Shift {
    at: usize,
    by: i32,
    pair: bool,
}

impl Shift {
    fn read(words: &[u16], at: usize) -> Option<Self> {
        let next = words.get(at + 1).copied().map_or(Op::Other, decode);
        match (decode(words[at]), next) {
            (Op::Move(by), _) => Some(Self {
                at,
                by,
                pair: false,
            }),
            (Op::SubtractLow(low), Op::SubtractHigh(high)) => Some(Self {
                at,
                by: -i32::from(i16::from_le_bytes([low, high])),
                pair: true,
            }),
            _ => None,
        }
    }

    /// The same change, one byte larger.
    fn grow(self, words: &mut [u16]) -> Result<(), String> {
        let by = self.by + self.by.signum();
        if self.pair {
            let [low, high] = ((-by) as i16).to_le_bytes();
            words[self.at] = with_byte_immediate(words[self.at], low);
            words[self.at + 1] = with_byte_immediate(words[self.at + 1], high);
            return Ok(());
        }
        let size = by.unsigned_abs() as u16;
        if size > FARTHEST {
            return Err(format!("no room to move Y by {by}"));
        }
        words[self.at] = words[self.at] & 0xFF30 | (size & 0x30) << 2 | size & 0xF;
        Ok(())
    }
}

/// Repairs one function, given its words; says how many accesses were wrong.
pub(crate) fn repair(words: &mut [u16]) -> Result<usize, String> {
    let pushes = words
        .iter()
        .take_while(|word| decode(**word) == Op::Push)
        .count();
    if words.get(pushes..pushes + 2) != Some(&[IN_R28_SPL, IN_R29_SPH]) {
        return Ok(0);
    }
    let mut at = pushes + 2;
    let mut frame = 0;
    if let Some(shift) = words
        .get(at)
        .and_then(|_| Shift::read(words, at))
        .filter(|shift| shift.by < 0)
    {
        frame = shift.by.unsigned_abs() as usize;
        at += if shift.pair { 2 } else { 1 };
        // The stack pointer follows; that is no epilogue.
        while words.get(at).is_some_and(|word| *word != OUT_SPL_R28) {
            at += 1;
        }
        at += 1;
    }
    let first = (frame + pushes) as i32 + i32::from(TAKEN_FOR);
    let mut repaired = 0;
    let mut open: Option<Shift> = None;
    let mut inside: Vec<usize> = Vec::new();
    while at < words.len() {
        let word = words[at];
        match (decode(word), open) {
            (Op::Access(q), None) if i32::from(q) >= first => {
                if q == FARTHEST {
                    return Err(format!("no room to reach beyond Y+{q}"));
                }
                words[at] = with_displacement(word, q + 1);
                repaired += 1;
            }
            (Op::Access(_), Some(_)) => inside.push(at),
            (Op::Release, _) => (open, inside) = (None, Vec::new()),
            _ => {
                if let Some(shift) = Shift::read(words, at) {
                    if let Some(opening) = open.take() {
                        if opening.by + shift.by != 0 {
                            return Err(format!("Y moves by {} and by {}", opening.by, shift.by));
                        }
                        repaired += repair_far(words, opening, shift, &inside, first)?;
                        inside.clear();
                    } else {
                        open = Some(shift);
                    }
                    at += usize::from(shift.pair);
                }
            }
        }
        at += length(word);
    }
    Ok(repaired)
}

/// Accesses between two moves of Y.
fn repair_far(
    words: &mut [u16],
    there: Shift,
    back: Shift,
    accesses: &[usize],
    first: i32,
) -> Result<usize, String> {
    let displacement = |word: u16| match decode(word) {
        Op::Access(q) => q,
        _ => 0,
    };
    let beyond = accesses
        .iter()
        .filter(|at| there.by + i32::from(displacement(words[**at])) >= first)
        .count();
    if beyond == 0 {
        return Ok(0);
    }
    if beyond != accesses.len() {
        return Err("an access across the border of the frame".to_owned());
    }
    let fits = accesses
        .iter()
        .all(|at| displacement(words[*at]) < FARTHEST);
    if fits {
        for at in accesses {
            words[*at] = with_displacement(words[*at], displacement(words[*at]) + 1);
        }
    } else {
        there.grow(words)?;
        back.grow(words)?;
    }
    Ok(beyond)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PUSH_R28: u16 = 0x93CF;
    const PUSH_R29: u16 = 0x93DF;
    const LDD_R22_Y5: u16 = 0x816D;
    const LDD_R22_Y6: u16 = 0x816E;
    const RET: u16 = 0x9508;

    #[test]
    fn an_argument_on_the_stack_lies_above_three_bytes_of_return_address() {
        let mut words = [PUSH_R28, PUSH_R29, IN_R28_SPL, IN_R29_SPH, LDD_R22_Y5, RET];
        assert_eq!(repair(&mut words), Ok(1));
        assert_eq!(words[4], LDD_R22_Y6);
    }

    #[test]
    fn locals_stay_where_they_are() {
        // sbiw r28, 2; in r0, 0x3f; cli; out 0x3e, r29; out 0x3f, r0; out 0x3d, r28; ldd r22, Y+5
        let frame = [0x9722, 0xB60F, 0x94F8, 0xBFDE, 0xBE0F, OUT_SPL_R28];
        let mut words = [
            &[PUSH_R28, PUSH_R29, IN_R28_SPL, IN_R29_SPH][..],
            &frame,
            &[LDD_R22_Y5, RET],
        ]
        .concat();
        let before = words.clone();
        assert_eq!(repair(&mut words), Ok(0));
        assert_eq!(words, before);
    }

    #[test]
    fn without_a_frame_pointer_nothing_is_touched() {
        let mut words = [LDD_R22_Y5, RET];
        assert_eq!(repair(&mut words), Ok(0));
        assert_eq!(words[0], LDD_R22_Y5);
    }

    #[test]
    fn a_far_argument_is_reached_by_moving_y_farther() {
        // adiw r28, 8; ldd r24, Y+62; ldd r25, Y+63; sbiw r28, 8
        let mut words = [
            PUSH_R28, PUSH_R29, IN_R28_SPL, IN_R29_SPH, 0x9628, 0xAD8E, 0xAD9F, 0x9728, RET,
        ];
        assert_eq!(repair(&mut words), Ok(2));
        assert_eq!(words[4..8], [0x9629, 0xAD8E, 0xAD9F, 0x9729]);
    }
}
