#![no_main]
libfuzzer_sys::fuzz_target!(|input: &[u8]| raycontact_fuzz::differential::run(&mut raycontact_fuzz::Bytes::new(input)));
