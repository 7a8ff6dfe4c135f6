//! Phase functions: one file a model; this page is the contract and the registry.
//!
//! At a point all but flakes depend on the angle between the directions of flight before and after scattering alone (cos >
//! 0 is forward), are normalised to 1 over the sphere, and are sampled exactly: the density of a sampled direction
//! is the value of the function, both ways; of flakes, that times the area that they show is the same both ways. A
//! blend and flakes may differ from one point to another.

mod blend;
mod cornette_shanks;
mod deflection;
mod diffuse_sphere;
mod gaussian;
mod hg;
mod isotropic;
mod linear;
mod mie;
mod mie_reflecting;
mod rayleigh;
mod sakas;
mod schlick;
mod sggx;
mod specular_sphere;
mod table;
#[cfg(test)]
mod tests;

pub use blend::Blend;
pub use cornette_shanks::CornetteShanks;
pub use deflection::Deflection;
pub use diffuse_sphere::DiffuseSphere;
pub use gaussian::Gaussian;
pub use hg::HenyeyGreenstein;
pub use isotropic::Isotropic;
pub use linear::Linear;
pub use mie::Mie;
pub use mie_reflecting::MieReflecting;
pub use rayleigh::Rayleigh;
pub use sakas::Sakas;
pub use schlick::Schlick;
pub use sggx::Sggx;
pub use specular_sphere::SpecularSphere;
pub use table::Table;

use crate::description::{Library, Object, Params, Plugin, Registry, models};
use crate::error::Result;
use crate::math::{Frame, Vec3};
use crate::sampling::Stream;
use crate::volume::Place;

/// What every phase function can do.
pub trait PhaseModel {
    /// Value and sampling density (1/sr) of a turn from an old to a new direction of flight.
    fn pdf_sr(&self, turn: Deflection) -> f32;

    /// A new direction of flight after `direction`, with exactly `pdf`.
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3;

    /// The mean cosine, g, in [-1, 1].
    fn mean_cosine(&self) -> f32;
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model: its type,
/// and each of its names with the `fn(&Params) -> Result<Self>` that builds it and the table of its parameters; `placed`
/// where that asks for the place too. For the tests a model has `fn examples() -> Vec<Self>`.
macro_rules! phases {
    (@build $model:ident $build:ident) => {
        |params: &Params<'_>, _: &Place| $model::$build(params).map(Phase::$model)
    };
    (@build $model:ident $build:ident placed) => {
        |params: &Params<'_>, place: &Place| $model::$build(params, place).map(Phase::$model)
    };
    ($($model:ident: $($name:literal => $build:ident $table:ident $($placed:ident)?),+;)*) => {
        models! {
            /// Any phase function.
            Phase: PhaseModel [$($model)*]
            #[inline] fn pdf_sr(turn: Deflection) -> f32;
            #[inline] fn sample(direction: Vec3, stream: &mut Stream) -> Vec3;
            fn mean_cosine() -> f32;
        }

        /// Every phase function there is, by plugin name.
        pub const ROWS: Registry<Plugin<BuildPhase>> = Registry::new("a phase function", &[
            $($(($name, Plugin {
                table: $model::$table,
                build: phases!(@build $model $build $($placed)?),
            }),)+)*
        ]);

        /// Instances of every model, for the tests that hold for all.
        #[cfg(test)]
        fn examples() -> Vec<Phase> {
            let mut all = Vec::new();
            $(all.extend($model::examples().into_iter().map(Phase::$model));)*
            all
        }
    };
}

phases! {
    Isotropic: "isotropic" => build TABLE;
    Linear: "linear" => build TABLE;
    Rayleigh: "rayleigh" => build TABLE;
    HenyeyGreenstein: "hg" => build TABLE;
    CornetteShanks: "cornette_shanks" => build TABLE;
    Schlick: "schlick" => build TABLE;
    Mie: "mie" => build TABLE, "mie_hazy" => hazy HAZY_TABLE, "mie_murky" => murky MURKY_TABLE;
    MieReflecting: "mie_reflecting" => build TABLE;
    Sakas: "sakas" => build TABLE;
    Gaussian: "gaussian" => build TABLE;
    DiffuseSphere: "diffuse_sphere" => build TABLE;
    SpecularSphere: "specular_sphere" => build TABLE;
    Sggx: "sggx" => build TABLE placed;
    Table: "tabphase" => build TABLE;
    Blend: "blendphase" => build TABLE placed, "two_term_hg" => two_term_hg HG_TABLE,
        "two_term_schlick" => two_term_schlick SCHLICK_TABLE;
}

/// How a phase function is built.
pub type BuildPhase = fn(&Params<'_>, &Place) -> Result<Phase>;

/// Builds the phase function that `object` describes.
pub fn build(object: &Object, library: &Library, place: &Place) -> Result<Phase> {
    let (params, build) = ROWS.read(object, library)?;
    let built = build(&params, place)?;
    params.finish()?;
    Ok(built)
}

/// The world direction that `local` is in a frame around `direction`. It is made unit again: in a walk of
/// thousands of scatterings the rounding of lengths would add up.
#[inline]
fn deflect(direction: Vec3, local: Vec3) -> Vec3 {
    Frame::around(direction).to_world(local).normalize()
}
