use std::fmt;

/// The form of saved bytes that this library writes and reads.
pub(super) const VERSION: u32 = 3;

/// Why saved bytes were refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SavedStateError {
    /// They do not start as saved bytes do, or their length does not fit their own count.
    NotSavedState {
        /// How many bytes there are.
        length: usize,
    },
    /// Another version of the library wrote them in another form.
    OtherVersion {
        /// The form's number.
        version: u32,
    },
    /// They come from a scene of the other precision.
    OtherPrecision {
        /// Bytes of one number of that scene.
        bytes: u32,
    },
    /// They have been changed since they were saved.
    Damaged,
}

impl fmt::Display for SavedStateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotSavedState { length } => {
                write!(f, "the {length} bytes are not a scene's saved pair memories; pass all that were saved")
            }
            Self::OtherVersion { version } => {
                write!(f, "the saved pair memories have form {version}, this library reads {VERSION}; save them anew")
            }
            Self::OtherPrecision { bytes } => write!(
                f,
                "the saved pair memories are of a scene with {bytes}-byte numbers; restore them in one of that precision"
            ),
            Self::Damaged => write!(f, "the saved pair memories have been changed since; save them anew"),
        }
    }
}

impl std::error::Error for SavedStateError {}
