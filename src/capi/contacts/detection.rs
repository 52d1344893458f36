use crate::capi::base::rayc_status;
use crate::capi::ffi::{
    Failure, Options, changing, check_reserved, flag, growing, guard, read_options, unknown_enum, with_precision,
    write_defaults, write_options,
};
use crate::capi::scene::rayc_scene;
use crate::contact::{ContactLaw, DetectionOptions, Sampling};
use crate::math::Scalar;
use crate::memory::text;

/// Where on a surface rays start.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum rayc_sampling {
    /// Where the load needs them: from patches of connected, nearly flat triangles, from triangles, or from parts of
    /// triangles, halved where the other surface crosses them, where the depth bends, and where they carry much of the load,
    /// until the error is about the one allowed. sampling_value is that error, in (0, 1]: by how much each pair's net force,
    /// and its torque over the overlap box's half diagonal, may differ from the exact ones, as a part of that force, or of a
    /// tenth of the sizes of all forces where these cancel; 0 stands for 0.01. It is an estimate, not a bound.
    ///
    /// In a crowd each pair may be off by more: where the boxes of both bodies overlap those of at least n others, n > 12,
    /// n / 12 times as much, at most 16 times. Such pairs are counted as crowded_pairs in rayc_statistics.
    ///
    /// Under RAYC_LAW_RAY_LENGTH and with an open mesh, a ray starts in the middle of each triangle. Triangles that are large
    /// beside the overlap are cut first, so that about 128 rays start from an area as large as the largest face of the overlap
    /// box; in a crowd 128 · 12 / n, but no fewer than 8. Of a body with itself each triangle casts one ray.
    RAYC_SAMPLING_ACCURACY = 0,
    /// About sampling_value apart, a length > 0. Larger triangles are cut into pieces of that size, and a ray starts
    /// from the middle of each piece. Smaller triangles are joined to patches of that size, connected and nearly flat,
    /// and one ray starts from the middle of each patch.
    RAYC_SAMPLING_SPACING = 1,
    /// At the vertices, as in the paper.
    RAYC_SAMPLING_VERTICES = 2,
}

/// What a contact's force grows with.
#[repr(C)]
#[derive(Clone, Copy)]
pub enum rayc_law {
    /// Pressure by depth below the surface: at every surface point inside the other body, k times the distance to the
    /// nearest point of that body's surface, along the inward normal; a contact's cos_alpha is that distance over its
    /// depth. The force is the negative gradient of an energy, so on a closed path it does no work. On a round body in
    /// a flat face it is the buoyancy of Archimedes; elsewhere it is near hydroelastic contact (Elandt et al., IROS
    /// 2019). Where a body folds over itself, forces follow RAYC_LAW_RAY_LENGTH instead.
    RAYC_LAW_PRESSURE = 0,
    /// The paper's: k times the ray's length times the cosine of its angle, at points whose ray leaves the other body
    /// before it leaves their own (Hermann, Faure, Raffin 2008, section 4). Beside edges such forces may point the
    /// wrong way.
    RAYC_LAW_RAY_LENGTH = 1,
}

/// How contacts are found. Fill with rayc_default_detection_options(), then change what you need.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct rayc_detection_options {
    /// sizeof(rayc_detection_options).
    pub struct_size: usize,
    /// With RAYC_SAMPLING_ACCURACY it is the error allowed of each pair's net force, as a part of that force: above 0 and at
    /// most 1, or 0 for 0.01. With RAYC_SAMPLING_SPACING it is the distance between rays, a length above 0. With
    /// RAYC_SAMPLING_VERTICES it is 0. Default 0.
    pub sampling_value: f64,
    /// Where rays start, a rayc_sampling. Default RAYC_SAMPLING_ACCURACY.
    pub sampling: u32,
    /// 1: edges are traced too where no ray settles whether bodies overlap; 0: not. Default 1.
    pub edges: u32,
    /// 1: in a scene, a pair whose contacts cannot part it (one body swallowed, or held in the other's folds) is pushed
    /// along one direction until it is apart; 0: not. Default 1.
    pub escape: u32,
    /// 1: rays look past other folds of either body, by the winding number. A ray that meets its own body first
    /// is refused only where it has left the body altogether. A ray that enters another fold of the other body on
    /// its way out is not taken for one from outside. 0: they do not. For bodies that overlap themselves; a scene
    /// does this by itself for bodies whose self-collision is switched on. Default 0.
    pub past_folds: u32,
    /// What forces grow with, a rayc_law. Default RAYC_LAW_PRESSURE.
    pub law: u32,
    /// Always 0.
    pub reserved: u32,
}

growing!(rayc_detection_options);

impl rayc_detection_options {
    fn sampling<T: Scalar>(&self) -> Result<Sampling<T>, Failure> {
        use rayc_sampling::*;
        let value = self.sampling_value;
        let (sampling, is_valid, valid) = match self.sampling {
            s if s == RAYC_SAMPLING_ACCURACY as u32 && value == 0.0 => (Sampling::default(), true, ""),
            s if s == RAYC_SAMPLING_ACCURACY as u32 => {
                let valid = "a part > 0 and at most 1, or 0 for the default";
                (Sampling::Accuracy(T::of(value)), value > 0.0 && value <= 1.0, valid)
            }
            s if s == RAYC_SAMPLING_VERTICES as u32 => (Sampling::Vertices, value == 0.0, "0"),
            s if s == RAYC_SAMPLING_SPACING as u32 => {
                (Sampling::Spacing(T::of(value)), value > 0.0 && value.is_finite(), "a finite length > 0")
            }
            other => return Err(unknown_enum("sampling", other, "rayc_sampling")),
        };
        if is_valid {
            return Ok(sampling);
        }
        let name = ["ACCURACY", "SPACING", "VERTICES"][self.sampling as usize];
        let message = text!("sampling_value is {value} with RAYC_SAMPLING_{name}; give {valid}");
        Err(Failure::new(rayc_status::RAYC_STATUS_INVALID_OPTION, message))
    }

    pub(in crate::capi) fn detection<T: Scalar>(&self) -> Result<DetectionOptions<T>, Failure> {
        check_reserved("rayc_detection_options", self.reserved)?;
        let law = match self.law {
            law if law == rayc_law::RAYC_LAW_PRESSURE as u32 => ContactLaw::Pressure,
            law if law == rayc_law::RAYC_LAW_RAY_LENGTH as u32 => ContactLaw::RayLength,
            other => return Err(unknown_enum("law", other, "rayc_law")),
        };
        Ok(DetectionOptions {
            law,
            sampling: self.sampling()?,
            edges: flag("edges", self.edges)?,
            escape: flag("escape", self.escape)?,
            past_folds: flag("past_folds", self.past_folds)?,
        })
    }
}

impl Options for rayc_detection_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>(),
            sampling_value: 0.0,
            sampling: rayc_sampling::RAYC_SAMPLING_ACCURACY as u32,
            edges: 1,
            escape: 1,
            past_folds: 0,
            law: rayc_law::RAYC_LAW_PRESSURE as u32,
            reserved: 0,
        }
    }
}

/// Fills `options` with the defaults. struct_size: sizeof(rayc_detection_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_default_detection_options(
    struct_size: usize,
    options: *mut rayc_detection_options,
) -> rayc_status {
    guard(|| write_defaults(struct_size, options))
}

/// Fills `options` with what makes a query just what the paper does: rays from the vertices, its two filters and its law,
/// nothing else. Its forces are those with RAYC_WEIGHTING_VERTEX in rayc_response_options. struct_size:
/// sizeof(rayc_detection_options).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_paper_detection_options(
    struct_size: usize,
    options: *mut rayc_detection_options,
) -> rayc_status {
    let paper = rayc_detection_options {
        sampling: rayc_sampling::RAYC_SAMPLING_VERTICES as u32,
        edges: 0,
        escape: 0,
        law: rayc_law::RAYC_LAW_RAY_LENGTH as u32,
        ..rayc_detection_options::defaults()
    };
    guard(|| write_options(struct_size, options, "options", paper))
}

/// Sets how contacts are found from the next query on. options: NULL for the defaults.
///
/// Errors: RAYC_STATUS_INVALID_OPTION.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rayc_scene_set_detection_options(
    scene: *mut rayc_scene,
    options: *const rayc_detection_options,
) -> rayc_status {
    guard(|| {
        let options = read_options(options)?;
        with_precision!(&mut changing(scene, "scene")?.scene, |scene| scene.set_options(options.detection()?));
        Ok(())
    })
}
