//! The C header is what the sources say, compiles as C99 and C++17, and every export keeps the house rules.

use std::ffi::CStr;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn header() -> String {
    fs::read_to_string(root().join("include/raycontact.h")).expect("the header is committed")
}

/// The sources of the C interface: (file name, text).
fn sources() -> Vec<(PathBuf, String)> {
    let files = fs::read_dir(root().join("src/capi")).expect("src/capi exists");
    let paths = files.map(|file| file.expect("a readable entry").path());
    paths.map(|path| (path.clone(), fs::read_to_string(path).expect("a readable source"))).collect()
}

/// The texts of all `extern "C"` functions, from their `#[unsafe(no_mangle)]` to the closing brace, each with the
/// line before it.
fn exports() -> Vec<String> {
    let mut exports = Vec::new();
    for (_, text) in sources() {
        let lines: Vec<&str> = text.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            if *line == "#[unsafe(no_mangle)]" {
                let length = lines[at..].iter().position(|line| *line == "}").expect("functions end");
                exports.push(lines[at - 1..=at + length].join("\n"));
            }
        }
    }
    assert!(exports.len() > 30, "the sources are found");
    exports
}

/// With RAYCONTACT_WRITE_HEADER=1 the header is written instead of compared.
#[test]
fn header_is_what_cbindgen_generates() {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml is valid");
    // Not mod.rs: through it every source would be read once more. Nor the test of faults, which exports nothing.
    let mut paths: Vec<PathBuf> = sources()
        .into_iter()
        .map(|(path, _)| path)
        .filter(|path| !["mod.rs", "faults.rs"].iter().any(|name| path.ends_with(name)))
        .collect();
    paths.sort_by_key(|path| position_in_header(path));
    // Its own sources only: the rest of the crate stays out of the header.
    let builder = cbindgen::Builder::new().with_config(config);
    let builder = paths.iter().fold(builder, |builder, path| builder.with_src(path));
    let mut generated = Vec::new();
    builder.generate().expect("the sources parse").write(&mut generated);
    let generated = String::from_utf8(generated).expect("the header is UTF-8");
    if std::env::var_os("RAYCONTACT_WRITE_HEADER").is_some() {
        fs::write(root().join("include/raycontact.h"), generated).expect("the header can be written");
    } else {
        assert!(generated == header(), "include/raycontact.h is out of date: see CONTRIBUTING.md for how to renew it");
    }
}

/// What a host needs first comes first: what all calls share, meshes, the scene and its contacts, the forces they give, the
/// contact system; then what few hosts need: pairs' memories, bodies of several processes, a tree of one's own.
const HEADER_ORDER: [&str; 34] = [
    "version",
    "failure",
    "guard",
    "float_mode",
    "handles",
    "pointers",
    "precision",
    "body_arrays",
    "checks",
    "sized_structs",
    "host_threads",
    "vectors",
    "host_positions",
    "options",
    "mesh",
    "scene",
    "contacts",
    "statistics",
    "response",
    "contact_system_options",
    "contact_system",
    "contact_system_step",
    "contact_system_pairs",
    "contact_system_parts",
    "contact_system_ghosts",
    "escape_push",
    "pair_memory",
    "sharing",
    "pair_forces",
    "packed_mesh",
    "octree_options",
    "octree",
    "closest",
    "own_exits",
];

fn position_in_header(path: &Path) -> usize {
    let name = path.file_stem().and_then(|stem| stem.to_str()).expect("sources have names");
    let place = HEADER_ORDER.iter().position(|known| *known == name);
    place.unwrap_or_else(|| panic!("say in HEADER_ORDER where {} belongs in the header", path.display()))
}

/// Compiles a program of the header alone, from this folder, as C99 and as C++17.
fn check_compiles(name: &str, include: &Path, warnings: &[&str]) {
    for (standard, extension) in [("c99", "c"), ("c++17", "cpp")] {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).join(extension);
        fs::create_dir_all(&folder).expect("the test's folder can be made");
        let source = folder.join(format!("alone.{extension}"));
        let text =
            "#include <raycontact.h>\n#include <raycontact.h>\nint main(void) { return (int)rayc_version() * 0; }\n";
        fs::write(&source, text).expect("the test's source can be written");
        cc::Build::new()
            .cpp(extension == "cpp")
            .std(standard)
            .include(include)
            .file(&source)
            .flags(warnings)
            .flag("-Werror")
            .target(env!("RAYCONTACT_TARGET"))
            .host(env!("RAYCONTACT_TARGET"))
            .opt_level(0)
            .cargo_metadata(false)
            .out_dir(&folder)
            .try_compile("alone")
            .unwrap_or_else(|error| panic!("{name}: the header does not compile as {standard}: {error}"));
    }
}

#[test]
fn header_compiles_alone_as_c99_and_cpp17() {
    check_compiles("as it is", &root().join("include"), &["-Wall", "-Wextra", "-Wpedantic"]);
}

/// A hole's bytes would be whatever they were, or be read as a later version's field: the compiler finds none. Those that
/// say where vectors lie end in four bytes that nobody looks at; they are named here.
#[test]
fn structs_have_no_holes() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("holes");
    fs::create_dir_all(&folder).expect("the test's folder can be made");
    let [text, end] = [header(), "  uint32_t scalar;\n} rayc_vectors".to_owned()];
    assert_eq!(text.matches(&end).count(), 2);
    let whole = text.replace(&end, &end.replace("scalar", "scalar, end"));
    fs::write(folder.join("raycontact.h"), whole).expect("the header can be written");
    check_compiles("holes", &folder, &["-Wpadded"]);
}

/// Structs that stay as they are, since arrays of them lie packed in the caller's memory, or since nothing is missing.
const FIXED: [&str; 14] = [
    "rayc_closest_point",
    "rayc_contact",
    "rayc_contact_memory",
    "rayc_contact_part",
    "rayc_hit",
    "rayc_motion",
    "rayc_own_exit",
    "rayc_pair_forces",
    "rayc_pose",
    "rayc_ray",
    "rayc_surface_point",
    "rayc_vectors",
    "rayc_vectors_mut",
    "rayc_vertex_force",
];

/// All others start with their size, or every call that takes one is told it.
#[test]
fn structs_that_may_grow_carry_their_size() {
    let text = header();
    let (mut fixed, mut growing) = (Vec::new(), Vec::new());
    for definition in text.split("\ntypedef struct ").skip(1) {
        // Handles have no fields.
        let Some((name, fields)) = definition.split_once(" {\n").filter(|(name, _)| !name.contains(';')) else {
            continue;
        };
        let first = fields.lines().find(|line| line.ends_with(';')).expect("it has fields");
        let takes_one = |call: &&str| call.contains("rayc_status rayc_") && call.contains(&format!("struct {name} *"));
        let calls: Vec<&str> = text.split("\n\n").filter(takes_one).collect();
        let is_told = !calls.is_empty() && calls.iter().all(|call| call.contains("size_t struct_size,"));
        let grows = first.trim() == "size_t struct_size;" || is_told;
        if grows { growing.push(name) } else { fixed.push(name) }
    }
    fixed.sort();
    assert_eq!(fixed, FIXED, "give a new struct its size, or say here that it stays as it is");
    assert!(growing.len() >= 10, "{growing:?}");
}

#[test]
fn every_export_goes_through_the_guard() {
    for export in exports() {
        let is_guarded = ["guard(", "guard_end(", "guard_value("].iter().any(|guard| export.contains(guard));
        assert!(is_guarded, "no panic guard in:\n{export}");
    }
}

#[test]
fn every_export_is_declared_once() {
    let header = header();
    // Declarations start at the margin; mentions of a function stand in comments.
    let declarations: Vec<&str> =
        header.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_lowercase())).collect();
    for export in exports() {
        let (_, after) = export.split_once("extern \"C\" fn ").expect("a function");
        let call = &after[..=after.find('(').expect("parameters")];
        let count = declarations
            .iter()
            .filter(|line| line.contains(&format!(" {call}")) || line.contains(&format!("*{call}")))
            .count();
        assert_eq!(count, 1, "declarations of {call}");
    }
}

#[test]
fn every_export_is_documented() {
    for export in exports() {
        assert!(export.starts_with("///"), "no text for users in:\n{export}");
    }
}

#[test]
fn every_status_has_its_name() {
    let text = header();
    let statuses = text.lines().filter_map(|line| {
        let (name, number) = line.trim().strip_suffix(',')?.split_once(" = ")?;
        name.starts_with("RAYC_STATUS_").then(|| (name, number.parse::<u32>().expect("a number")))
    });
    let mut count = 0;
    for (name, number) in statuses {
        assert_eq!(status_name(number).to_str(), Ok(name), "rayc_status_name({number})");
        count += 1;
    }
    assert!(count > 20, "the statuses are found");
}

#[allow(unsafe_code)] // reading a C string needs it
fn status_name(status: u32) -> &'static CStr {
    // SAFETY: rayc_status_name gives a constant string that ends in zero.
    unsafe { CStr::from_ptr(raycontact::capi::rayc_status_name(status)) }
}

#[test]
fn version_is_that_of_the_package() {
    let [major, minor, patch] =
        [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")];
    let abi = if major == "0" { minor.to_owned() } else { format!("{major}00") };
    assert!(header().contains(&format!("#define RAYC_ABI_VERSION {abi}\n")), "RAYC_ABI_VERSION {abi}");
    for (name, number) in [("MAJOR", major), ("MINOR", minor), ("PATCH", patch)] {
        assert!(header().contains(&format!("#define RAYC_VERSION_{name} {number}\n")), "RAYC_VERSION_{name} {number}");
    }
    let number = |text: &str| text.parse::<u32>().expect("a number");
    let version = number(major) * 10_000 + number(minor) * 100 + number(patch);
    assert_eq!(raycontact::capi::rayc_version(), version);
    assert_eq!(raycontact::capi::rayc_abi_version(), number(&abi));
}
