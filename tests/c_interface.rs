//! The C headers are what the sources say, compile as C99 and C++17, and every export keeps the house rules.

use std::collections::HashMap;
use std::ffi::CStr;
use std::fs;
use std::path::Path;

/// The headers of `include/raycontact/`, in an order in which they can be read: each with those that it builds on, and with
/// the sources in `src/capi/` that it is made of. The first of these says what the header is for; its items come in their
/// order, what a host needs first before the rest.
const HEADERS: [(&str, &[&str], &[&str]); 8] = [
    ("base", &[], &["base/mod", "base/errors", "base/status", "base/vectors", "base/version"]),
    ("mesh", &["base"], &["mesh"]),
    ("scene", &["mesh"], &["scene/mod", "scene/options", "scene/bodies", "scene/pairs"]),
    (
        "contacts",
        &["scene"],
        &[
            "contacts/mod",
            "contacts/list",
            "contacts/forces",
            "contacts/statistics",
            "contacts/detection",
            "contacts/escape_push",
        ],
    ),
    (
        "contact_system",
        &["contacts"],
        &[
            "contact_system/mod",
            "contact_system/options",
            "contact_system/bodies",
            "contact_system/step",
            "contact_system/matrix",
            "contact_system/floats",
            "contact_system/batch",
        ],
    ),
    (
        "queries",
        &["contacts"],
        &["queries/mod", "queries/octree", "queries/rays", "queries/closest", "queries/own_exits", "queries/pairs"],
    ),
    ("state", &["scene"], &["state"]),
    (
        "distributed",
        &["contact_system", "state"],
        &[
            "distributed/mod",
            "distributed/bodies",
            "distributed/packed_mesh",
            "distributed/pair_forces",
            "distributed/system_ghosts",
            "distributed/system_parts",
            "distributed/system_memories",
        ],
    ),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

fn header(name: &str) -> String {
    read(&format!("include/raycontact/{name}.h"))
}

/// All of them, one after the other.
fn headers() -> String {
    HEADERS.map(|(name, ..)| header(name)).concat()
}

fn source(name: &str) -> String {
    read(&format!("src/capi/{name}.rs"))
}

/// The texts of all `extern "C"` functions, from their `#[unsafe(no_mangle)]` to the closing brace, each with the
/// line before it.
fn exports() -> Vec<String> {
    let mut exports = Vec::new();
    for name in HEADERS.iter().flat_map(|(.., sources)| *sources) {
        let text = source(name);
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

/// The items of C that cbindgen makes of the sources, by their names.
fn items() -> HashMap<String, String> {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml is valid");
    let builder = cbindgen::Builder::new().with_config(config).with_src(root().join("src/capi/mod.rs"));
    let mut generated = Vec::new();
    builder.generate().expect("the sources parse").write(&mut generated);
    let generated = String::from_utf8(generated).expect("the items are UTF-8");
    generated.trim().split("\n\n").map(|item| (name_of(item), item.to_owned())).collect()
}

/// What an item of C declares.
fn name_of(item: &str) -> String {
    let (_, code) = item.split_once("*/\n").unwrap_or_else(|| panic!("no text for users at:\n{item}"));
    let code = code.replace("(*", "");
    let declared = match code.strip_prefix("#define ") {
        Some(constant) => constant.split(' ').next(),
        None => code.split(['(', ')', '{', ';']).next(),
    };
    declared.unwrap_or_default().trim_end().rsplit([' ', '*']).next().unwrap_or_default().to_owned()
}

/// Takes the items that a source declares, in its order.
fn items_of(source: &str, items: &mut HashMap<String, String>) -> Vec<String> {
    let public = source.lines().filter(|line| line.starts_with("pub "));
    let names = public.flat_map(|line| line.split(|c: char| !c.is_alphanumeric() && c != '_'));
    names.filter_map(|name| items.remove(name)).collect()
}

fn generated(name: &str, needs: &[&str], sources: &[&str], items: &mut HashMap<String, String>) -> String {
    let sources: Vec<String> = sources.iter().map(|name| source(name)).collect();
    let about = sources[0].lines().map_while(|line| line.strip_prefix("//!"));
    let about: String = about.map(|line| format!(" *{line}\n")).collect();
    let needed: String = needs.iter().map(|name| format!("#include \"{name}.h\"\n")).collect();
    let needed = if needs.is_empty() { "#include <stddef.h>\n#include <stdint.h>\n" } else { &needed };
    let items: Vec<String> = sources.iter().flat_map(|source| items_of(source, items)).collect();
    let (guard, items) = (format!("RAYCONTACT_{}_H", name.to_uppercase()), items.join("\n\n"));
    format!(
        "/**\n * @file\n{about} */\n\n#ifndef {guard}\n#define {guard}\n\n\
         /* Generated by cbindgen from src/capi/; do not edit. CONTRIBUTING.md says how to renew it. */\n\n{needed}\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n{items}\n\n\
         #ifdef __cplusplus\n}} // extern \"C\"\n#endif\n\n#endif /* {guard} */\n"
    )
}

/// With RAYCONTACT_WRITE_HEADER=1 the headers are written instead of compared.
#[test]
fn header_is_what_cbindgen_generates() {
    let mut items = items();
    for (name, needs, sources) in HEADERS {
        let generated = generated(name, needs, sources, &mut items);
        if std::env::var_os("RAYCONTACT_WRITE_HEADER").is_some() {
            let path = root().join(format!("include/raycontact/{name}.h"));
            fs::write(path, generated).expect("the header can be written");
        } else {
            assert!(
                generated == header(name),
                "include/raycontact/{name}.h is out of date: see CONTRIBUTING.md for how to renew it"
            );
        }
    }
    assert!(items.is_empty(), "say in HEADERS where these belong: {:?}", items.keys());
}

/// Its list of what to start with names the header of each function.
#[test]
fn raycontact_h_includes_all_but_one_and_says_what_is_where() {
    let text = read("include/raycontact.h");
    let included: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("#include \"raycontact/")?.strip_suffix(".h\"")).collect();
    let all_but_one: Vec<&str> = HEADERS.iter().map(|(name, ..)| *name).filter(|name| *name != "distributed").collect();
    assert_eq!(included, all_but_one);
    let mut count = 0;
    for entry in text.split("\n * - ").skip(1) {
        let (name, functions) = entry.split_once(".h: ").expect("a header and its functions");
        let words = functions.split("()").filter_map(|before| before.split([' ', '\n']).next_back());
        for call in words.filter(|word| word.starts_with("rayc_")) {
            assert!(header(name).contains(&format!("{call}(")), "{name}.h does not declare {call}()");
            count += 1;
        }
    }
    assert!((20..30).contains(&count), "{count} functions to start with");
}

/// Compiles each header of this folder alone, twice, as C99 and as C++17.
fn check_compiles(name: &str, include: &Path, warnings: &[&str]) {
    let own = HEADERS.map(|(name, ..)| format!("raycontact/{name}.h"));
    for header in own.iter().map(String::as_str).chain(["raycontact.h"]) {
        for (standard, extension) in [("c99", "c"), ("c++17", "cpp")] {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).join(extension);
            fs::create_dir_all(&folder).expect("the test's folder can be made");
            let source = folder.join(format!("alone.{extension}"));
            let include_it = format!("#include <{header}>\n");
            let text = format!("{include_it}{include_it}int main(void) {{ return (int)rayc_version() * 0; }}\n");
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
                .unwrap_or_else(|error| panic!("{name}: {header} does not compile as {standard}: {error}"));
        }
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
    fs::create_dir_all(folder.join("raycontact")).expect("the test's folder can be made");
    let end = "  uint32_t scalar;\n} rayc_vectors";
    assert_eq!(headers().matches(end).count(), 2);
    for (name, ..) in HEADERS {
        let whole = header(name).replace(end, &end.replace("scalar", "scalar, end"));
        fs::write(folder.join(format!("raycontact/{name}.h")), whole).expect("the header can be written");
    }
    fs::write(folder.join("raycontact.h"), read("include/raycontact.h")).expect("the header can be written");
    check_compiles("holes", &folder, &["-Wpadded"]);
}

/// Structs that stay as they are, since arrays of them lie packed in the caller's memory, or since nothing is missing.
const FIXED: [&str; 16] = [
    "rayc_closest_point",
    "rayc_contact",
    "rayc_contact_memory",
    "rayc_contact_part",
    "rayc_csr",
    "rayc_hit",
    "rayc_hole",
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
    let text = headers();
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
    let header = headers();
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
    let text = headers();
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
    assert!(header("base").contains(&format!("#define RAYC_ABI_VERSION {abi}\n")), "RAYC_ABI_VERSION {abi}");
    for (name, number) in [("MAJOR", major), ("MINOR", minor), ("PATCH", patch)] {
        assert!(
            header("base").contains(&format!("#define RAYC_VERSION_{name} {number}\n")),
            "RAYC_VERSION_{name} {number}"
        );
    }
    let number = |text: &str| text.parse::<u32>().expect("a number");
    let version = number(major) * 10_000 + number(minor) * 100 + number(patch);
    assert_eq!(raycontact::capi::rayc_version(), version);
    assert_eq!(raycontact::capi::rayc_abi_version(), number(&abi));
}
