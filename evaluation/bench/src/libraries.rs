//! The shared libraries that are measured: raycontact as C has it, and the peers.

use crate::{c_library, peer};
use std::ffi::OsString;
use std::sync::Arc;

#[derive(clap::Args)]
pub struct Paths {
    /// The shared library of raycontact, as C programs link it.
    #[arg(long, default_value = "libraycontact.so")]
    library: OsString,
    /// The shared library with the peers.
    #[arg(long, default_value = "libraycontact_bench_peers.so")]
    peers: OsString,
}

pub struct Libraries {
    pub raycontact: Arc<c_library::Library>,
    pub peers: Arc<peer::Library>,
}

impl Paths {
    pub fn open(&self) -> Result<Libraries, String> {
        Ok(Libraries { raycontact: c_library::Library::open(&self.library)?, peers: peer::Library::open(&self.peers)? })
    }
}
