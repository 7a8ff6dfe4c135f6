//! A path vertex: where it is, how it scatters, and what the balance heuristic needs of the walk behind it.

use super::{
    event::{Arrival, Event},
    interaction::{Interaction, Scattering},
    mis::MisSums,
    profile::Profile,
    roulette::Pending,
    strategy::StrategyKind,
};
use crate::{
    bsdf::Transport,
    guide::{Guidance, Guide},
    math::{Channels, Spectrum, Vec3, offset::Lift},
    medium::{MediaProfile, MediumIndex},
    sampling::Stream,
    scene::Scene,
};

/// The state of a camera or light subpath at its i-th point after the start, before anything happens there.
///
/// The last four fields are the running sums of the weights. With p>_i the density by which this
/// walk makes vertex i (flight, direction and geometry, LW96 eq. 13) and p<_i that of the opposite walk, for
/// channel c and hero h:
///   pdf_over_hero_i   = product over j <= i of p>^c_j / p>^h_j
///   D_i       = (p<^c_i / p>^h_i) (pdf_over_hero_{i-1} n_i + D_{i-1})
/// sums n_j p_j (as [`MisSums`] do for the heuristic at hand) over all strategies that connect before vertex
/// i, in units of this walk's own density. What p<_i needs of the vertices beyond i is not known yet, so
/// `others_over_pdf_rev` is D_{i-1} without the direction density at vertex i, and `inv_pdf` is 1/p>^h_i.
#[derive(Clone, Copy, Debug)]
pub struct Subpath<S: MisSums> {
    /// Unit direction towards the vertex before.
    pub incoming: Vec3,
    /// The medium of the segment that ended here.
    pub medium: MediumIndex,
    /// Segments since the start of the walk, from 1.
    pub edges: u32,
    /// True if the vertex before scattered by a Dirac lobe: the segment before cannot be a connection.
    pub after_dirac: bool,
    /// Contribution over density of everything before this point's own scattering.
    pub throughput: Spectrum,
    /// 1/p>^h_i.
    pub inv_pdf: f32,
    /// pdf_over_hero_{i-1}.
    pub pdf_over_hero_before: S::Channels,
    /// pdf_over_hero_i.
    pub pdf_over_hero: S::Channels,
    /// D_{i-1} over the direction density at this point towards the one before.
    pub others_over_pdf_rev: S,
}

/// A vertex of a camera or light subpath: what scatters at the end of a subpath.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<S: MisSums> {
    /// Surface or medium.
    pub interaction: Interaction,
    /// Survival probability, if roulette is drawn before the flight; else 1.
    pub survival: f32,
    /// The roulette that is drawn at the end of the flight.
    pub pending: Pending,
    /// n_i: expected samples of the strategy that connects across the segment before; 0 where none can.
    pub connections: f32,
    /// The kind of that strategy.
    pub kind: StrategyKind,
    /// What the guide says here, if there is one.
    pub guidance: Guidance,
    /// How the walk came here.
    pub subpath: Subpath<S>,
}

impl<S: MisSums> Subpath<S> {
    /// What observers see of it.
    #[inline]
    pub fn arrival(&self) -> Arrival {
        let Self { medium, incoming, edges, inv_pdf, throughput, .. } = *self;
        Arrival { medium, incoming, edges, density: 1.0 / inv_pdf, throughput }
    }

    /// Draws the roulette that the vertex before left pending; none where the walk ends.
    #[inline]
    pub fn survive(&mut self, survival: f32, stream: &mut Stream) -> Option<()> {
        if survival < 1.0 {
            self.throughput /= survival;
            self.inv_pdf /= survival;
            return (stream.uniform() < survival).then_some(());
        }
        Some(())
    }
}

impl<S: MisSums> Vertex<S> {
    /// What observers see of it.
    #[inline]
    pub fn event(&self) -> Event<'_> {
        let Self { interaction, survival, subpath, .. } = self;
        Event { interaction, survival: *survival, arrival: subpath.arrival() }
    }

    /// World position.
    #[inline]
    pub fn position(&self) -> Vec3 {
        self.interaction.position()
    }

    /// See [`Interaction::sigma_t`].
    #[inline]
    pub fn sigma_t(&self) -> S::Channels {
        self.interaction.sigma_t()
    }

    /// See [`Interaction::cosine`].
    #[inline]
    pub fn cosine<M: MediaProfile>(&self, scene: &Scene, direction: Vec3) -> f32 {
        self.interaction.cosine::<M>(scene, direction)
    }

    /// Where a ray towards unit `direction` starts, and in which medium.
    #[inline]
    pub fn depart(&self, scene: &Scene, direction: Vec3) -> (Vec3, MediumIndex) {
        match &self.interaction {
            Interaction::Medium(position, _) => (*position, self.subpath.medium),
            Interaction::Surface(point) => (
                point.leaving(direction).origin,
                scene.medium_towards(point, self.subpath.incoming, direction, self.subpath.medium),
            ),
        }
    }

    /// See [`super::mis::End::lift`].
    #[inline]
    pub fn lift(&self, direction: Vec3) -> Lift {
        match &self.interaction {
            Interaction::Medium(..) => Lift::NONE,
            Interaction::Surface(point) => point.lift(direction),
        }
    }

    /// The sum over the strategies that connect before this vertex, once the direction density back to the
    /// vertex before is known: pdf_over_hero_{i-1} n_i + D_{i-1}.
    #[inline]
    pub fn others_before(&self, pdf_rev: f32) -> S {
        S::of(self.kind, self.subpath.pdf_over_hero_before.scaled(self.connections))
            .and(self.subpath.others_over_pdf_rev.scaled(pdf_rev))
    }

    /// True at a collision from which neither an emitter nor the camera can be seen.
    #[inline]
    pub fn is_shut_in<P: Profile>(&self, scene: &Scene) -> bool {
        P::MEDIA
            && matches!(&self.interaction, Interaction::Medium(_, found) if scene.is_shut_in(found.medium))
    }

    /// True on a shape that emits.
    #[inline]
    pub fn is_on_emitter(&self, scene: &Scene) -> bool {
        matches!(&self.interaction, Interaction::Surface(point) if scene.surface(point.shape).emitter.is_some())
    }

    /// True if some of its scattering is not Dirac.
    #[inline]
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        self.interaction.is_connectible(scene)
    }

    /// Scattering between the vertex before and unit `outgoing`, see [`Interaction::scatter`].
    #[inline]
    pub fn scatter_towards<P: Profile<MisSums = S>>(
        &self,
        scene: &Scene,
        guide: Option<&Guide>,
        outgoing: Vec3,
        transport: Transport,
    ) -> Scattering {
        let Scattering { value, mut pdf_fwd, mut pdf_rev } =
            self.interaction.scatter::<P>(scene, self.subpath.incoming, outgoing, transport);
        if let (true, Some(guide)) = (P::GUIDED, guide) {
            [pdf_fwd, pdf_rev] =
                guide.pdfs(self.guidance, transport, self.position(), outgoing, [pdf_fwd, pdf_rev]);
        }
        Scattering { value, pdf_fwd: pdf_fwd * self.survival, pdf_rev: pdf_rev * self.survival }
    }
}
