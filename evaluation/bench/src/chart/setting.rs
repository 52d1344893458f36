//! What is measured on a scene: the library over its options, and the peers.

use super::closest::Closest;
use super::load::Weights;
use crate::c_library::Defaults;
use crate::host::Host;
use crate::libraries::Libraries;
use crate::library::{Classic, HostScalar, Whole};
use crate::method::{Description, Method, Precision};
use crate::workload::Workload;
use raycontact::contact::{ContactLaw, DetectionOptions, Sampling};
use raycontact::math::Scalar;
use raycontact::query::Layout;

#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ours {
    pub law: ContactLaw,
    pub sampling: Sampling<f64>,
    pub precision: Precision,
    pub layout: Layout,
    pub edges: bool,
    pub escape: bool,
}

#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Setting {
    Ours(Ours),
    /// By name.
    Peer(&'static str),
    Closest,
}

const DEFAULT: Ours = Ours {
    law: ContactLaw::Pressure,
    sampling: Sampling::Accuracy(0.01),
    precision: Precision::F64,
    layout: Layout::Bvh,
    edges: true,
    escape: true,
};
const PAPER: Ours =
    Ours { law: ContactLaw::RayLength, sampling: Sampling::Vertices, edges: false, escape: false, ..DEFAULT };

const ACCURACIES: [f64; 4] = [0.1, 0.03, 0.01, 0.003];

/// Every setting for a scene: one thing at a time beside the defaults, or with `full` each with each. Rays' own length is the
/// force at every sampling, but with no other option changed.
pub fn all(spacings: impl Iterator<Item = f64>, full: bool) -> Vec<Setting> {
    let mut samplings = vec![Sampling::Vertices];
    samplings.extend(spacings.map(|length| Sampling::Spacing(round(length))));
    samplings.extend(ACCURACIES.map(Sampling::Accuracy));
    let mut settings = Vec::new();
    for &sampling in &samplings {
        for precision in [Precision::F32, Precision::F64] {
            for layout in [Layout::Bvh, Layout::PaperOctree] {
                for edges in [true, false] {
                    let changed = usize::from(layout == Layout::PaperOctree) + usize::from(!edges);
                    let is_plain = sampling == Sampling::Vertices || sampling == DEFAULT.sampling;
                    let most = if is_plain && precision == DEFAULT.precision { 1 } else { 0 };
                    if full || changed <= most {
                        settings.push(Setting::Ours(Ours { sampling, precision, layout, edges, ..DEFAULT }));
                    }
                }
            }
            settings.push(Setting::Ours(Ours { law: ContactLaw::RayLength, sampling, precision, ..DEFAULT }));
        }
    }
    for precision in [Precision::F32, Precision::F64] {
        for layout in [Layout::Bvh, Layout::PaperOctree] {
            settings.push(Setting::Ours(Ours { precision, layout, ..PAPER }));
        }
    }
    settings.extend(["embree-refit", "embree-low", "bullet-vf", "bullet-cl", "fcl-aabb"].map(Setting::Peer));
    settings.push(Setting::Closest);
    settings
}

/// To two digits, as a user would write it.
fn round(length: f64) -> f64 {
    let unit = 10f64.powf(length.log10().floor() - 1.0);
    (length / unit).round() * unit
}

impl Setting {
    pub fn method(&self) -> &'static str {
        match self {
            Self::Ours(ours) if !ours.escape => "paper",
            Self::Ours(_) => "raycontact",
            Self::Peer(name) => name,
            Self::Closest => "proximity",
        }
    }

    /// The options and their values.
    pub fn describe(&self, weights: Weights) -> String {
        let weights = match weights {
            Weights::Area => "area",
            Weights::Paper => "paper",
        };
        match self {
            Self::Ours(ours) => {
                let sampling = match ours.sampling {
                    Sampling::Spacing(length) => format!("spacing:{}", format!("{length:.6}").trim_end_matches('0')),
                    Sampling::Accuracy(part) => format!("accuracy:{part}"),
                    Sampling::Vertices => "vertices".to_owned(),
                };
                let layout = if ours.layout == Layout::Bvh { "wide" } else { "classic" };
                let edges = if ours.edges { "on" } else { "off" };
                let precision = ours.precision.name();
                let law = name_of(ours.law);
                format!(
                    "law={law} sampling={sampling} precision={precision} layout={layout} edges={edges} weights={weights}"
                )
            }
            Self::Peer(_) => format!("precision=f32 weights={weights}"),
            Self::Closest => format!("precision=f64 weights={weights}"),
        }
    }

    /// By what its pushes may be weighted.
    pub fn weights(&self) -> &'static [Weights] {
        match self {
            Self::Ours(ours) if !ours.escape => &[Weights::Paper],
            // A pressure without an area is none.
            Self::Ours(ours) if ours.law == ContactLaw::Pressure => &[Weights::Area],
            Self::Ours(_) | Self::Peer("embree-refit" | "embree-low") => &[Weights::Area, Weights::Paper],
            _ => &[Weights::Paper],
        }
    }

    /// By what its forces grow: Algorithm 1 by the length of rays, closest features by a distance.
    pub fn law(&self) -> ContactLaw {
        match self {
            Self::Ours(ours) => ours.law,
            Self::Peer("embree-refit" | "embree-low") => ContactLaw::RayLength,
            Self::Peer(_) | Self::Closest => ContactLaw::Pressure,
        }
    }

    /// Whether its depths are those of the bodies, so that its force can be held against the law's: pairs of triangles
    /// and of clusters have depths of their own.
    pub fn has_comparable_force(&self) -> bool {
        !matches!(self, Self::Peer("fcl-aabb" | "bullet-cl"))
    }

    /// Whether its contacts belong to vertices.
    pub fn knows_vertices(&self) -> bool {
        self.has_comparable_force()
    }

    /// For judging forces: the push of a pair that escapes follows neither law.
    pub fn without_escapes(self) -> Self {
        match self {
            Self::Ours(ours) => Self::Ours(Ours { escape: false, ..ours }),
            other => other,
        }
    }

    pub fn start(&self, workload: &Workload, host: &Host, libraries: &Libraries) -> Result<Box<dyn Method>, String> {
        match self {
            Self::Ours(DEFAULT) => Ok(Box::new(Defaults::new(&libraries.raycontact, workload, host)?)),
            Self::Ours(ours) if ours.precision == Precision::F32 => ours.start::<f32>(workload, host),
            Self::Ours(ours) => ours.start::<f64>(workload, host),
            Self::Peer(name) => Ok(Box::new(libraries.peers.start(&peer_of(name), workload, host)?)),
            Self::Closest => Ok(Box::new(Closest::new(workload, host))),
        }
    }
}

pub fn name_of(law: ContactLaw) -> &'static str {
    match law {
        ContactLaw::Pressure => "pressure",
        ContactLaw::RayLength => "ray-length",
    }
}

/// A peer in single precision on one thread.
pub fn peer_of(name: &'static str) -> Description {
    Description { name, precision: Precision::F32, threads: 1, same_contacts: false, simd: None }
}

impl Ours {
    fn start<T: HostScalar>(&self, workload: &Workload, host: &Host) -> Result<Box<dyn Method>, String> {
        Ok(match self.layout {
            Layout::Bvh => Box::new(Whole::<T>::new(workload, host, 1, self.options())?),
            Layout::PaperOctree => Box::new(Classic::<T>::new(workload, host, self.options())?),
        })
    }

    fn options<T: Scalar>(&self) -> DetectionOptions<T> {
        let sampling = match self.sampling {
            Sampling::Vertices => Sampling::Vertices,
            Sampling::Spacing(length) => Sampling::Spacing(T::of(length)),
            Sampling::Accuracy(part) => Sampling::Accuracy(T::of(part)),
        };
        let Self { law, edges, escape, .. } = *self;
        DetectionOptions { law, sampling, edges, escape, ..DetectionOptions::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_among_the_settings_by_the_words_that_mark_it() {
        let is_default = |setting: &Setting| setting.describe(Weights::Area) == crate::chart::row::DEFAULT;
        let found: Vec<Setting> = all([0.1].into_iter(), true).into_iter().filter(is_default).collect();
        assert_eq!(found, [Setting::Ours(DEFAULT)]);
    }
}
