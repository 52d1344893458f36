//! No two files of a room import from each other, over however many others.

use super::layers::sources;
use std::collections::{BTreeMap, BTreeSet};

/// A module or what is in one, from the root of the library on.
type Name = Vec<String>;

/// What each module exports again under a name of its own.
type Exports = BTreeMap<Name, BTreeMap<String, Name>>;

fn module_of(path: &std::path::Path) -> Name {
    let below = path.strip_prefix("src").expect("it lies there").with_extension("");
    let mut name: Name = below.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    name.pop_if(|last| last == "mod");
    name
}

/// The paths that a `use` names, each whole.
fn paths_of(tree: &str, before: &[String], paths: &mut Vec<Name>) {
    let (mut depth, mut start) = (0, 0);
    let mut parts = Vec::new();
    for (at, sign) in tree.char_indices() {
        depth += i32::from(sign == '{') - i32::from(sign == '}');
        if sign == ',' && depth == 0 {
            parts.push(&tree[start..at]);
            start = at + 1;
        }
    }
    parts.push(&tree[start..]);
    for part in parts.into_iter().map(str::trim).filter(|part| !part.is_empty()) {
        let (path, inner) = part.split_once('{').map_or((part, None), |(path, inner)| (path, inner.rsplit_once('}')));
        let path = path.split(" as ").next().unwrap_or_default();
        let words = path.split("::").map(str::trim).filter(|word| !word.is_empty()).map(str::to_owned);
        let whole: Name = before.iter().cloned().chain(words).collect();
        match inner {
            Some((inner, _)) => paths_of(inner, &whole, paths),
            None => paths.push(whole),
        }
    }
}

/// The `use` declarations of a file, those that export apart, and the rest of it.
fn divided(code: &str) -> ([Vec<Name>; 2], String) {
    let (mut uses, mut exports, mut rest) = (Vec::new(), Vec::new(), String::new());
    for statement in code.split_inclusive(';') {
        let line = statement.rfind("\nuse ").or_else(|| statement.rfind("\npub use "));
        let line = line.or_else(|| statement.find("\npub(").filter(|&at| statement[at..].contains(") use ")));
        match line.map(|at| statement.split_at(at)) {
            Some((code, declaration)) => {
                rest += code;
                let (visibility, tree) = declaration.split_once("use ").expect("it is one");
                let list = if visibility.contains("pub") { &mut exports } else { &mut uses };
                paths_of(tree.trim_end_matches(';'), &[], list);
            }
            None => rest += statement,
        }
    }
    ([uses, exports], rest)
}

/// A path from the root, of one that begins in a module; `None` where it leads out of the library.
fn from_root(module: &Name, path: &Name, modules: &BTreeSet<Name>) -> Option<Name> {
    let beside = |word: &String| modules.contains(&module.iter().chain([word]).cloned().collect::<Name>());
    let (base, rest) = match path.first()?.as_str() {
        "crate" => (&module[..0], &path[1..]),
        "self" => (&module[..], &path[1..]),
        "super" => {
            let up = path.iter().take_while(|word| *word == "super").count();
            (&module[..module.len().checked_sub(up)?], &path[up..])
        }
        _ if beside(&path[0]) => (&module[..], &path[..]),
        _ => return None,
    };
    Some(base.iter().chain(rest).cloned().collect())
}

/// The module in which what is named is defined.
fn home(name: &Name, modules: &BTreeSet<Name>, exports: &Exports) -> Option<Name> {
    let module = (1..=name.len()).rev().map(|length| name[..length].to_vec()).find(|part| modules.contains(part))?;
    let exported = name.get(module.len()).and_then(|word| exports[&module].get(word));
    match exported {
        Some(from) => home(from, modules, exports).or(Some(module)),
        None => Some(module),
    }
}

/// By module those that it imports from.
fn imports() -> BTreeMap<Name, BTreeSet<Name>> {
    let files: BTreeMap<Name, _> =
        sources().into_iter().map(|(path, _, code)| (module_of(&path), divided(&format!("\n{code}")))).collect();
    let modules: BTreeSet<Name> = files.keys().cloned().collect();
    let named = |module: &Name, paths: &[Name]| {
        let named = paths.iter().filter_map(|path| Some((path.last()?.clone(), from_root(module, path, &modules)?)));
        named.collect::<BTreeMap<_, _>>()
    };
    let exports: Exports = files.iter().map(|(module, ([_, out], _))| (module.clone(), named(module, out))).collect();
    let of_file = |(module, ([uses, _], rest)): (&Name, &([Vec<Name>; 2], String))| {
        let mut paths = uses.clone();
        let is_part = |sign: char| sign.is_alphanumeric() || sign == '_' || sign == ':';
        for word in rest.split(|sign| !is_part(sign)) {
            if word.contains("::") {
                paths.push(word.trim_start_matches(':').split("::").map(str::to_owned).collect());
            } else if let Some(from) = exports[module].get(word) {
                paths.push([vec!["crate".to_owned()], from.clone()].concat());
            }
        }
        let from = paths.iter().filter_map(|path| from_root(module, path, &modules));
        let homes = from.filter_map(|name| home(&name, &modules, &exports)).filter(|home| home != module);
        (module.clone(), homes.collect())
    };
    files.iter().map(of_file).collect()
}

#[test]
fn no_files_import_from_each_other() {
    let mut left = imports();
    assert!(left.len() > 200 && left.values().map(BTreeSet::len).sum::<usize>() > 1000, "{}", left.len());
    // A file that imports from none of those left is in no circle; nor is one from which none of them imports.
    loop {
        let all: BTreeSet<Name> = left.keys().cloned().collect();
        let used: BTreeSet<Name> = left.values().flatten().cloned().collect();
        left.retain(|module, from| !from.is_disjoint(&all) && used.contains(module));
        left.values_mut().for_each(|from| from.retain(|module| all.contains(module)));
        if left.len() == all.len() {
            break;
        }
    }
    let line = |(module, from): (&Name, &BTreeSet<Name>)| {
        let from: Vec<String> = from.iter().map(|module| module.join("/")).collect();
        format!("{} imports from {}\n", module.join("/"), from.join(", "))
    };
    assert!(left.is_empty(), "among these are circles:\n{}", left.iter().map(line).collect::<String>());
}
