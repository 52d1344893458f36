//! The sources themselves: what `docs/architecture.md` says of their order and names, and where rounding bounds stand.

use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of the table of layers, the highest first, each with the lines it may have.
fn layers() -> Vec<(String, usize)> {
    let page = fs::read_to_string("docs/architecture.md").expect("the page is there");
    let (_, section) = page.split_once("## Layers\n").expect("it has the section");
    let (section, _) = section.split_once("\n## ").expect("another follows");
    let rows = section.lines().filter(|line| line.starts_with("| `"));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        (cells[1].trim_matches('`').to_owned(), cells[3].parse().expect("a number of lines"))
    })
    .collect()
}

fn files_in(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("it can be read").path();
        if path.is_dir() {
            files_in(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
}

/// Not the root, nor what only tests use.
fn is_code(path: &Path) -> bool {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path != Path::new("src/lib.rs") && stem != "tests" && !stem.starts_with("test_") && stem != "faults"
}

fn room_of(path: &Path) -> String {
    let below = path.strip_prefix("src").expect("it lies there").with_extension("");
    below.iter().next().expect("it has a name").to_string_lossy().into_owned()
}

fn without_tests(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("it can be read");
    let code = text.split("\nmod tests {").next().unwrap_or_default();
    code.trim_end_matches(|end| end != '}').to_owned() + "\n"
}

/// Each file of the library but the root, with its room and its code without comments and unit tests.
pub(super) fn sources() -> Vec<(PathBuf, String, String)> {
    let mut files = Vec::new();
    files_in(Path::new("src"), &mut files);
    let read = |path: PathBuf| {
        let text = without_tests(&path);
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
        let room = room_of(&path);
        (path, room, code)
    };
    files.into_iter().filter(|path| is_code(path)).map(read).collect()
}

#[test]
fn modules_use_only_those_below_them() {
    let layers = layers();
    let place = |name: &str| layers.iter().position(|(layer, _)| layer == name);
    let mut seen = 0;
    for (path, module, code) in sources() {
        let own = place(&module).unwrap_or_else(|| panic!("{module} is not in the table of layers"));
        for used in code.split("crate::").skip(1) {
            let name: String = used.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            if let Some(other) = place(&name) {
                assert!(own <= other, "{}: {module} uses {name}, which is above it", path.display());
                seen += usize::from(own < other);
            }
        }
    }
    assert!(seen > 400, "only {seen} uses");
}

/// Who needs more lines says in the table what went for them.
#[test]
fn rooms_keep_to_their_lines() {
    let mut files = Vec::new();
    files_in(Path::new("src"), &mut files);
    for (room, most) in layers() {
        let own = files.iter().filter(|path| is_code(path) && room_of(path) == room);
        let lines: usize = own.map(|path| without_tests(path).lines().count()).sum();
        assert!(lines > 0 && lines <= most, "{room} has {lines} lines, and may have {most}");
    }
}

/// Rounding bounds stand in one file, with their derivations.
#[test]
fn rounding_bounds_stand_in_one_file() {
    for (path, _, code) in sources() {
        let may = ["src/math/margins.rs", "src/math/scalar.rs"].iter().any(|own| path == Path::new(own));
        let found = ["EPSILON", "ROUNDING_UNIT", "e-5", "e-6", "e-7", "e-8", "e-9", "e-1"]
            .iter()
            .find(|word| code.contains(*word));
        assert!(
            may || found.is_none(),
            "{}: {} belongs into src/math/margins.rs",
            path.display(),
            found.unwrap_or(&"")
        );
    }
}

/// The walks and decisions name files that are there.
#[test]
fn files_of_the_architecture_are_there() {
    let page = fs::read_to_string("docs/architecture.md").expect("the page is there");
    let named: Vec<&str> = page.split('`').skip(1).step_by(2).filter(|name| name.ends_with(".rs")).collect();
    assert!(named.len() > 60, "{named:?}");
    let mut files = Vec::new();
    files_in(Path::new("src"), &mut files);
    for name in named {
        // Next to others of its folder, a file may be named by its name alone.
        let is_there = Path::new(name).exists() || files.iter().any(|file| file.ends_with(name));
        assert!(is_there, "docs/architecture.md names {name}");
    }
}
