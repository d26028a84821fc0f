//! Options of the compiler and the linker.

/// What differs between a program to run and one to debug.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Options {
    /// Of every call besides the board's: the clock and the version macros for the sketch.
    pub(crate) common: &'static [&'static str],
    /// For C, C++ and assembler.
    pub(crate) object: &'static [&'static str],
    pub(crate) link: &'static [&'static str],
}

/// As the Arduino IDE compiles. DWARF 4, since what `-g` means for gcc 5.4 debuggers read wrongly.
pub(crate) const RUN: Options = Options {
    common: &[
        "-DF_CPU=16000000L",
        "-DARDUINO=10819",
        "-DARDUINO_ARCH_AVR",
        "-Os",
    ],
    object: &[
        "-c",
        "-gdwarf-4",
        "-flto",
        "-ffunction-sections",
        "-fdata-sections",
    ],
    link: &[
        "-w",
        "-gdwarf-4",
        "-flto",
        "-fuse-linker-plugin",
        "-Wl,--gc-sections",
    ],
};
/// As the IDE's "Optimize for debugging": each function by itself, and variables that stay where they are.
pub(crate) const DEBUG: Options = Options {
    common: &[
        "-DF_CPU=16000000L",
        "-DARDUINO=10819",
        "-DARDUINO_ARCH_AVR",
        "-Og",
    ],
    object: &["-c", "-gdwarf-4", "-ffunction-sections", "-fdata-sections"],
    link: &["-w", "-gdwarf-4", "-Wl,--gc-sections"],
};
pub(crate) const C: [&str; 2] = ["-std=gnu11", "-fno-fat-lto-objects"];
/// Debian's compiler knows `DECIMAL_DIG` in C only; the core's strings want it.
pub(crate) const CPP: [&str; 6] = [
    "-DDECIMAL_DIG=__DECIMAL_DIG__",
    "-std=gnu++11",
    "-fpermissive",
    "-fno-exceptions",
    "-fno-threadsafe-statics",
    "-Wno-error=narrowing",
];
