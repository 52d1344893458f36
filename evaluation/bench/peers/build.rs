//! Compiles the C++ peers for this very processor.

fn main() {
    println!("cargo::rerun-if-changed=cpp");
    println!("cargo::rerun-if-env-changed=EMBREE_4");
    let embree_4 = std::env::var("EMBREE_4").unwrap_or_default();
    assert!(
        std::path::Path::new(&embree_4).is_file(),
        "EMBREE_4 has to name the shared library of Embree 4, and names '{embree_4}'; scripts/bench.sh installs it"
    );
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").include("cpp").opt_level(3).flag("-march=native");
    // Lets loops with square roots and choices run in wide registers; changes no result.
    build.flag("-fno-math-errno").flag("-fno-trapping-math").flag("-mprefer-vector-width=512");
    // FCL's and Eigen's templates are not free of the last.
    build.warnings(true).extra_warnings(true).flag("-Wpedantic").flag("-Wno-maybe-uninitialized");
    for folder in ["/usr/include/bullet", "/usr/include/eigen3"] {
        // As a system's, so that its warnings stay away.
        build.flag("-isystem").flag(folder);
    }
    build.define("EMBREE_4", format!("\"{embree_4}\"").as_str());
    for entry in std::fs::read_dir("cpp").expect("cpp is there") {
        let path = entry.expect("cpp can be read").path();
        if path.extension().is_some_and(|extension| extension == "cpp") {
            build.file(path);
        }
    }
    build.compile("peers_cpp");
    for library in ["fcl", "ccd", "BulletSoftBody", "BulletDynamics", "BulletCollision", "LinearMath"] {
        println!("cargo::rustc-link-lib={library}");
    }
}
