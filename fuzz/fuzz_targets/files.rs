#![no_main]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| claims::files::check(bytes));
