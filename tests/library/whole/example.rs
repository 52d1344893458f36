//! The example in Rust prints what the tutorial says.

use crate::two_octahedra;
use std::fs;

#[test]
fn the_example_prints_what_the_tutorial_says() {
    let page = fs::read_to_string("docs/tutorial.md").expect("the page is there");
    let (_, output) = page.rsplit_once("```text\n").expect("the last program has an output");
    let (output, _) = output.split_once("```").expect("it ends");
    assert_eq!(two_octahedra::run().expect("it runs").join("\n") + "\n", output);
}
