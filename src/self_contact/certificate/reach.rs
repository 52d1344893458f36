use crate::math::Scalar;

/// How far apart triangles and tiles may be to be near.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<T: Scalar> {
    /// Triangles whose boxes are farther apart along any axis do not touch.
    pub(crate) touch: T,
    /// Steep triangles are offered whose boxes are at most `touch + margin` apart.
    pub(crate) margin: T,
    /// Pairs of tiles are listed whose boxes are at most `touch + tile_margin` apart.
    pub(crate) tile_margin: T,
    /// The most pairs of tiles that are listed.
    pub(crate) most_pairs: usize,
}

/// Sheltered triangles are offered up to this many times the distance at which triangles touch: strain leaves a quarter of it.
const SHELTERED: f64 = 8.0;

impl<T: Scalar> Reach<T> {
    /// Sheltered triangles are offered whose boxes are at most this far apart.
    pub(crate) fn of_sheltered(&self) -> T {
        if self.margin > T::zero() { self.touch * T::of(SHELTERED) } else { self.touch }
    }

    /// By how much tiles may come nearer that are sheltered in wider surroundings.
    pub(crate) fn wide_margin(&self) -> T {
        self.margin * T::of(2.0)
    }

    /// Within which distance a path over the surface stays that joins points `touch` and a margin apart, at slopes of at most
    /// 60°: for the narrow margin and for the wide one.
    pub(crate) fn of_surroundings(&self) -> [T; 2] {
        [self.margin, self.wide_margin()].map(|margin| (self.touch + margin) * T::of(2.0))
    }

    /// Pairs of tiles are listed whose boxes are at most this far apart.
    pub(crate) fn of_tiles(&self) -> T {
        let tiles = self.touch + self.tile_margin;
        if self.margin > T::zero() { tiles.max(self.of_surroundings()[1]).max(self.of_sheltered()) } else { tiles }
    }
}

/// What has changed since positions were kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lapse<T: Scalar> {
    /// How far any two vertices have moved against each other, at most.
    pub(crate) spread: T,
    /// Which part of the listed pairs of tiles have lapsed; 1 where nothing is known.
    pub(crate) part: f64,
}

impl<T: Scalar> Lapse<T> {
    /// Nothing is known.
    pub(crate) fn unknown() -> Self {
        Self { spread: T::zero(), part: 1.0 }
    }
}
