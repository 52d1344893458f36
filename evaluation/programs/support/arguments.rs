//! `--name value` arguments.

use std::process::exit;

/// The arguments of one program, taken out one by one.
pub struct Arguments {
    program: &'static str,
    rest: Vec<String>,
}

impl Arguments {
    /// Prints `help` and ends the process where `--help` is among `rest`.
    pub fn new(program: &'static str, help: &str, rest: impl Iterator<Item = String>) -> Self {
        let rest: Vec<String> = rest.collect();
        if rest.iter().any(|argument| argument == "--help" || argument == "-h") {
            println!("{help}");
            exit(0);
        }
        Self { program, rest }
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

    /// Reads all of them in another way.
    pub fn parser(&self) -> lexopt::Parser {
        lexopt::Parser::from_args(&self.rest)
    }

    /// So many threads; ends the process where they do not start.
    pub fn pool(&self, threads: usize) -> rayon::ThreadPool {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap_or_else(|error| self.fail(&format!("cannot start {threads} threads: {error}")))
    }

    /// Ends the process where an argument was not taken.
    pub fn finish(self) {
        if let Some(first) = self.rest.first() {
            self.fail(&format!("unknown argument {first}"));
        }
    }

    /// Prints what is wrong, and ends the process.
    pub fn fail(&self, message: &str) -> ! {
        eprintln!("{}: {message}; see --help", self.program);
        exit(2)
    }
}
