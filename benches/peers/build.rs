//! Compiles the C++ peers for this very processor.

fn main() {
    println!("cargo::rerun-if-changed=cpp");
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").include("cpp").opt_level(3).flag("-march=native");
    build.warnings(true).extra_warnings(true).flag("-Wpedantic");
    for entry in std::fs::read_dir("cpp").expect("cpp is there") {
        let path = entry.expect("cpp can be read").path();
        if path.extension().is_some_and(|extension| extension == "cpp") {
            build.file(path);
        }
    }
    build.compile("peers_cpp");
    for library in ["embree3"] {
        println!("cargo::rustc-link-lib={library}");
    }
}
