//! The image in parts: what each strategy contributes, weighted and as if it ran alone (Veach 1997, fig. 10.2
//! and 10.3).

use crate::{
    film::{Film, moments::Moments},
    math::{Spectrum, Vec2},
    passes::{blocks::CameraStart, observe::BlockObserver},
    render::instrument::Instrument,
    transport::{
        Contribution, Strategies,
        observer::{Meeting, Observer},
        strategy::StrategyKind,
    },
};

/// Which strategies are distinguished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StrategyTable {
    /// Paths of up to so many segments, strategy by strategy; longer ones by kind.
    pub depth: u32,
}

/// One of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrategyCell {
    /// The strategy of `s` light and `t` camera vertices, the lens among these.
    Strategy {
        /// Light vertices.
        s: u32,
        /// Camera vertices, from 1.
        t: u32,
    },
    /// All strategies of a kind on all longer paths; all of equiangular sampling, which has but one.
    Longer(StrategyKind),
}

impl StrategyCell {
    /// Of which kind its strategies are.
    pub fn kind(self) -> StrategyKind {
        match self {
            Self::Strategy { s, t } => StrategyKind::of(s, t),
            Self::Longer(kind) => kind,
        }
    }

    /// True if its strategies are among those of `strategies` that run.
    pub fn runs(self, strategies: Strategies) -> bool {
        match self {
            Self::Strategy { s, t } => strategies.runs(s, t),
            Self::Longer(kind) => strategies.has(kind),
        }
    }

    /// Segments of its paths; none for longer ones.
    pub fn length(self) -> Option<u32> {
        match self {
            Self::Strategy { s, t } => Some(s + t - 1),
            Self::Longer(StrategyKind::Equiangular) => Some(2),
            Self::Longer(_) => None,
        }
    }

    /// As in files.
    pub fn name(self) -> String {
        match self {
            Self::Strategy { s, t } => format!("s{s}t{t}"),
            Self::Longer(kind @ StrategyKind::Equiangular) => kind.name().to_owned(),
            Self::Longer(kind) => format!("longer_{}", kind.name().replace('-', "_")),
        }
    }
}

impl StrategyTable {
    /// Number of cells before those of paths of `length` segments: a path of k segments can be made in k + 1 ways.
    fn before(length: u32) -> usize {
        (length as usize * (length as usize + 1)) / 2 - 1
    }

    /// How many there are.
    pub fn count(self) -> usize {
        Self::before(self.depth + 1) + StrategyKind::ALL.len()
    }

    /// Where the strategy of `s` light and `t` camera vertices counts, which is of `kind`; their sum is at least 2.
    #[inline]
    pub fn index(self, kind: StrategyKind, s: u32, t: u32) -> usize {
        let length = s + t - 1;
        if length <= self.depth && kind != StrategyKind::Equiangular {
            return Self::before(length) + s as usize;
        }
        Self::before(self.depth + 1) + kind as usize
    }

    /// All cells, in the order of their indices.
    pub fn all(self) -> impl Iterator<Item = StrategyCell> {
        let strategies =
            (1..=self.depth).flat_map(|k| (0..=k).map(move |s| StrategyCell::Strategy { s, t: k + 1 - s }));
        strategies.chain(StrategyKind::ALL.map(StrategyCell::Longer))
    }
}

/// What a cell adds to a pixel of a pass.
struct CellContribution {
    cell: u32,
    pixel: u32,
    weighted: Spectrum,
    alone: Spectrum,
}

/// The parts of a block.
struct Block<'a> {
    light: LightPathObserver<'a>,
    camera: CameraPathObserver,
    /// The filter's factor for the camera subpath at hand.
    factor: f32,
    /// Of camera subpaths.
    parts: Vec<CellContribution>,
}

impl<'a> Block<'a> {
    fn new(film: &'a Film, table: StrategyTable) -> Self {
        let light = LightPathObserver { film, table, parts: Vec::new() };
        let sums = vec![(Spectrum::ZERO, Spectrum::ZERO); table.count()];
        Self { light, camera: CameraPathObserver { table, sums }, factor: 1.0, parts: Vec::new() }
    }
}

impl BlockObserver for Block<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        &mut self.light
    }

    fn camera(&mut self, _: usize, start: &CameraStart) -> &mut dyn Observer {
        self.factor = start.weight;
        &mut self.camera
    }

    fn ended(&mut self, pixel: usize) {
        let Self { camera, factor, parts, .. } = self;
        camera.drain(|cell, weighted, alone| {
            let (weighted, alone) = (weighted * *factor, alone * *factor);
            parts.push(CellContribution { cell: cell as u32, pixel: pixel as u32, weighted, alone });
        });
    }
}

/// What light subpaths contribute to the film.
struct LightPathObserver<'a> {
    film: &'a Film,
    table: StrategyTable,
    parts: Vec<CellContribution>,
}

impl Observer for LightPathObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(contribution)) = (meeting, contribution) else { return };
        let (cell, parts) = (self.table.index(StrategyKind::Lens, s, t) as u32, &mut self.parts);
        // A share of the film applies to both values equally.
        self.film.spread(film, Spectrum::ONE, |pixel, share| {
            let (weighted, alone) = (contribution.value * share, contribution.alone * share);
            parts.push(CellContribution { cell, pixel: pixel as u32, weighted, alone });
        });
    }
}

/// What one camera subpath contributes: sums over its cells, weighted and alone.
struct CameraPathObserver {
    table: StrategyTable,
    sums: Vec<(Spectrum, Spectrum)>,
}

impl CameraPathObserver {
    /// Hands out what is not zero, and forgets it.
    fn drain(&mut self, mut take: impl FnMut(usize, Spectrum, Spectrum)) {
        for (cell, sum) in self.sums.iter_mut().enumerate() {
            let (weighted, alone) = std::mem::replace(sum, (Spectrum::ZERO, Spectrum::ZERO));
            if weighted != Spectrum::ZERO || alone != Spectrum::ZERO {
                take(cell, weighted, alone);
            }
        }
    }
}

impl Observer for CameraPathObserver {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        if let Some(contribution) = contribution {
            let sum = &mut self.sums[self.table.index(meeting.kind(s, t), s, t)];
            sum.0 += contribution.value;
            sum.1 += contribution.alone;
        }
    }
}

/// Images of all strategies that run, over any number of passes.
pub struct StrategyImages {
    /// Which there are.
    pub table: StrategyTable,
    /// One a cell; none where its strategies do not run.
    pub images: Vec<Option<CellImages>>,
    /// The image that they make together.
    pub whole: Moments,
}

/// The images of one cell.
#[derive(Clone)]
pub struct CellImages {
    /// As it counts in the image.
    pub weighted: Moments,
    /// As if it ran alone.
    pub alone: Moments,
    /// The pass at hand.
    pass: [Vec<Spectrum>; 2],
}

impl CellImages {
    fn new(pixels: usize) -> Self {
        let pass = || vec![Spectrum::ZERO; pixels];
        let (weighted, alone) = (Moments::new(pixels), Moments::new(pixels));
        Self { weighted, alone, pass: [pass(), pass()] }
    }

    fn finish_pass(&mut self) {
        self.weighted.add(&self.pass[0]);
        self.alone.add(&self.pass[1]);
        self.pass.iter_mut().for_each(|pass| pass.fill(Spectrum::ZERO));
    }
}

impl StrategyImages {
    /// Bytes that the images of `table` take per pixel, at most.
    pub fn bytes_per_pixel(table: StrategyTable) -> usize {
        // Three sums and one of squares in double precision, and the pass at hand, each twice.
        table.count() * 2 * (4 * size_of::<f64>() + size_of::<Spectrum>())
    }

    fn take(&mut self, pass: &mut [Spectrum], part: &CellContribution) {
        let pixel = part.pixel as usize;
        pass[pixel] += part.weighted;
        if let Some(images) = &mut self.images[part.cell as usize] {
            images.pass[0][pixel] += part.weighted;
            images.pass[1][pixel] += part.alone;
        }
    }
}

impl StrategyImages {
    /// The parts of the image that `passes` passes of an estimator that runs `strategies` make, reported as they finish.
    pub fn render(
        instrument: &Instrument<'_>,
        strategies: Strategies,
        table: StrategyTable,
        passes: usize,
        progress: &mut dyn FnMut(usize),
    ) -> Self {
        let pixels = instrument.film.len();
        let images = |cell: StrategyCell| cell.runs(strategies).then(|| CellImages::new(pixels));
        let mut parts =
            Self { table, images: table.all().map(images).collect(), whole: Moments::new(pixels) };
        let mut whole = vec![Spectrum::ZERO; pixels];
        let block = |_| Block::new(instrument.film, table);
        instrument.observe(0..passes, block, |block, ends_pass| {
            let found = block.light.parts.iter().chain(&block.parts);
            found.for_each(|part| parts.take(&mut whole, part));
            if ends_pass {
                parts.images.iter_mut().flatten().for_each(CellImages::finish_pass);
                parts.whole.add(&whole);
                whole.fill(Spectrum::ZERO);
                progress(parts.whole.passes() as usize);
            }
        });
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_strategy_has_a_cell_of_its_own_up_to_the_depth() {
        for depth in [1, 2, 6] {
            let table = StrategyTable { depth };
            let all: Vec<StrategyCell> = table.all().collect();
            assert_eq!(all.len(), table.count());
            for (index, cell) in all.iter().enumerate() {
                match *cell {
                    StrategyCell::Strategy { s, t } => {
                        assert_eq!(table.index(StrategyKind::of(s, t), s, t), index);
                        assert!(t >= 1 && s + t >= 2 && s + t - 1 <= depth);
                    }
                    StrategyCell::Longer(kind) => {
                        let (s, t) = match kind {
                            StrategyKind::EmitterHit => (0, depth + 2),
                            StrategyKind::NextEvent => (1, depth + 1),
                            StrategyKind::Connection => (2, depth + 7),
                            StrategyKind::Lens => (depth + 1, 1),
                            StrategyKind::Equiangular => (1, 2),
                        };
                        assert_eq!(table.index(kind, s, t), index, "{kind:?}");
                    }
                }
            }
        }
    }
}
