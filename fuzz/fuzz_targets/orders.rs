#![no_main]
libfuzzer_sys::fuzz_target!(|text: &str| claims::orders::check(text));
