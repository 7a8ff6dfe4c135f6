//! What is known about where media lie before any point is located.

use super::{Locator, Votes, only_medium};
use crate::{
    math::{Bounds, Vec3},
    medium::MediumIndex,
    scene::{accel::Geometry, media::boundary::Side, surface::Surface},
};
use std::collections::BTreeSet;

/// The medium at infinity, by direction.
#[derive(Clone, Debug)]
pub enum Infinity {
    /// Nothing with a known medium was seen to reach it; this is assumed.
    Unseen(MediumIndex),
    /// The same all around.
    Uniform(MediumIndex),
    /// Unit directions towards it, and what lies there; the nearest one counts.
    Directional(Vec<(Vec3, MediumIndex)>),
}

impl Infinity {
    /// The medium in unit `direction`.
    pub fn towards(&self, direction: Vec3) -> MediumIndex {
        match self {
            Self::Unseen(medium) | Self::Uniform(medium) => *medium,
            Self::Directional(seen) => {
                let nearest = seen.iter().max_by(|a, b| direction.dot(a.0).total_cmp(&direction.dot(b.0)));
                nearest.map_or(MediumIndex::VACUUM, |(_, medium)| *medium)
            }
        }
    }

    fn of(seen: Vec<(Vec3, MediumIndex)>, otherwise: MediumIndex) -> Self {
        let mut votes = Votes::default();
        seen.iter().for_each(|(_, medium)| votes.add(*medium, None));
        match votes.settled() {
            None => Self::Unseen(otherwise),
            Some((medium, None)) => Self::Uniform(medium),
            Some(_) => Self::Directional(seen),
        }
    }

    /// True if it is the same all around.
    pub fn is_uniform(&self) -> bool {
        !matches!(self, Self::Directional(_))
    }

    /// The same; none where it is only assumed.
    pub(super) fn seen_towards(&self, direction: Vec3) -> Option<MediumIndex> {
        (!matches!(self, Self::Unseen(_))).then(|| self.towards(direction))
    }

    /// The medium of most directions that were seen.
    pub fn most(&self) -> MediumIndex {
        match self {
            Self::Unseen(medium) | Self::Uniform(medium) => *medium,
            Self::Directional(seen) => {
                let mut votes = Votes::default();
                seen.iter().for_each(|(_, medium)| votes.add(*medium, None));
                votes.settled().map_or(MediumIndex::VACUUM, |(medium, _)| medium)
            }
        }
    }
}

/// What is known about the media of a scene before anything is located.
#[derive(Clone, Debug)]
pub struct Known {
    /// Shapes with a known medium on some side.
    pub(super) boundaries: Vec<u32>,
    /// Points whose medium is stated, or has been located.
    pub(super) points: Vec<(Vec3, MediumIndex)>,
    /// The only medium that anything in the scene names.
    pub(super) only: Option<MediumIndex>,
    /// What surrounds the scene.
    pub infinity: Infinity,
}

/// An unblocked segment from a side of a boundary in one medium to one in another.
#[derive(Clone, Copy, Debug)]
pub struct Contradiction {
    /// The shape where the way begins; none for a point whose medium is stated.
    pub from: Option<u32>,
    /// The medium there.
    pub medium: MediumIndex,
    /// Where it ends.
    pub at: Side,
}

/// What the boundaries of a scene say about each other.
#[derive(Debug, Default)]
pub struct Survey {
    /// Where they are open or overlap.
    pub contradictions: Vec<Contradiction>,
    /// Per medium, least and greatest corner of what rays within it have hit; infinite where they hit nothing.
    pub extents: Vec<Option<Bounds>>,
    pub(super) escapes: Vec<(Vec3, MediumIndex)>,
}

impl Survey {
    /// Every contradicting pair once, with the number of rays that prove it, most first. A single ray may have slipped
    /// through an edge.
    pub fn proven(&self) -> Vec<(&Contradiction, usize)> {
        let key = |c: &Contradiction| (c.from, c.medium, c.at.shape, c.at.medium);
        let mut found: Vec<(&Contradiction, usize)> = Vec::new();
        for contradiction in &self.contradictions {
            match found.iter_mut().find(|(first, _)| key(first) == key(contradiction)) {
                Some((_, count)) => *count += 1,
                None => found.push((contradiction, 1)),
            }
        }
        found.retain(|(_, count)| *count > 1);
        found.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        found
    }

    /// The shapes that contradict each other. What a camera or emitter states wrongly says nothing of shapes.
    pub fn shapes(&self) -> BTreeSet<u32> {
        let proven = self.proven().into_iter();
        proven.filter_map(|(found, _)| Some([found.from?, found.at.shape])).flatten().collect()
    }

    pub(super) fn extend(&mut self, medium: MediumIndex, bounds: Bounds) {
        let index = medium.0 as usize;
        self.extents.resize(self.extents.len().max(index + 1), None);
        self.extents[index] = Some(self.extents[index].map_or(bounds, |all| all.union(bounds)));
    }
}

impl Known {
    /// Looks around from all boundaries and the `points` whose medium is stated; with neither, everything lies in
    /// `otherwise`.
    pub fn survey(
        geometry: &Geometry,
        surfaces: &[Surface],
        points: Vec<(Vec3, MediumIndex)>,
        otherwise: MediumIndex,
    ) -> (Self, Survey) {
        let boundaries = (0..surfaces.len() as u32).filter(|i| surfaces[*i as usize].boundary.is_known());
        let known = Self {
            only: only_medium(surfaces, &points, otherwise),
            boundaries: boundaries.collect(),
            points,
            infinity: Infinity::Unseen(otherwise),
        };
        if let Some(medium) = known.only {
            return (Self { infinity: Infinity::Uniform(medium), ..known }, Survey::default());
        }
        let mut survey = Survey::default();
        Locator { geometry, surfaces, known: &known }.survey(&mut survey);
        // Whatever is not seen from any boundary lies beyond opaque walls, in vacuum if the file does not say otherwise.
        let unseen = if known.boundaries.is_empty() { otherwise } else { MediumIndex::VACUUM };
        let infinity = Infinity::of(std::mem::take(&mut survey.escapes), unseen);
        (Self { infinity, ..known }, survey)
    }

    /// True if only one medium is possible anywhere.
    pub fn is_uniform(&self) -> bool {
        self.only.is_some()
    }

    /// From here on `point` is known to lie in `medium`.
    pub fn add(&mut self, point: Vec3, medium: MediumIndex) {
        self.points.push((point, medium));
    }
}
