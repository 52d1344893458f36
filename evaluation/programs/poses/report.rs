//! What is printed: a table by kind and by shape, the poses that failed, the last line.

use super::run::{Outcome, Run};
use super::start::Kind;

/// One pose's result.
#[derive(Clone, Debug)]
pub struct Pose {
    pub number: u64,
    pub kind: Kind,
    pub shapes: Vec<&'static str>,
    pub overlap: f64,
    pub run: Run,
}

pub fn count(poses: &[Pose], outcome: Outcome) -> usize {
    poses.iter().filter(|pose| pose.run.outcome == outcome).count()
}

pub fn print(poses: &[Pose]) {
    println!("{:16} {:>7} {:>9} {:>7} {:>8}  failures", "", "poses", "separated", "stuck", "exploded");
    for kind in Kind::ALL {
        print_row(kind.name(), poses.iter().filter(|pose| pose.kind == kind));
    }
    println!();
    for shape in super::shapes::NAMES {
        print_row(shape, poses.iter().filter(|pose| pose.shapes.contains(&shape)));
    }
    let mut overlaps: Vec<f64> = poses.iter().filter(|pose| pose.kind == Kind::Deep).map(|pose| pose.overlap).collect();
    overlaps.sort_by(f64::total_cmp);
    if let Some(median) = overlaps.get(overlaps.len() / 2) {
        println!("\ndeep poses: half of them overlap by {:.0} % of the smaller body or more", median * 100.0);
    }
    let separated = poses.iter().filter(|pose| pose.run.outcome == Outcome::Separated);
    let mut slowest: Vec<&Pose> = separated.collect();
    slowest.sort_by_key(|pose| std::cmp::Reverse(pose.run.steps));
    let named: Vec<_> = slowest.iter().take(5).map(|pose| format!("{} ({})", pose.number, pose.run.steps)).collect();
    println!("slowest to separate, with their steps: {}", named.join(", "));
    print_last_line(poses);
}

fn print_row<'a>(name: &str, poses: impl Iterator<Item = &'a Pose>) {
    const NAMED: usize = 8;
    let poses: Vec<Pose> = poses.cloned().collect();
    if poses.is_empty() {
        return;
    }
    let failures: Vec<u64> =
        poses.iter().filter(|pose| pose.run.outcome != Outcome::Separated).map(|pose| pose.number).collect();
    let mut named: Vec<String> = failures.iter().take(NAMED).map(u64::to_string).collect();
    if failures.len() > NAMED {
        named.push("…".to_owned());
    }
    let [separated, stuck, exploded] =
        [Outcome::Separated, Outcome::Stuck, Outcome::Exploded].map(|o| count(&poses, o));
    println!("{name:16} {:>7} {separated:>9} {stuck:>7} {exploded:>8}  {}", poses.len(), named.join(" "));
}

fn print_last_line(poses: &[Pose]) {
    let separated = poses.iter().filter(|pose| pose.run.outcome == Outcome::Separated);
    let mut steps: Vec<u32> = separated.map(|pose| pose.run.steps).collect();
    steps.sort_unstable();
    println!(
        "poses={} separated={} stuck={} exploded={} median_steps={} worst_steps={}",
        poses.len(),
        steps.len(),
        count(poses, Outcome::Stuck),
        count(poses, Outcome::Exploded),
        steps.get(steps.len() / 2).copied().unwrap_or(0),
        steps.last().copied().unwrap_or(0),
    );
}
