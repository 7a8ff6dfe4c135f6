//! Elements of a scene in one hierarchy (P03T ch. 4): leaves of surfaces that face one way and of media, found by position, and the
//! clusters above them.

use super::places::{Places, Valued};
use crate::{
    math::{Bounds, Spectrum, Vec3},
    sampling::Cells,
};
use std::ops::Range;

/// A point that stands for a part of the scene.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// World position.
    pub position: Vec3,
    /// Unit geometric normal; none in a medium.
    pub normal: Option<Vec3>,
    /// The part: area (m^2), or volume times extinction (m^2).
    pub measure: Spectrum,
    /// What elements should not mix, as a number.
    pub value: f32,
}

/// An element or a cluster of them.
#[derive(Clone, Debug)]
pub struct Node {
    /// The two nodes that it consists of; none of an element.
    pub parts: Option<[u32; 2]>,
    /// The cluster that it is a part of; none of all surfaces, and of all media.
    pub parent: Option<u32>,
    /// Its elements.
    pub elements: Range<u32>,
    /// The points that stand for it, in the order of the hierarchy.
    pub points: Range<u32>,
    /// The box around those.
    pub bounds: Bounds,
    /// The measure of its points.
    pub measure: Spectrum,
}

/// All elements and clusters: parts come after what they are parts of.
#[derive(Clone, Debug, Default)]
pub struct Hierarchy {
    places: Places,
    surfaces: Cells<6, u32>,
    media: Cells<3, u32>,
    /// Nodes of surfaces come first.
    pub nodes: Vec<Node>,
    /// The node of each element.
    pub elements: Vec<u32>,
}

impl Hierarchy {
    /// The hierarchy of `samples`, with at least half of `per_element` of them in each element; and their order by
    /// nodes.
    pub fn of(samples: &[Sample], per_element: f64) -> (Self, Vec<u32>) {
        let places = Places::around(samples.iter().map(|sample| sample.position));
        let (mut order, mut elements) = (Vec::new(), Vec::new());
        let known = || samples.iter().zip(0..);
        let of_surfaces = known().filter_map(|(sample, index)| {
            let key = places.facing(sample.position, sample.normal?);
            Some(Valued { key, value: sample.value, index })
        });
        let of_media = known().filter(|(sample, _)| sample.normal.is_none());
        let of_media = of_media.map(|(sample, index)| Valued {
            key: places.at(sample.position),
            value: sample.value,
            index,
        });
        let (of_surfaces, of_media): (Vec<_>, Vec<_>) = (of_surfaces.collect(), of_media.collect());
        let half = 0.5 * per_element;
        let surfaces = Cells::learn(of_surfaces, half, LEVELS, |own| add(&mut order, &mut elements, own));
        let media = Cells::learn(of_media, half, LEVELS, |own| add(&mut order, &mut elements, own));
        let mut nodes = nodes(&surfaces, 0, &elements, |index| &samples[order[index as usize] as usize]);
        nodes.extend(self::nodes(&media, nodes.len() as u32, &elements, |index| {
            &samples[order[index as usize] as usize]
        }));
        (Self { places, surfaces, media, elements: vec![0; elements.len()], nodes }.joined(), order)
    }

    /// The same with the parents of nodes set.
    fn joined(mut self) -> Self {
        for index in 0..self.nodes.len() {
            match self.nodes[index].parts {
                Some(parts) => {
                    parts.iter().for_each(|part| self.nodes[*part as usize].parent = Some(index as u32))
                }
                None => self.elements[self.nodes[index].elements.start as usize] = index as u32,
            }
        }
        self
    }

    /// The element of a place; none where there is nothing of its kind.
    #[inline]
    pub fn element(&self, position: Vec3, normal: Option<Vec3>) -> Option<u32> {
        match normal {
            Some(normal) => self.surfaces.at(self.places.facing(position, normal)).copied(),
            None => self.media.at(self.places.at(position)).copied(),
        }
    }

    /// The node of an element.
    #[inline]
    pub fn node(&self, element: u32) -> &Node {
        &self.nodes[self.elements[element as usize] as usize]
    }

    /// A node and the clusters that it is in, from itself on.
    pub fn upwards(&self, node: u32) -> impl Iterator<Item = u32> {
        std::iter::successors(Some(node), |node| self.nodes[*node as usize].parent)
    }

    /// All surfaces and all media, as far as there are any.
    pub fn roots(&self) -> impl Iterator<Item = u32> {
        (0..self.nodes.len() as u32).filter(|node| self.nodes[*node as usize].parent.is_none())
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        self.surfaces.bytes() + self.media.bytes() + size_of_val(&self.nodes[..])
    }
}

/// Levels below all surfaces, and below all media.
const LEVELS: u32 = 20;

/// Appends an element: its points to `order`, and their range there to `elements`; its index.
fn add<const D: usize>(order: &mut Vec<u32>, elements: &mut Vec<Range<u32>>, own: Vec<Valued<D>>) -> u32 {
    let first = order.len() as u32;
    order.extend(own.iter().map(|one| one.index));
    elements.push(first..order.len() as u32);
    elements.len() as u32 - 1
}

/// The nodes of all `cells`; the first is node `first`.
fn nodes<'a, const D: usize>(
    cells: &Cells<D, u32>,
    first: u32,
    elements: &[Range<u32>],
    sample: impl Fn(u32) -> &'a Sample,
) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::with_capacity(cells.count());
    for index in (0..cells.count()).rev() {
        let node = match cells.cell(index) {
            Ok(element) => Node::element(*element, elements[*element as usize].clone(), &sample),
            Err(parts) => {
                let made = parts.map(|part| &nodes[cells.count() - 1 - part as usize]);
                Node::cluster(parts.map(|part| first + part), made)
            }
        };
        nodes.push(node);
    }
    nodes.reverse();
    nodes
}

impl Node {
    fn element<'a>(element: u32, points: Range<u32>, sample: impl Fn(u32) -> &'a Sample) -> Self {
        let own = || points.clone().map(&sample);
        let bounds = own().map(|sample| Bounds::of(sample.position)).fold(Bounds::EMPTY, Bounds::union);
        let measure = own().map(|sample| sample.measure).sum();
        Self { parts: None, parent: None, elements: element..element + 1, points, bounds, measure }
    }

    fn cluster(parts: [u32; 2], [a, b]: [&Self; 2]) -> Self {
        Self {
            parts: Some(parts),
            parent: None,
            elements: a.elements.start..b.elements.end,
            points: a.points.start..b.points.end,
            bounds: a.bounds.union(b.bounds),
            measure: a.measure + b.measure,
        }
    }

    /// The indices of its elements.
    pub fn within(&self) -> Range<usize> {
        self.elements.start as usize..self.elements.end as usize
    }

    /// The middle of its box.
    #[inline]
    pub fn centre(&self) -> Vec3 {
        0.5 * (self.bounds.low + self.bounds.high)
    }

    /// Half the diagonal of its box (m).
    #[inline]
    pub fn radius(&self) -> f32 {
        0.5 * self.bounds.size().length()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::{vec3, warp},
        sampling::{Stream, stream::Purpose},
    };

    /// Samples are found in the element that they stand for, and clusters are as much as their parts.
    #[test]
    fn every_sample_is_in_its_element_and_in_all_clusters_above() {
        let mut stream = Stream::new(5, 0, 0, Purpose::Study);
        let sample = |index: u32| {
            let position = vec3(stream.uniform(), stream.uniform(), stream.uniform());
            let normal = (!index.is_multiple_of(3)).then(|| warp::to_sphere(stream.square()));
            Sample { position, normal, measure: Spectrum::splat(stream.uniform()), value: 1.0 }
        };
        let samples: Vec<Sample> = (0..3000).map(sample).collect();
        let (hierarchy, order) = Hierarchy::of(&samples, 8.0);
        assert_eq!((hierarchy.roots().count(), order.len()), (2, samples.len()));
        for (place, index) in order.iter().enumerate() {
            let Sample { position, normal, .. } = samples[*index as usize];
            let element = hierarchy.element(position, normal).unwrap();
            for node in hierarchy.upwards(hierarchy.elements[element as usize]) {
                let node = &hierarchy.nodes[node as usize];
                assert!(node.points.contains(&(place as u32)) && node.elements.contains(&element));
                assert!(node.bounds.contains(Bounds::of(position)));
            }
        }
        let of = |media: bool| samples.iter().filter(move |sample| sample.normal.is_none() == media);
        for (root, media) in hierarchy.roots().zip([false, true]) {
            let expected: f32 = of(media).map(|sample| sample.measure.x).sum();
            assert!((hierarchy.nodes[root as usize].measure.x / expected - 1.0).abs() < 1e-3);
        }
    }
}
