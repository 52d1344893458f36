use crate::bytes::BytesError;
use crate::math::PoseError;
use std::fmt;

/// Why a scene refused something. Nothing was changed.
#[derive(Debug)]
#[expect(missing_docs, reason = "a field's name says what it is")]
pub enum SceneError {
    /// There is no body of this number.
    UnknownBody { body: u32 },
    /// A pair of bodies was asked for, and one was named twice.
    SameBody { body: u32 },
    /// Another body has this key.
    KeyTaken { key: u64 },
    /// A pair cannot remember what was given for it.
    PairMemory { pair: [u32; 2] },
    /// A step's length is negative or not finite.
    StepLength { seconds: f64 },
    /// The numbers given for a body's pose are none.
    Pose { body: u32, source: PoseError },
    /// A pose moves a body beyond the largest number of the scene's precision.
    PoseBeyondRange { body: u32 },
    /// Contacts are not those of where this body is: it has moved since, or is another.
    ContactsOutdated { body: u32 },
    /// Saved bytes are not what was saved.
    SavedState(BytesError),
    /// The system did not give so many threads.
    ThreadsNotStarted { threads: usize, source: rayon::ThreadPoolBuildError },
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownBody { body } => write!(f, "the scene has no body {body}; it was never added, or was removed"),
            Self::SameBody { body } => write!(f, "body {body} was named twice; name two different bodies"),
            Self::KeyTaken { key } => write!(f, "key {key} is another body's in this scene; give each body its own"),
            Self::PairMemory { pair: [first, second] } => write!(
                f,
                "the memory of the pair {first}, {second} is nothing that a pair remembers, or its bodies are the other way \
                 round; pass what a scene gave, the body that comes first by key first"
            ),
            Self::StepLength { seconds } => {
                write!(f, "the step is {seconds} seconds long; give a finite number of seconds ≥ 0")
            }
            Self::Pose { body, source } => write!(f, "body {body}: {source}"),
            Self::PoseBeyondRange { body } => write!(
                f,
                "body {body}: the pose moves its coordinates beyond the largest number of the scene's precision; keep bodies \
                 nearer to the origin"
            ),
            Self::ContactsOutdated { body } => write!(
                f,
                "the contacts are not those of where body {body} is now; find them anew, by a query of this scene"
            ),
            Self::SavedState(error) => write!(f, "saved pair memories: {error}"),
            Self::ThreadsNotStarted { threads, source } => {
                write!(f, "could not start {threads} threads: {source}; ask for fewer, or for 1 to use your own")
            }
        }
    }
}

impl std::error::Error for SceneError {}

impl From<BytesError> for SceneError {
    fn from(error: BytesError) -> Self {
        Self::SavedState(error)
    }
}
