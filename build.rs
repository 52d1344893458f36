//! Gives the shared library its SONAME, so that programs record `libraycontact.so.<version>` and not a file name (on macOS
//! its install name, `@rpath/libraycontact.<version>.dylib`), and tells the tests the target, for which they compile C. The
//! version is the part that stands for the ABI: the major one, and the minor one while the major is 0.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = std::env::var("TARGET").expect("cargo sets the target");
    println!("cargo::rustc-env=RAYCONTACT_TARGET={target}");
    let major = std::env::var("CARGO_PKG_VERSION_MAJOR").expect("cargo sets the version");
    let minor = std::env::var("CARGO_PKG_VERSION_MINOR").expect("cargo sets the version");
    let system = std::env::var("CARGO_CFG_TARGET_OS").expect("cargo sets the target");
    let abi = if major == "0" { format!("0.{minor}") } else { major };
    match system.as_str() {
        "linux" => println!("cargo::rustc-cdylib-link-arg=-Wl,-soname,libraycontact.so.{abi}"),
        "macos" => println!("cargo::rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libraycontact.{abi}.dylib"),
        _ => {}
    }
}
