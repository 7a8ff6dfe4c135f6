//! What an image file can hold besides the image: layers of channels, named as Mitsuba's `aov` and `moment`
//! integrators name them.

use crate::description::Registry;

/// Quantities of the first surface that a primary ray hits, or of where it interacts first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// pi times the BSDF towards the normal; of a diffuse surface its reflectance.
    Albedo,
    /// Distance from the near clip plane along the ray (m).
    Depth,
    /// World position (m).
    Position,
    /// Texture coordinates.
    Uv,
    /// Geometric normal, world space.
    GeometricNormal,
    /// Shading normal, world space.
    ShadingNormal,
    /// Change of position with the first texture coordinate (m).
    DpDu,
    /// Change of position with the second texture coordinate (m).
    DpDv,
    /// Change of the texture coordinates with a step across the film of 1 / sqrt(samples per pixel) pixels,
    /// to where the ray from the lens hits the tangent plane (Mitsuba starts that ray at the near clip plane).
    DuvDx,
    /// The same for a step down.
    DuvDy,
    /// Number of the primitive in its shape, from 0: the triangle of a mesh, the face of a cube (Mitsuba counts
    /// triangles there too).
    PrimitiveIndex,
    /// Number of the shape in the order of the scene file, from 1 (Mitsuba's depend on how it stores shapes).
    ShapeIndex,
    /// Albedo where the ray interacts first: of the medium at a collision, else of the surface. Media are seen here, and
    /// their boundaries are not; denoisers look at this.
    FirstAlbedo,
    /// Shading normal where the ray interacts first, world space; at a collision the direction back to the camera.
    FirstNormal,
}

/// Every quantity by Mitsuba's name; `first_albedo` and `first_normal` are ours.
pub const QUANTITIES: Registry<Quantity> = Registry::new(
    "a quantity",
    &[
        ("albedo", Quantity::Albedo),
        ("depth", Quantity::Depth),
        ("position", Quantity::Position),
        ("uv", Quantity::Uv),
        ("geo_normal", Quantity::GeometricNormal),
        ("sh_normal", Quantity::ShadingNormal),
        ("dp_du", Quantity::DpDu),
        ("dp_dv", Quantity::DpDv),
        ("duv_dx", Quantity::DuvDx),
        ("duv_dy", Quantity::DuvDy),
        ("prim_index", Quantity::PrimitiveIndex),
        ("shape_index", Quantity::ShapeIndex),
        ("first_albedo", Quantity::FirstAlbedo),
        ("first_normal", Quantity::FirstNormal),
    ],
);

impl Quantity {
    /// True of those of the first interaction.
    pub fn is_of_interaction(self) -> bool {
        matches!(self, Self::FirstAlbedo | Self::FirstNormal)
    }

    /// Mitsuba's names of its channels.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Albedo | Self::FirstAlbedo => &["R", "G", "B"],
            Self::Depth => &["T"],
            Self::Uv | Self::DuvDx | Self::DuvDy => &["U", "V"],
            Self::Position
            | Self::GeometricNormal
            | Self::ShadingNormal
            | Self::FirstNormal
            | Self::DpDu
            | Self::DpDv => &["X", "Y", "Z"],
            Self::PrimitiveIndex | Self::ShapeIndex => &["I"],
        }
    }
}

/// The components of radiance in P03 eq. 17, by what happens in media between the lens and the first vertex of the path
/// from there. Boundaries where only the medium changes are no vertices. Scattered light is split further, by the
/// number of vertices in media on the whole path; others may be on surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// L_un: that vertex is on a surface, or it is an emitter other than a medium.
    Unscattered,
    /// L_e: it is where a medium emits.
    Emitted,
    /// Part of L_sc: that vertex is a collision in a medium, and the only one.
    Single,
    /// Part of L_sc: there are more.
    Multiple,
}

impl Component {
    /// Every component.
    pub const ALL: [Self; 4] = [Self::Unscattered, Self::Emitted, Self::Single, Self::Multiple];

    /// The component of a path of several segments, by whether its first vertex from the lens is in a medium, and by
    /// its number of `collisions`.
    #[inline]
    pub fn of(is_first_in_medium: bool, collisions: u32) -> Self {
        match (is_first_in_medium, collisions) {
            (false, _) => Self::Unscattered,
            (true, 0 | 1) => Self::Single,
            (true, _) => Self::Multiple,
        }
    }

    /// The component of a path of one segment, by whether its emitter is a medium.
    #[inline]
    pub fn of_emitter(is_medium: bool) -> Self {
        if is_medium { Self::Emitted } else { Self::Unscattered }
    }

    /// What its layer is called.
    pub fn name(self) -> &'static str {
        ["unscattered", "emitted", "scattered.single", "scattered.multiple"][self as usize]
    }
}

/// Some of the light of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// That of a group of emitters: its number, in the order of [`Lights::groups`](crate::scene::lights::Lights::groups).
    pub group: Option<u32>,
    /// That of a component.
    pub component: Option<Component>,
}

impl Part {
    /// True of the light of emitters of the group `group` that comes as `component`.
    pub fn has(&self, group: u32, component: Component) -> bool {
        self.group.is_none_or(|own| own == group) && self.component.is_none_or(|own| own == component)
    }
}

/// A layer for each of the `components` of the light of each of the `groups`; an empty list does not split it.
pub fn parts(groups: &[&str], components: &[Component]) -> Vec<Layer> {
    let of_groups = (0..).zip(groups).map(|(group, name)| Layer {
        name: format!("group.{name}"),
        content: Content::Part(Part { group: Some(group), component: None }),
    });
    if components.is_empty() {
        return of_groups.collect();
    }
    let of_group = |(group, before): (Option<u32>, String)| {
        components.iter().map(move |component| Layer {
            name: format!("{before}{}", component.name()),
            content: Content::Part(Part { group, component: Some(*component) }),
        })
    };
    match groups {
        [] => of_group((None, String::new())).collect(),
        _ => (0..)
            .zip(of_groups)
            .map(|(group, layer)| (Some(group), layer.name + "."))
            .flat_map(of_group)
            .collect(),
    }
}

/// What a layer holds.
///
/// Moments are those of one pass over the image, which for the path tracer is one sample per pixel. With box,
/// tent and Gaussian filters, E of the squared pass is the filtered square of a sample's radiance: Mitsuba's
/// second moment. A filter with negative lobes makes it larger (a sample's signed weight is squared too), and
/// what light subpaths contribute adds to the pass before it is squared, so that with `bdpt` and `ptracer`
/// the moment is that of the estimator, not of one path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Of the first surface.
    Surface(Quantity),
    /// The image, as R, G, B, A.
    Image,
    /// The image in XYZ.
    Mean,
    /// Mean squares of X, Y, Z over the passes.
    SecondMoment,
    /// What some of the light contributes to the image's R, G, B.
    Part(Part),
    /// Variances of the image's R, G, B: how far its mean over all passes may be off, squared.
    Variance,
}

/// A group of channels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layer {
    /// What its channels' names begin with.
    pub name: String,
    /// What it holds.
    pub content: Content,
}

impl Layer {
    /// What its channels' names end with.
    pub fn suffixes(&self) -> &'static [&'static str] {
        match self.content {
            Content::Surface(quantity) => quantity.channels(),
            Content::Image => &["R", "G", "B", "A"],
            Content::Mean | Content::SecondMoment => &["X", "Y", "Z"],
            Content::Part(_) | Content::Variance => &["R", "G", "B"],
        }
    }

    /// Its channels' names.
    pub fn channel_names(&self) -> impl Iterator<Item = String> + '_ {
        self.suffixes().iter().map(|suffix| format!("{}.{suffix}", self.name))
    }

    /// True if it holds a part of the image's contributions, which are sorted as they are made.
    pub fn is_sorted(&self) -> bool {
        matches!(self.content, Content::Part(_))
    }

    /// True if denoisers need it.
    pub fn is_for_denoisers(&self) -> bool {
        matches!(self.content, Content::Surface(Quantity::FirstAlbedo | Quantity::FirstNormal))
    }

    /// True if it needs the squares of passes.
    pub fn needs_squares(&self) -> bool {
        matches!(self.content, Content::SecondMoment | Content::Variance)
    }
}
