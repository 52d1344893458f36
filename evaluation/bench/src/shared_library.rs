//! Functions of a shared library, loaded by their names.

/// Declares a struct that holds functions of C, and `open`, which loads them from the shared library at a path.
macro_rules! shared_library {
    ($(#[$about:meta])* $library:ident, $how_to_make:literal; $($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        $(#[$about])*
        pub struct $library {
            $(pub $name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl $library {
            pub fn open(path: &std::ffi::OsStr) -> Result<std::sync::Arc<Self>, String> {
                let failed = |error: libloading::Error| {
                    format!("cannot open the shared library {}: {error}; {}", path.display(), $how_to_make)
                };
                // SAFETY: the functions have these types. Never closed: threads may still be running in it when this
                // program ends.
                unsafe {
                    let library = std::mem::ManuallyDrop::new(libloading::Library::new(path).map_err(failed)?);
                    Ok(std::sync::Arc::new(Self { $($name: *library.get(stringify!($name)).map_err(failed)?,)* }))
                }
            }
        }
    };
}
pub(crate) use shared_library;
