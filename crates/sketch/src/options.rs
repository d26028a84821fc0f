//! Options of the compiler and the linker.

/// Options of every call besides the board's: the clock and the version macros for the sketch.
pub(crate) const COMMON: [&str; 4] = [
    "-DF_CPU=16000000L",
    "-DARDUINO=10819",
    "-DARDUINO_ARCH_AVR",
    "-Os",
];
/// For C, C++ and assembler.
pub(crate) const OBJECT: [&str; 5] = [
    "-c",
    "-g",
    "-flto",
    "-ffunction-sections",
    "-fdata-sections",
];
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
pub(crate) const LINK: [&str; 5] = [
    "-w",
    "-g",
    "-flto",
    "-fuse-linker-plugin",
    "-Wl,--gc-sections",
];
