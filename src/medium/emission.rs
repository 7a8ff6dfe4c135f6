//! Emission of a medium: the radiance gained per metre (P03 eq. 11), and how its points are sampled.
//!
//! A description gives it in one of three ways: as this gain, which needs no extinction; as the radiance of a thick
//! layer (P03's L_e), times the absorption, with the sign that eq. 11 should have; or as the temperature of a black
//! body, which has this radiance by Kirchhoff's law.

use super::{Extinction, MediumBounds, MediumProperties};
use crate::{
    description::{Location, Params, Value, parameter::Parameter, rows},
    error::{Error, Result},
    math::{Affine3A, DVec3, RaySegment, Spectrum, SpectrumExt, Vec3, black_body, vec3},
    sampling::{Discrete, Stream},
    volume::{self, Coarse, Place, Summary, Volume, VolumeModel, check_non_negative},
};
use std::f64::consts::PI;

/// What the volume of an emission gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    /// Radiance gained per metre (W/(m^3 sr)).
    Gain,
    /// Radiance of an opaque layer (W/(m^2 sr)).
    Radiance,
    /// Temperature of a black body (K).
    Temperature,
}

const QUANTITIES: [(&str, Quantity); 3] =
    [("emission", Quantity::Gain), ("radiance", Quantity::Radiance), ("temperature", Quantity::Temperature)];

/// Longest name of a group, so that names of channels have room for it.
const LONGEST_NAME: usize = 200;

/// Beyond Mitsuba: the `group` of emitters that `params` belong to, for images of what each group contributes; any signs
/// that OpenEXR allows in the name of a layer.
pub fn group(params: &Params<'_>) -> Result<Option<String>> {
    let Some(name) = params.optional_string("group")? else { return Ok(None) };
    let fits = name.len() <= LONGEST_NAME && name.chars().all(|sign| sign.is_ascii_graphic());
    if name.is_empty() || !fits {
        let expected = "a name of 1 to 200 ASCII letters, digits and signs";
        return Err(params.complain("group", expected, format!("{name:?}")));
    }
    Ok(Some(name.to_owned()))
}

/// Parameters of media that emit.
pub(super) const EMISSION: &[Parameter] = rows! {
    light_volume("emission", "W/(m^3 sr)", "Radiance emitted per metre, whether or not the medium absorbs.").ours(),
    light_volume("radiance", "W/(m^2 sr)", "In place of `emission`: radiance of a thick layer; emission is this times sigma_a.").ours(),
    light_volume("temperature", "K", "In place of `emission`: temperature of a black body; emission is its radiance times sigma_a.").ours(),
    factor("emission_scale", 1.0, "Scales the emission.").ours(),
    text("group", "a name of 1 to 200 ASCII letters, digits and signs", Optional, "The light group of its emission: a layer of `--groups`.").ours(),
};

/// Emission as the description gives it.
#[derive(Clone, Debug)]
pub struct EmissionDescription {
    name: &'static str,
    quantity: Quantity,
    volume: Volume,
    scale: f32,
    place: Place,
    /// See [`Emission::group`].
    group: Option<String>,
    /// Where it is in the file.
    pub(super) location: Location,
}

impl EmissionDescription {
    /// Reads `emission`, `radiance` or `temperature`, one of them at most, `emission_scale` and `group`.
    pub fn read(params: &Params<'_>, place: &Place, albedo: &Volume) -> Result<Option<Self>> {
        let scale = params.float("emission_scale")? as f32;
        let (group, mut given) = (group(params)?, None);
        for (name, quantity) in QUANTITIES {
            let Some(volume) = volume(params, name, place)? else { continue };
            let location = params.given(name).map_or(params.location(), |p| &p.location).clone();
            let this = Self { name, quantity, volume, scale, place: *place, group: group.clone(), location };
            if let Some(Self { name: other, .. }) = given.replace(this) {
                let expected = "one of emission, radiance and temperature";
                let found = format!("\"{other}\" and \"{name}\"");
                return Err(Error::new(params.location(), expected, found, "remove one of them"));
            }
        }
        let alone = match (&given, scale != 1.0, params.has("group")) {
            (None, true, _) => Some(("emission_scale", "an emission to scale")),
            (None, _, true) => Some(("group", "an emission to show in a group")),
            _ => None,
        };
        if let Some((name, expected)) = alone {
            let remedy =
                format!("give \"emission\", \"radiance\" or \"temperature\" too, or remove \"{name}\"");
            return Err(Error::new(params.location(), expected, "none", remedy));
        }
        let given = given.filter(|given| given.scale > 0.0);
        if let Some(given) = &given {
            given.warn_if_dark(albedo, params);
        }
        Ok(given)
    }

    /// Warns if it is in proportion to an absorption that is nowhere.
    fn warn_if_dark(&self, albedo: &Volume, params: &Params<'_>) {
        let absorbs = match albedo {
            Volume::Constant(albedo) => albedo.eval::<Spectrum>(Vec3::ZERO).min_element() < 1.0,
            _ => true,
        };
        if self.quantity != Quantity::Gain && !absorbs {
            let name = self.name;
            let text = format!(
                "\"{name}\" has no effect: what does not absorb does not glow, and the albedo is 1. Lower the albedo, or give \"emission\""
            );
            params.library.warn(&self.location, &text);
        }
    }

    /// True if it has no end: neither its volume ends, nor the matter that it depends on. Only matter that `varies`
    /// ends.
    pub fn has_no_end(&self, varies: bool) -> bool {
        self.volume.domain().is_none() && (self.quantity == Quantity::Gain || !varies)
    }

    /// The same at `time` (s); none where it is the same at all times.
    pub(super) fn at_time(&self, time: f64) -> Option<Self> {
        let volume = self.volume.at_time(time)?;
        Some(Self { volume, ..self.clone() })
    }

    fn complain(&self, expected: &str, found: &str, remedy: &str) -> Error {
        Error::new(&self.location, format!("{expected} for \"{}\"", self.name), found, remedy)
    }
}

/// The parameter `name` as a volume of light: spectra are light's own.
fn volume(params: &Params<'_>, name: &'static str, place: &Place) -> Result<Option<Volume>> {
    let Some(property) = params.given(name) else { return Ok(None) };
    if matches!(property.value, Value::Object(_) | Value::Reference(_))
        && let Some(child) = params.child(name)?
        && volume::ROWS.has(child.object)
    {
        return volume::build(child.object, params.library, place).map(Some);
    }
    let everywhere = [Vec3::NEG_INFINITY, Vec3::INFINITY];
    let constant = |colour| Volume::Constant(volume::Constant::new(colour, everywhere));
    Ok(params.optional_color(name)?.map(constant))
}

/// The absorption where the emission is.
#[derive(Clone, Debug)]
pub enum Within {
    /// A homogeneous medium.
    Uniform(MediumProperties),
    /// One that varies: its extinction and albedo.
    Varying(Box<(Extinction, Volume)>),
}

impl Within {
    #[inline]
    fn at(&self, position: Vec3) -> MediumProperties {
        match self {
            Self::Uniform(properties) => *properties,
            Self::Varying(varying) => {
                let (extinction, albedo) = &**varying;
                MediumProperties::of(extinction.at(position), albedo.eval(position))
            }
        }
    }

    /// The most extinction and the least albedo within a box.
    fn bounds(&self, low: Vec3, high: Vec3) -> MediumProperties {
        match self {
            Self::Uniform(properties) => *properties,
            Self::Varying(varying) => {
                let (extinction, albedo) = &**varying;
                let sigma_t = extinction.volume.range(low, high)[1] * extinction.scale;
                MediumProperties::of(sigma_t, albedo.range(low, high)[0])
            }
        }
    }
}

/// The absorption coefficient (1/m).
fn absorption(properties: MediumProperties) -> Spectrum {
    properties.sigma_t * (Spectrum::ONE - properties.albedo).max(Spectrum::ZERO)
}

/// Radiance gained per metre, at every point.
#[derive(Clone, Debug)]
struct Field {
    quantity: Quantity,
    volume: Volume,
    scale: f32,
    within: Within,
    low: Vec3,
    high: Vec3,
}

impl Field {
    #[inline]
    fn at(&self, position: Vec3) -> Spectrum {
        let inside = position.cmpge(self.low).all() && position.cmple(self.high).all();
        if !(inside && self.volume.contains(position)) {
            return Spectrum::ZERO;
        }
        let absorbed = || absorption(self.within.at(position));
        let gain = match self.quantity {
            Quantity::Gain => self.volume.eval(position),
            Quantity::Radiance => absorbed() * self.volume.eval::<Spectrum>(position),
            Quantity::Temperature => absorbed() * black_body::radiance(self.volume.eval(position)),
        };
        // Rounding may bring a gain of 0 below 0.
        gain.max(Spectrum::ZERO) * self.scale
    }

    /// A bound of the gain's channels within a box.
    fn most(&self, low: Vec3, high: Vec3) -> f32 {
        let [_, most] = self.volume.range(low, high);
        let absorbed = || absorption(self.within.bounds(low, high));
        let gain = match self.quantity {
            Quantity::Gain => most,
            Quantity::Radiance => absorbed() * most,
            // Hotter is brighter, in every channel.
            Quantity::Temperature => absorbed() * black_body::radiance(most.x),
        };
        gain.max_element().max(0.0) * self.scale
    }

    fn is_uniform(&self) -> bool {
        matches!((&self.within, &self.volume), (Within::Uniform(_), Volume::Constant(_)))
    }

    /// A coarse view of it: one cell where it is the same everywhere.
    fn coarse(&self) -> Coarse {
        if !self.is_uniform() {
            return Coarse::of(self.low, self.high, |p| self.at(p), |low, high| [0.0, self.most(low, high)]);
        }
        let (size, gain) = (self.high - self.low, self.at(0.5 * (self.low + self.high)));
        let to_cells = Affine3A::from_scale(1.0 / size) * Affine3A::from_translation(-self.low);
        let all = Summary { least: gain.min_element(), most: gain.max_element(), mean: gain };
        Coarse::from_cells([1; 3], to_cells, vec![all])
    }
}

/// The most radiance gained per metre: products with volumes and lengths of any scene stay finite.
const BRIGHTEST: f32 = 1e30;

/// The box that holds all emission.
fn extent(given: &EmissionDescription, within: &Within, around: &MediumBounds) -> [Vec3; 2] {
    let of_matter = match within {
        Within::Varying(varying) if given.quantity != Quantity::Gain => Some([varying.0.low, varying.0.high]),
        _ => None,
    };
    let common = |[low, high]: [Vec3; 2], [a, b]: [Vec3; 2]| [low.max(a), high.min(b)];
    let known = given.volume.domain().into_iter().chain(of_matter);
    let known = known.fold([Vec3::NEG_INFINITY, Vec3::INFINITY], common);
    let ends = !around.is_bound && known.iter().all(|corner| corner.is_finite());
    if ends { known } else { common(known, [around.low, around.high]) }
}

/// A cell is chosen as if its mean emission were higher by this fraction of its maximum, to find emission that the few
/// points examined in the cell missed.
const FLOOR: f32 = 0.1;

/// The emission of a medium.
#[derive(Clone, Debug)]
pub struct Emission {
    field: Field,
    coarse: Coarse,
    /// Chosen by power.
    cells: Discrete,
    /// 1 over the integral of the cells' maxima along a line, averaged over lines through the box.
    per_line: f32,
    power: DVec3,
    group: Option<String>,
}

impl Emission {
    /// The group whose image shows it; none for the group of the rest.
    pub fn group(&self) -> Option<&str> {
        self.group.as_deref()
    }

    /// Examines the `given` emission in matter as `within`; it lies `around` where neither has bounds. None where
    /// nothing emits.
    pub fn new(given: EmissionDescription, within: Within, around: &MediumBounds) -> Result<Option<Self>> {
        let [low, high] = extent(&given, &within, around);
        if !low.cmplt(high).all() {
            return Ok(None);
        }
        check_non_negative(&given.volume, low, high)
            .map_err(|negative| negative.error(&given.location, &given.place))?;
        if given.quantity == Quantity::Temperature && !given.volume.is_grey() {
            return Err(given.complain("one number per point", "a colour", "give a temperature in Kelvin"));
        }
        let most = given.volume.range(low, high)[1];
        let EmissionDescription { quantity, volume, scale, .. } = given.clone();
        let field = Field { quantity, volume, scale, within, low, high };
        if !(most.is_finite() && field.most(low, high) <= BRIGHTEST) {
            let found = format!("up to {:e}", field.most(low, high).max(most.max_element()));
            let expected = "less than 1e30 W/(m^3 sr) of emission";
            return Err(given.complain(expected, &found, "reduce it, or reduce emission_scale"));
        }
        let coarse = field.coarse();
        Ok(Self::of(field, coarse).map(|emission| Self { group: given.group, ..emission }))
    }

    fn of(field: Field, coarse: Coarse) -> Option<Self> {
        let cells = || coarse.cells().iter();
        let weight = |cell: &Summary| f64::from(cell.mean.luminance() + FLOOR * cell.most);
        let chosen = Discrete::new(cells().map(weight));
        let size = (field.high - field.low).as_dvec3();
        // A box's mean chord is 4 V / S (Cauchy).
        let surface = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let most: f64 = cells().map(|cell| f64::from(cell.most)).sum();
        let per_line = surface / (4.0 * most * coarse.cell_volume());
        let mean: DVec3 = cells().map(|cell| cell.mean.as_dvec3()).sum();
        let power = mean * (coarse.cell_volume() * 4.0 * PI);
        (!chosen.is_empty()).then_some(Self {
            field,
            coarse,
            cells: chosen,
            per_line: per_line as f32,
            power,
            group: None,
        })
    }

    /// Power emitted in the whole box (W).
    pub fn power(&self) -> DVec3 {
        self.power
    }

    /// The box that holds it.
    pub fn bounds(&self) -> [Vec3; 2] {
        [self.field.low, self.field.high]
    }

    /// Radiance gained per metre at `position` (W/(m^3 sr)).
    #[inline]
    pub fn at(&self, position: Vec3) -> Spectrum {
        self.field.at(position)
    }

    /// A point, in proportion to the power around it.
    #[inline]
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        let (cell, _) = self.cells.sample_precisely(stream.uniform_precisely());
        self.sample_in(cell as u32, stream)
    }

    /// A point of `cell`, uniform.
    #[inline]
    pub fn sample_in(&self, cell: u32, stream: &mut Stream) -> Vec3 {
        self.position_in(cell, vec3(stream.uniform(), stream.uniform(), stream.uniform()))
    }

    /// The world position of `u` in [0, 1)^3 of `cell`.
    pub fn position_in(&self, cell: u32, u: Vec3) -> Vec3 {
        self.coarse.position(cell, u)
    }

    /// How many cells there are, dark ones among them.
    pub fn cell_count(&self) -> usize {
        self.coarse.cells().len()
    }

    /// The cell around a position; none outside of all.
    #[inline]
    pub fn cell_at(&self, position: Vec3) -> Option<u32> {
        self.coarse.cell_at(position)
    }

    /// The part of all power that `cell` is taken to have.
    pub fn cell_probability(&self, cell: u32) -> f64 {
        self.cells.probability_precisely(cell as usize)
    }

    /// Mean squared distance of a cell's points from its centre (m^2).
    pub fn cell_variance(&self) -> f64 {
        self.coarse.cell_variance()
    }

    /// Density of `sample_in` (1/m^3).
    #[inline]
    pub fn pdf_vol_in_cell(&self) -> f32 {
        (1.0 / self.coarse.cell_volume()) as f32
    }

    /// Density of `sample` (1/m^3).
    #[inline]
    pub fn pdf_vol(&self, position: Vec3) -> f32 {
        let chosen = |cell| self.cells.probability_precisely(cell as usize) / self.coarse.cell_volume();
        self.coarse.cell_at(position).map_or(0.0, |cell| chosen(cell) as f32)
    }

    /// Nominal rate at which a camera subpath that passes `position` samples emission there (1/m): the density in the
    /// weights, per channel of extinction.
    ///
    /// A walk really samples one point on each of its flights, which have random lengths. In thin matter the rate is
    /// the density of `sample_along` on a whole line, here a mean line; in thick matter it is 1 over the mean free path
    /// of flights.
    #[inline]
    pub fn rate(&self, position: Vec3) -> Spectrum {
        let most = self.coarse.cell_at(position).map_or(0.0, |cell| self.coarse.cell(cell).most);
        self.field.within.at(position).sigma_t + self.per_line * most
    }

    /// A point of `segment`, in proportion to the maxima of the cells it crosses: t (m) and the density
    /// (1/m); none where nothing emits.
    #[inline]
    pub fn sample_along(&self, segment: &RaySegment, stream: &mut Stream) -> Option<(f32, f32)> {
        let most = |piece: &volume::Piece| self.coarse.cell(piece.cell).most;
        let total: f32 =
            self.coarse.pieces(segment).map(|piece| most(&piece) * (piece.last - piece.first)).sum();
        if !(total > 0.0 && total < f32::INFINITY) {
            return None;
        }
        let mut remaining = stream.uniform() * total;
        let mut met = None;
        for piece in self.coarse.pieces(segment).filter(|piece| most(piece) > 0.0) {
            let (length, most) = (piece.last - piece.first, most(&piece));
            met = Some((piece.first + (remaining / most).min(length), most / total));
            if remaining < most * length {
                break;
            }
            remaining -= most * length;
        }
        met
    }
}

#[cfg(test)]
mod tests;
