//! Refuses an image with a function whose arguments do not all fit into registers.
//!
//! LLVM takes a return address for two bytes, and the ATmega2560's has three, so that a function reads what its caller
//! left on the stack one byte too low (rust-lang/rust#149223 shows one consequence). The disassembly shows such a
//! function: behind `in r28, SPL` and `in r29, SPH` it moves Y down by its frame, and then uses Y+1 to Y+frame; only
//! arguments lie above. Y also moves for a variable that is far away, with the flags kept in r0 meanwhile. Delete this
//! when LLVM is fixed.

/// Checks the output of `avr-objdump -d --no-show-raw-insn`.
pub(super) fn check(disassembly: &str) -> Result<(), String> {
    let mut function = "";
    let mut y = Y::default();
    for line in disassembly.lines() {
        if let Some((_, name)) = line.strip_suffix(">:").and_then(|it| it.split_once('<')) {
            // `__stack` and others are numbers, which objdump takes for places in the code.
            if !name.starts_with("__") {
                (function, y) = (name, Y::default());
            }
        } else if y.leaves_the_frame(line) {
            return Err(format!(
                "{:#} gets arguments on the stack, where LLVM finds them one byte too low ({}): give it fewer \
                 arguments, or several as one structure by reference; if it has few in the source, mark it or its \
                 caller #[inline(never)]",
                rustc_demangle::demangle(function),
                line.replace('\t', " ").trim(),
            ));
        }
    }
    Ok(())
}

/// The frame pointer of a function.
#[derive(Default)]
struct Y {
    /// Bytes of the frame, once Y points below it.
    frame: Option<i32>,
    /// How far it has moved since.
    moved: i32,
    /// Low byte of a move in two instructions.
    low: u8,
    /// Whether the stack pointer has followed: the frame is made.
    is_made: bool,
}

impl Y {
    /// Follows an instruction; whether that is an access above the frame.
    fn leaves_the_frame(&mut self, line: &str) -> bool {
        let mut fields = line.split('\t').skip(1).map(str::trim);
        let name = fields.next().unwrap_or_default();
        let mut operands = fields.next().unwrap_or_default().split(", ");
        let [first, second] = [(); 2].map(|()| operands.next().unwrap_or_default());
        if (name, first, second) == ("in", "r29", "0x3e") {
            *self = Self {
                frame: Some(0),
                ..Self::default()
            };
        }
        let Some(frame) = self.frame else {
            return false;
        };
        let number = second.trim_start_matches("0x");
        let number = u8::from_str_radix(number, 16).unwrap_or_default();
        match (name, first, second) {
            ("adiw", "r28", _) => self.moved += i32::from(number),
            ("sbiw", "r28", _) => self.moved -= i32::from(number),
            ("subi", "r28", _) => self.low = number,
            ("sbci", "r29", _) => {
                self.moved -= i32::from(i16::from_le_bytes([self.low, number]));
            }
            ("out", "0x3d", "r28") => {
                if !self.is_made {
                    self.frame = Some(-self.moved);
                }
                (self.moved, self.is_made) = (0, true);
            }
            // The flags are back; or code that is reached from elsewhere follows.
            ("out", "0x3f", "r0") | ("rjmp" | "jmp" | "ret", ..) if self.is_made => self.moved = 0,
            ("ldd", _, place) | ("std", place, _) => {
                let displacement = place.strip_prefix("Y+").and_then(|q| q.parse().ok());
                return displacement.is_some_and(|q: i32| self.moved + q > frame);
            }
            ("ld", _, "Y") | ("st", "Y", _) => return self.moved > frame,
            _ => {}
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::check;

    /// `fifth(f32, f32, f32, f32, fifth: f32) -> f32 { fifth }`, as LLVM 22 compiles it.
    const FIFTH: &str = "\
00000000 <fifth>:
   0:	push	r28
   2:	push	r29
   4:	in	r28, 0x3d	; 61
   6:	in	r29, 0x3e	; 62
   8:	ldd	r22, Y+5	; 0x05
  10:	pop	r29
  14:	ret";

    /// A function with ten bytes of variables and its end, and then one with 100, of which the last is far away, and
    /// where Y moves back elsewhere.
    fn with_frames(last: u8) -> String {
        format!(
            "\
00000100 <_RNvNtCs1234_13rumbo_control3pid4near>:
 100:	in	r28, 0x3d	; 61
 102:	in	r29, 0x3e	; 62
 104:	sbiw	r28, 0x0a	; 10
 106:	out	0x3e, r29	; 62
 108:	out	0x3d, r28	; 61
 10a:	std	Y+10, r25	; 0x0a
 10c:	adiw	r28, 0x0a	; 10
 10e:	out	0x3d, r28	; 61
 110:	ret
00000200 <_RNvNtCs1234_13rumbo_control3pid3far>:
 200:	in	r28, 0x3d	; 61
 202:	in	r29, 0x3e	; 62
 204:	subi	r28, 0x64	; 100
 206:	sbci	r29, 0x00	; 0
 208:	out	0x3d, r28	; 61
 20a:	subi	r28, 0xC4	; 196
 20c:	sbci	r29, 0xFF	; 255
 20e:	ldd	r24, Y+{last}	; 0x28
 210:	rjmp	.+40
 212:	std	Y+63, r24	; 0x3f"
        )
    }

    #[test]
    fn an_argument_on_the_stack_is_refused_by_the_functions_name() {
        let error = check(FIFTH).unwrap_err();
        assert!(error.starts_with("fifth gets arguments"), "{error}");
        let error = check(&with_frames(41)).unwrap_err();
        assert!(error.starts_with("rumbo_control::pid::far "), "{error}");
        assert!(error.contains("20e: ldd r24, Y+41"), "{error}");
    }

    #[test]
    fn variables_of_a_frame_are_no_arguments() {
        assert_eq!(check(&with_frames(40)), Ok(()));
    }

    #[test]
    fn a_number_among_the_symbols_ends_no_function() {
        let cut = with_frames(40) + "\n00000218 <__stack>:\n 218:\tldd\tr24, Y+63\n";
        assert_eq!(check(&cut), Ok(()));
        let fifth = FIFTH.replace("   8:", "00000008 <__stack>:\n   8:");
        assert!(check(&fifth).is_err());
    }
}
