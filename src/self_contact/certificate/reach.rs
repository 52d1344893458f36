use crate::math::Scalar;

/// How far apart is near.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach<T: Scalar> {
    /// Boxes that are farther apart along any axis do not touch.
    pub(crate) touch: T,
    /// Steep triangles are offered whose boxes are that and this much apart.
    pub(crate) margin: T,
    /// Parts are listed whose boxes are that and this much apart.
    pub(crate) part_margin: T,
    /// The most pairs of parts that are listed.
    pub(crate) most_pairs: usize,
}

/// Sheltered triangles have to be so many times as far apart as ones that touch: strain may leave a quarter of it.
const SHELTERED: f64 = 8.0;

impl<T: Scalar> Reach<T> {
    /// Sheltered triangles whose boxes are that far apart are not offered.
    pub(crate) fn of_sheltered(&self) -> T {
        if self.margin > T::zero() { self.touch * T::of(SHELTERED) } else { self.touch }
    }

    /// So much nearer parts may come that are sheltered in wider surroundings.
    pub(crate) fn wide_margin(&self) -> T {
        self.margin * T::of(2.0)
    }

    /// A path over the surface between points `touch` and a margin apart, at slopes of at most 60°, stays within that: for
    /// either margin.
    pub(crate) fn of_surroundings(&self) -> [T; 2] {
        [self.margin, self.wide_margin()].map(|margin| (self.touch + margin) * T::of(2.0))
    }

    pub(crate) fn of_parts(&self) -> T {
        let parts = self.touch + self.part_margin;
        if self.margin > T::zero() { parts.max(self.of_surroundings()[1]).max(self.of_sheltered()) } else { parts }
    }
}

impl<T: Scalar> Lapse<T> {
    /// Nothing is known.
    pub(crate) fn unknown() -> Self {
        Self { spread: T::zero(), part: 1.0 }
    }
}

/// What has changed since positions were kept.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lapse<T: Scalar> {
    /// How far any two vertices have moved against each other, at most.
    pub(crate) spread: T,
    /// Which part of the near parts have come nearer than they may, or lie where triangles are strained by more than they may
    /// be; all, where nothing is known.
    pub(crate) part: f64,
}
