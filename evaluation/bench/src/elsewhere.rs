//! raycontact in a process of its own, since it asks for the wanted instructions only once.
//!
//! The process reads one request per line and answers each with one line, until its input ends: `round <number>` with
//! the microseconds of each measured step, `contacts` with four numbers for each contact.

use crate::host::Host;
use crate::library::Whole;
use crate::measure::{Times, frames, time_round};
use crate::method::{Key, Method};
use crate::workload::Workload;
use raycontact::contact::DetectionOptions;
use std::fmt::Display;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

pub struct Elsewhere {
    process: Child,
    requests: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Elsewhere {
    /// Starts this program once more, with the path of instructions in its environment.
    pub fn start(workload: &str, simd: &str) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|e| format!("cannot find this program's own file: {e}"))?;
        let mut process = Command::new(program)
            .args(["--serve", workload])
            .env("RAYCONTACT_SIMD", simd)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("cannot start this program once more: {e}"))?;
        let requests = process.stdin.take();
        let answers = BufReader::new(process.stdout.take().expect("the output was asked for"));
        Ok(Self { process, requests, answers })
    }

    pub fn time_round(&mut self, round: u32) -> Result<Times, String> {
        let answer = self.ask(&format!("round {round}"))?;
        Ok(Times { totals: parse(&answer)?, stages: Vec::new() })
    }

    pub fn contacts(&mut self) -> Result<Vec<Key>, String> {
        let numbers: Vec<u32> = parse(&self.ask("contacts")?)?;
        let (contacts, _) = numbers.as_chunks();
        let key = |&[colliding, collided, vertex, triangle]: &[u32; 4]| Key { colliding, collided, vertex, triangle };
        Ok(contacts.iter().map(key).collect())
    }

    fn ask(&mut self, request: &str) -> Result<String, String> {
        let failed = |error| format!("the process of a path of instructions ended early: {error}");
        let requests = self.requests.as_mut().expect("open until dropped");
        writeln!(requests, "{request}").map_err(failed)?;
        let mut answer = String::new();
        self.answers.read_line(&mut answer).map_err(failed)?;
        Ok(answer)
    }
}

impl Drop for Elsewhere {
    fn drop(&mut self) {
        // The end of its input ends it.
        self.requests = None;
        let _ = self.process.wait();
    }
}

fn parse<N: std::str::FromStr>(answer: &str) -> Result<Vec<N>, String> {
    let number = |word: &str| word.parse().map_err(|_| format!("the process of a path of instructions said '{word}'"));
    answer.split_whitespace().map(number).collect()
}

/// What the other process does.
pub fn serve(name: &str) -> Result<(), String> {
    let workload = Workload::new(name)?;
    let mut host = Host::new(&workload);
    let mut method = Whole::<f32>::new(&workload, &host, 1, DetectionOptions::paper())?;
    for request in std::io::stdin().lines() {
        let request = request.map_err(|e| format!("cannot read the next request: {e}"))?;
        match request.strip_prefix("round ").and_then(|number| number.parse().ok()) {
            Some(round) => answer(time_round(&mut method, 1, &mut host, &frames(&workload, round)).totals),
            None => answer(method.contacts().iter().flat_map(|k| [k.colliding, k.collided, k.vertex, k.triangle])),
        }
    }
    Ok(())
}

fn answer(numbers: impl IntoIterator<Item: Display>) {
    let words: Vec<String> = numbers.into_iter().map(|number| number.to_string()).collect();
    println!("{}", words.join(" "));
}
