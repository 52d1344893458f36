//! `--name value` arguments.

use std::path::{Path, PathBuf};
use std::process::exit;

/// The arguments of one example, taken out one by one.
pub struct Arguments {
    rest: Vec<String>,
}

impl Arguments {
    /// The process's arguments; prints `help` and ends where `--help` is among them.
    pub fn new(help: &'static str) -> Self {
        let rest: Vec<String> = std::env::args().skip(1).collect();
        if rest.iter().any(|argument| argument == "--help" || argument == "-h") {
            println!("{help}");
            exit(0);
        }
        Self { rest }
    }

    /// The value after `name`, or `default`.
    pub fn value<T: std::str::FromStr>(&mut self, name: &str, default: T) -> T {
        let Some(place) = self.rest.iter().position(|argument| argument == name) else {
            return default;
        };
        let value = self.rest.get(place + 1).and_then(|value| value.parse().ok());
        let Some(value) = value else { self.fail(&format!("{name} needs a value of the right kind")) };
        self.rest.drain(place..place + 2);
        value
    }

    /// The comma-separated numbers after `name`, or `default`.
    pub fn list(&mut self, name: &str, default: &[usize]) -> Vec<usize> {
        let text = self.value(name, String::new());
        if text.is_empty() {
            return default.to_vec();
        }
        text.split(',')
            .map(|part| {
                part.parse().unwrap_or_else(|_| self.fail(&format!("{name}: \"{part}\" is not a whole number")))
            })
            .collect()
    }

    /// Ends the process where an argument was not taken.
    pub fn finish(self) {
        if let Some(first) = self.rest.first() {
            self.fail(&format!("unknown argument {first}"));
        }
    }

    /// Prints what is wrong, and ends the process.
    pub fn fail(&self, message: &str) -> ! {
        let program = std::env::args().next().map(PathBuf::from);
        let name = program.as_deref().and_then(Path::file_name).unwrap_or_default();
        eprintln!("{}: {message}; see --help", name.display());
        exit(2)
    }
}
