//! Refuses an image with an indirect call or jump.
//!
//! Pointers to functions have 16 bits and the image is larger than the 128 KB that these reach. The image has none: all
//! calls and jumps name their target, wherever it is.

/// Calls and jumps by Z.
const INDIRECT: [&str; 4] = ["icall", "ijmp", "eicall", "eijmp"];

/// Checks the output of `avr-objdump -d --no-show-raw-insn`.
pub(super) fn check(disassembly: &str) -> Result<(), String> {
    let mut function = "";
    for line in disassembly.lines() {
        if let Some((_, name)) = line.strip_suffix(">:").and_then(|it| it.split_once('<')) {
            function = name;
        } else if line
            .split('\t')
            .nth(1)
            .is_some_and(|name| INDIRECT.contains(&name.trim()))
        {
            return Err(format!(
                "{:#} calls or jumps by a pointer ({}), which reaches 128 KB of a larger image: name the function, or \
                 pass it as a type",
                rustc_demangle::demangle(function),
                line.replace('\t', " ").trim(),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::check;

    #[test]
    fn a_call_by_a_pointer_is_refused_with_its_function() {
        let direct =
            "00000100 <main>:\n     100:\tcall\t0x2a0\t; 0x2a0 <icall_me>\n     104:\tret\n";
        assert_eq!(check(direct), Ok(()));
        for name in super::INDIRECT {
            let by_pointer = format!("{direct}00000106 <run>:\n     106:\t{name}\n");
            let error = check(&by_pointer).unwrap_err();
            assert!(
                error.starts_with("run calls") && error.contains(name),
                "{error}"
            );
        }
    }
}
