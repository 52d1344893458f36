//! A second static library written in Rust, with memory, a thread and a panic of its own.

#![crate_type = "staticlib"]

/// The sum of 1 to n, worked out on another thread; -1 where n is negative, after a panic inside.
#[unsafe(no_mangle)]
pub extern "C" fn second_sum(n: i64) -> i64 {
    let work = std::thread::spawn(move || {
        assert!(n >= 0, "this panic is part of the test");
        (1..=n).collect::<Vec<i64>>().iter().sum()
    });
    work.join().unwrap_or(-1)
}
